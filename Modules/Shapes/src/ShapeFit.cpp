// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Shapes/ShapeFit.h"

#include "AngularBasis.h"
#include "Explica/Core/Errors.h"
#include "Explica/Core/StopScope.h"
#include "Explica/Core/Text.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

namespace explica::shapes {
namespace {

constexpr double kDifference = 1e-4;  // of the annulus' width: step of the differences for grad u
constexpr double kRounding = 1e-3;    // of the width: distances below count as equal in the L1 sum
constexpr double kLeastShare = 0.1;   // of the concentric shape: keeps boundary values off 1/2
constexpr double kScaleWeight = 1e2;  // of the amplitudes' sum, against the fit's weights
constexpr double kSettled = 1e-5;     // largest change of a coefficient at which a fit ends
constexpr double kLeastGain = 1e-3;   // of the symmetric difference ...
constexpr std::size_t kStill = 60;  // ... within so many iterations: else the fit ends at its best
// In space a target is faces, whose corners are no shape.
constexpr double kSmootherInSpace = 1e3;
constexpr int kMostExchanges =
    100;                          // rounds of exchange between amplitudes at and above their bound
constexpr int kPatience = 5;      // rounds without fewer wrong ones
constexpr int kMostSweeps = 400;  // of coordinate descent, where exchange does not end
constexpr double kSweepTolerance = 1e-9;

/// Of a non-negative kernel of the angle g, by degree, mean 1: how much of Y_l a convolution with
/// it leaves.  In the plane Fejer's, |sum of n + 1 exponentials|^2; in space its like, the square
/// of the sum of (2 l + 1) P_l(cos g) up to n/2.  Each is as narrow as 1/n; powers of 1 + cos g,
/// the simplest such kernels, are only as narrow as 1/sqrt(n).
std::vector<double> kernelFactors(int dimension, int order) {
  std::vector<double> factors(static_cast<std::size_t>(order) + 1);
  if (dimension == 2) {
    for (int l = 0; l <= order; ++l) factors[l] = 1 - l / (order + 1.0);
    return factors;
  }
  // The midpoint rule in g is exact enough: the integrands are smooth and periodic in g.
  const int samples = 64 * (order + 1);
  std::vector<double> legendre(static_cast<std::size_t>(order) + 1);
  for (int k = 0; k < samples; ++k) {
    const double g = kPi * (k + 0.5) / samples;
    const double c = std::cos(g);
    double root = 0;
    for (int l = 0; l <= order; ++l) {
      legendre[l] = l == 0   ? 1
                    : l == 1 ? c
                             : ((2 * l - 1) * c * legendre[l - 1] - (l - 1) * legendre[l - 2]) / l;
      if (l <= order / 2) root += (2 * l + 1) * legendre[l];
    }
    for (int l = 0; l <= order; ++l) factors[l] += std::sin(g) * root * root * legendre[l];
  }
  for (int l = order; l >= 0; --l) factors[l] /= factors[0];
  return factors;
}

/// Coefficients by Y_j of the constant 1 and of kernels about many directions spread evenly, all of
/// mean 1; perBoundary() x (1 + directions).
Eigen::MatrixXd bumps(const HarmonicAnnulus& annulus) {
  const int order = std::max(annulus.order, 1);
  // As many as coefficients, so that without bounds the kernels' places do not matter; an even
  // number in the plane, so that they lie symmetrically.
  const int count =
      annulus.dimension == 2 ? std::max(2 * order + 2, 8) : std::max((order + 1) * (order + 1), 32);
  const double golden = kPi * (3 - std::sqrt(5.0));
  Eigen::MatrixXd coefficients(annulus.perBoundary(), count);
  for (int b = 0; b < count; ++b) {
    Vector direction;
    if (annulus.dimension == 2) {
      const double angle = 2 * kPi * b / count;
      direction = {std::cos(angle), std::sin(angle), 0};
    } else {  // Fibonacci's lattice
      const double z = 1 - (2.0 * b + 1) / count;
      const double s = std::sqrt(1 - z * z);
      direction = {s * std::cos(golden * b), s * std::sin(golden * b), z};
    }
    angularBasis(annulus.dimension, annulus.order, direction, coefficients.col(b).data());
  }
  const std::vector<double> factors = kernelFactors(annulus.dimension, annulus.order);
  for (Eigen::Index k = 0; k < coefficients.rows(); ++k) {
    const int degree = degreeOf(annulus.dimension, static_cast<int>(k));
    // cos and sin have the mean square 1/2.
    coefficients.row(k) *= (annulus.dimension == 2 && degree > 0 ? 2 : 1) * factors[degree];
  }
  Eigen::MatrixXd all = Eigen::MatrixXd::Zero(coefficients.rows(), count + 1);
  all(0, 0) = 1;
  all.rightCols(count) = coefficients;
  return all;
}

/// Lowers 1/2 x' G x - r' x with x at least `least` by coordinate descent.
void descend(const Eigen::MatrixXd& gram, const Eigen::VectorXd& right,
             const Eigen::VectorXd& least, Eigen::VectorXd& x) {
  Eigen::VectorXd residual = gram * x - right;
  for (int sweep = 0; sweep < kMostSweeps; ++sweep) {
    checkpoint();
    double largest = 0;
    for (Eigen::Index k = 0; k < x.size(); ++k) {
      const double change = std::max(least[k], x[k] - residual[k] / gram(k, k)) - x[k];
      if (change == 0) continue;
      residual += change * gram.col(k);
      x[k] += change;
      largest = std::max(largest, std::abs(change));
    }
    if (largest < kSweepTolerance) break;
  }
}

/// Least 1/2 x' G x - r' x over the unknowns that are not at their bound.
Eigen::VectorXd withOpen(const Eigen::MatrixXd& gram, const Eigen::VectorXd& right,
                         const Eigen::VectorXd& least, const std::vector<bool>& atBound) {
  std::vector<Eigen::Index> open;
  for (Eigen::Index k = 0; k < right.size(); ++k) {
    if (!atBound[k]) open.push_back(k);
  }
  Eigen::VectorXd x = least;
  const Eigen::VectorXd load = right - gram * x;
  const Eigen::VectorXd step = gram(open, open).ldlt().solve(Eigen::VectorXd(load(open)));
  for (std::size_t q = 0; q < open.size(); ++q) x[open[q]] += step[q];
  return x;
}

/// Least 1/2 x' G x - r' x with x at least `least`, G positive definite: the one solution, by
/// exchange of all unknowns that lie on the wrong side at once, or, if their number does not fall,
/// of the last one only [Portugal1994]; where round-off keeps that from ending, by descent.
Eigen::VectorXd leastWithBound(const Eigen::MatrixXd& gram, const Eigen::VectorXd& right,
                               const Eigen::VectorXd& least) {
  const auto n = static_cast<std::size_t>(right.size());
  const double noise = 1e-12 * (1 + right.cwiseAbs().maxCoeff());
  std::vector<bool> atBound(n, false);
  std::size_t fewest = n + 1;
  int patience = kPatience;
  Eigen::VectorXd x;
  for (int round = 0; round < kMostExchanges; ++round) {
    checkpoint();
    x = withOpen(gram, right, least, atBound);
    const Eigen::VectorXd slope = gram * x - right;
    std::vector<std::size_t> wrong;
    for (std::size_t k = 0; k < n; ++k) {
      const auto at = static_cast<Eigen::Index>(k);
      if (atBound[k] ? slope[at] < -noise : x[at] < least[at]) wrong.push_back(k);
    }
    if (wrong.empty()) return x;
    patience = wrong.size() < fewest ? kPatience : patience - 1;
    fewest = std::min(fewest, wrong.size());
    if (patience < 0) wrong = {wrong.back()};
    for (const std::size_t k : wrong) atBound[k] = !atBound[k];
  }
  x = x.cwiseMax(least);
  descend(gram, right, least, x);
  return x;
}

/// u = 1/2 - (sum of bumps on the inner) + (sum of bumps on the outer boundary), with positive
/// amplitudes x, inner ones first: boundary values are on their sides of 1/2 by construction.
class Fit {
 public:
  Fit(const HarmonicAnnulus& annulus, const TargetSamples& target, const ShapeFitOptions& options)
      : annulus_(annulus),
        options_(options),
        weights_(target.weights / target.weights.sum()),
        total_(target.weights.sum()),
        width_(widthOf(annulus)),
        bumps_(bumps(annulus)),
        roughness_(roughnessOf(annulus)),
        response_(responseAt(target.points)) {
    const double h = kDifference * width_;
    for (int axis = 0; axis < annulus.dimension; ++axis) {
      Positions ahead = target.points;
      Positions behind = target.points;
      ahead.col(axis).array() += h;
      behind.col(axis).array() -= h;
      slopes_.push_back((responseAt(ahead) - responseAt(behind)) / (2 * h));
    }
  }

  /// Amplitudes of a concentric shape: constants on both boundaries, 1 apart.
  /// @param start  which level of the function that is 0 on the inner and 1 on the outer boundary
  [[nodiscard]] Eigen::VectorXd initial(double start = 0.5) const {
    Eigen::VectorXd x = Eigen::VectorXd::Zero(2 * bumps_.cols());
    x[0] = start;
    x[bumps_.cols()] = 1 - start;
    return x;
  }

  [[nodiscard]] HarmonicShape shapeOf(const Eigen::VectorXd& x) const {
    HarmonicShape shape{annulus_, -bumps_ * x.head(bumps_.cols()), bumps_ * x.tail(bumps_.cols())};
    shape.inner[0] += 0.5;
    shape.outer[0] += 0.5;
    return shape;
  }

  [[nodiscard]] ShapeFitIteration account(const Eigen::VectorXd& x) const {
    const Eigen::VectorXd d = (response_ * x).cwiseQuotient(slope(x)).cwiseAbs();
    return {total_ * weights_.dot(d), weights_.dot(d), d.maxCoeff()};
  }

  /// Minimum of the present weighting.
  [[nodiscard]] Eigen::VectorXd optimum(const Eigen::VectorXd& x) const {
    const Eigen::VectorXd slopes = slope(x);
    const Eigen::VectorXd d = (response_ * x).cwiseQuotient(slopes).cwiseAbs();
    // |d| = d^2 / |d|, with d = (u - 1/2) / |grad u|, all in units of the annulus' width.
    Eigen::VectorXd root(d.size());
    for (Eigen::Index p = 0; p < d.size(); ++p) {
      const double floor = kRounding * width_;
      root[p] = std::sqrt(weights_[p] / (std::max(d[p], floor) * width_)) / slopes[p];
    }
    Eigen::MatrixXd gram = Eigen::MatrixXd::Zero(x.size(), x.size());
    gram.selfadjointView<Eigen::Lower>().rankUpdate((root.asDiagonal() * response_).transpose());
    gram.triangularView<Eigen::StrictlyUpper>() = gram.transpose();
    // Scaling u - 1/2 leaves the level where it is: the sum of all amplitudes is held at 1.
    gram.array() += kScaleWeight;
    Eigen::VectorXd right = Eigen::VectorXd::Constant(x.size(), kScaleWeight);
    // Of all that fit equally well the smoothest boundary values.
    const double weight = (annulus_.dimension == 2 ? 1 : kSmootherInSpace) * options_.smoothness *
                          gram.trace() / static_cast<double>(x.size());
    const Eigen::Index n = bumps_.cols();
    gram.topLeftCorner(n, n) += weight * roughness_;
    gram.bottomRightCorner(n, n) += weight * roughness_;
    // A constant is the constant, not a sum of bumps.
    for (Eigen::Index k = 0; k < gram.rows(); ++k) {
      if (k != 0 && k != n) gram(k, k) += weight;
    }
    return leastWithBound(gram, right, kLeastShare * initial());
  }

  /// Largest difference of a coefficient of two sets of amplitudes.
  [[nodiscard]] double apart(const Eigen::VectorXd& x, const Eigen::VectorXd& y) const {
    const Eigen::Index n = bumps_.cols();
    return std::max((bumps_ * (x - y).head(n)).cwiseAbs().maxCoeff(),
                    (bumps_ * (x - y).tail(n)).cwiseAbs().maxCoeff());
  }

 private:
  /// sum over degrees of l^2 c_l^2: the mean square of the boundary values' slope.
  [[nodiscard]] Eigen::MatrixXd roughnessOf(const HarmonicAnnulus& annulus) const {
    Eigen::VectorXd squares(bumps_.rows());
    for (Eigen::Index k = 0; k < squares.size(); ++k) {
      const double l = degreeOf(annulus.dimension, static_cast<int>(k));
      squares[k] = annulus.dimension == 2 ? l * l : l * (l + 1);
    }
    return bumps_.transpose() * squares.asDiagonal() * bumps_;
  }

  /// u - 1/2 at points for unit amplitudes.
  [[nodiscard]] Eigen::MatrixXd responseAt(const Positions& points) const {
    const Eigen::MatrixXd basis = basisAt(annulus_, points);
    const Eigen::Index n = annulus_.perBoundary();
    Eigen::MatrixXd response(points.rows(), 2 * bumps_.cols());
    response << -basis.leftCols(n) * bumps_, basis.rightCols(n) * bumps_;
    return response;
  }

  [[nodiscard]] Eigen::VectorXd slope(const Eigen::VectorXd& x) const {
    Eigen::VectorXd squares = Eigen::VectorXd::Zero(response_.rows());
    for (const Eigen::MatrixXd& s : slopes_) squares += (s * x).cwiseAbs2();
    // A flat spot would count as infinitely far: at least a tenth of the concentric shape's slope.
    return squares.cwiseSqrt().cwiseMax(0.1 / width_);
  }

  HarmonicAnnulus annulus_;
  ShapeFitOptions options_;
  Eigen::VectorXd weights_;  ///< sum to 1
  double total_;
  double width_;
  Eigen::MatrixXd bumps_;
  Eigen::MatrixXd roughness_;            ///< of one boundary's values, by amplitudes
  Eigen::MatrixXd response_;             ///< P x amplitudes
  std::vector<Eigen::MatrixXd> slopes_;  ///< its derivatives along the axes
};

}  // namespace

ShapeFit fitShape(const HarmonicAnnulus& annulus, const TargetSamples& target,
                  const ShapeFitOptions& options, const Monitor& monitor) {
  requireUsable(annulus);
  if (target.points.rows() == 0 || target.points.rows() != target.weights.size() ||
      !(target.weights.minCoeff() >= 0 && target.weights.sum() > 0)) {
    throw InvalidInput("fit: the target needs points with one weight each");
  }
  if (!(options.step > 0 && options.step <= 1) || options.maxIterations < 0 ||
      !(options.smoothness > 0) || !(options.start > 0 && options.start < 1)) {
    throw InvalidInput(
        "fit: step in (0, 1], start in (0, 1), iterations >= 0 and smoothness > 0 are needed");
  }
  for (Eigen::Index p = 0; p < target.points.rows(); ++p) {
    const Point point = target.points.row(p).transpose();
    if (sideOf(annulus, point) == AnnulusSide::Inside) continue;
    Vector d = point - annulus.centre;
    if (annulus.dimension == 2) d.z() = 0;
    throw InvalidInput(printed(
        "fit: the target's point (%.6g, %.6g, %.6g) mm lies outside the annulus: %.6g mm from its "
        "centre, with radii from %.6g to %.6g mm",
        point.x(), point.y(), point.z(), d.norm(), annulus.innerRadius, annulus.outerRadius));
  }
  const Fit fit(annulus, target, options);
  Eigen::VectorXd x = fit.initial(options.start);
  ShapeFit result;
  std::vector<Eigen::VectorXd> states;
  const auto record = [&] {
    states.push_back(x);
    result.shape = fit.shapeOf(x);
    result.history.push_back(fit.account(x));
    result.path.push_back(result.shape);
  };
  record();
  result.termination = Termination::MaxIterations;
  std::size_t best = 0;  // of the history
  for (int k = 0; k < options.maxIterations; ++k) {
    if (monitor.shouldStop()) {
      result.termination = Termination::Interrupted;
      break;
    }
    const Eigen::VectorXd wanted = fit.optimum(x);
    const double apart = fit.apart(wanted, x);
    // What remains of a step that halves the distance each time is as long as the step itself.
    x = apart < kSettled ? wanted : Eigen::VectorXd(x + options.step * (wanted - x));
    record();
    monitor.progress(static_cast<double>(k + 1) / options.maxIterations, "fitting");
    if (apart < kSettled) {
      result.termination = Termination::Converged;
      break;
    }
    const double least = result.history[best].symmetricDifference;
    if (result.history.back().symmetricDifference < (1 - kLeastGain) * least) {
      best = result.history.size() - 1;
    } else if (result.history.size() > best + kStill) {
      // Amplitudes at their bounds change places for ever; the shape no longer gains by it.
      x = states[best];
      record();
      result.termination = Termination::Converged;
      break;
    }
  }
  return result;
}

HarmonicAnnulus annulusAround(const std::vector<TargetSamples>& targets, int dimension,
                              const AnnulusOptions& options) {
  if (targets.empty()) throw InvalidInput("targets: none; the annulus is taken from them");
  HarmonicAnnulus annulus{.dimension = dimension,
                          .order = options.order.value_or(dimension == 2 ? 64 : 14)};
  Point sum = Point::Zero();
  for (const TargetSamples& target : targets) {
    sum += target.points.transpose() * target.weights / target.weights.sum();
  }
  annulus.centre = options.centre.value_or(sum / static_cast<double>(targets.size()));
  if (dimension == 2) annulus.centre.z() = 0;
  double nearest = kInfinity;
  double farthest = 0;
  for (const TargetSamples& target : targets) {
    const Eigen::VectorXd r =
        (target.points.rowwise() - annulus.centre.transpose()).rowwise().norm();
    nearest = std::min(nearest, r.minCoeff());
    farthest = std::max(farthest, r.maxCoeff());
  }
  annulus.innerRadius = options.innerRadius.value_or(0.85 * nearest);
  annulus.outerRadius = options.outerRadius.value_or(1.15 * farthest);
  requireUsable(annulus);
  return annulus;
}

HarmonicShape combine(const std::vector<HarmonicShape>& shapes,
                      const std::vector<double>& weights) {
  if (shapes.empty() || shapes.size() != weights.size()) {
    throw InvalidInput("combine: " + std::to_string(shapes.size()) + " shapes and " +
                       std::to_string(weights.size()) + " weights found, one each is needed");
  }
  double sum = 0;
  for (double w : weights) {
    if (!(w >= 0)) throw InvalidInput("combine: weights must not be negative");
    sum += w;
  }
  if (!(sum > 0)) throw InvalidInput("combine: all weights are zero");
  HarmonicShape result = shapes.front();
  result.inner.setZero();
  result.outer.setZero();
  for (std::size_t s = 0; s < shapes.size(); ++s) {
    if (!sameAnnulus(shapes[s].annulus, result.annulus)) {
      throw InvalidInput("combine: shape " + std::to_string(s) +
                         " lies in another annulus than the first");
    }
    result.inner += weights[s] / sum * shapes[s].inner;
    result.outer += weights[s] / sum * shapes[s].outer;
  }
  return result;
}

}  // namespace explica::shapes
