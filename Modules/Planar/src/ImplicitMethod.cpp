// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Core/Errors.h"
#include "Explica/Core/StopScope.h"
#include "Explica/Planar/PolygonVisibility.h"
#include "UnfoldingProblem.h"

#include <Eigen/SparseCholesky>

#include <algorithm>
#include <cmath>
#include <string>

namespace explica::planar {
namespace {

constexpr double kBarrierWeight = 1;       // against total flux in mean edges
constexpr double kSoftStiffness = 5;       // of an elastic collar's edges, in the same unit
constexpr double kMassShare = 0.05;        // of the identity in the metric; the rest is smoothness
constexpr double kLongestMove = 0.4;       // of a vertex per step, in mean edges
constexpr double kCompliance = 1e-9;       // makes the saddle-point matrix quasi-definite
constexpr double kLengthTolerance = 1e-7;  // relative, at which a trial's lengths are taken as kept
constexpr int kMostRestorations = 6;       // Newton steps back to the lengths
constexpr int kMostTrials = 25;            // enough to grow the damping to its most
constexpr double kLeastDamping = 1e-6;     // in 1 / edge length squared
constexpr double kMostDamping = 1e8;       // beyond it no step is left to take

/// Newton steps on flux + knot energy + barrier on the manifold of kept lengths:
///
///     [ H  J' ] [ d      ]   [ -g ]
///     [ J   0 ] [ lambda ] = [ -c ],
///
/// H = metric * damping + barrier (its positive part) + tension.  Tension is the curvature of the
/// constraints under their multipliers; once the region is pulled straight it makes the
/// convergence quadratic.
class ImplicitMethod final : public UnfoldingMethod {
 public:
  explicit ImplicitMethod(UnfoldingProblem& problem)
      : problem_(problem),
        unknowns_(2 * static_cast<int>(problem.movers().size())),
        constraints_(static_cast<int>(problem.keptEdges().size())),
        tension_(Eigen::VectorXd::Zero(constraints_)) {}

  double advance() override {
    const Curve start = problem_.curve();
    const double unit = problem_.meanEdge();
    const double longest = kLongestMove * unit;
    const std::vector<VertexEdgePair> pairs =
        problem_.pairsWithin(problem_.barrierRange() + 4 * longest);
    // Repulsion shapes the motion but not its end: it fades as the region comes into view.
    const double hidden = 1 - polygonVisibility(start, problem_.region(), problem_.view()).average;
    knotWeight_ = problem_.options().knotWeight * std::min(1.0, hidden);
    Eigen::VectorXd gradient;
    const double energy = evaluate(start, pairs, &gradient);

    for (int trial = 0; trial < kMostTrials && damping_ <= kMostDamping; ++trial) {
      checkpoint();
      factorize(start, pairs);
      Eigen::VectorXd right(unknowns_ + constraints_);
      right << -gradient, Eigen::VectorXd::Zero(constraints_);
      const Eigen::VectorXd solution = solver_.solve(right);
      if (!solution.allFinite()) {
        damping_ *= 10;
        continue;
      }
      const Eigen::VectorXd direction = solution.head(unknowns_);
      const double size = largest(direction);
      if (!(size > 0)) return 0;
      double share = std::min(1.0, longest / size);
      Curve target = start;
      bool kept = false;
      double safe = 1;
      for (int attempt = 0; attempt < 6; ++attempt) {
        target.positions = moved(start.positions, share * direction);
        kept = restoreLengths(target) &&
               (target.positions - start.positions).rowwise().norm().maxCoeff() < 2 * longest;
        if (!kept) {
          share *= 0.5;
          continue;
        }
        safe = problem_.safeStep(target.positions, pairs);
        if (safe >= 1) break;
        share *= 0.9 * safe;
        kept = false;
        if (share * size < 1e-6 * unit) break;
      }
      if (kept && evaluate(target, pairs, nullptr) < energy) {
        tension_ = solution.tail(constraints_);
        const double step = (target.positions - start.positions).rowwise().norm().maxCoeff();
        problem_.moveTo(target.positions);
        adaptDamping(trial, share);
        return step;
      }
      damping_ = std::max(damping_ * 4, 1e-4);
    }
    damping_ = 1;
    return 0;
  }

  [[nodiscard]] PolygonMethodState state() const override { return {damping_, tension_}; }
  void restore(const PolygonMethodState& state) override {
    if (state.tension.size() != constraints_) {
      throw InvalidInput("resume: the state has " + std::to_string(state.tension.size()) +
                         " edges that keep their length, this run " + std::to_string(constraints_));
    }
    damping_ = state.damping;
    tension_ = state.tension;
  }

 private:
  void adaptDamping(int trial, double share) {
    if (share < 0.25) {
      damping_ *= 3;
    } else if (trial == 0 && share > 0.9) {
      damping_ = std::max(kLeastDamping, 0.5 * damping_);
    }
  }

  /// Energy in units of the total flux of a mean edge; gradient by the moving vertices, 1/mm.
  double evaluate(const Curve& curve, const std::vector<VertexEdgePair>& pairs,
                  Eigen::VectorXd* gradient) {
    const double unit = problem_.meanEdge();
    const double gain = problem_.initialLength() / unit;
    const PolygonVisibility visibility =
        polygonVisibility(curve, problem_.region(), problem_.view());
    const PolygonKnotValue knot = problem_.knot(curve);
    const double knotWeight = knotWeight_ / unit;
    double energy = -gain * visibility.average + knotWeight * knot.value;
    Positions2 all = -gain * visibility.gradient + knotWeight * knot.gradient;
    for (const VertexEdgePair& pair : pairs) {
      const VertexEdgeDistance near = vertexEdgeDistance(curve, pair.vertex, pair.edge);
      if (near.distance >= pair.range) continue;
      const BarrierValue value = barrier(near.distance, pair.range);
      energy += kBarrierWeight * value.value;
      const Eigen::RowVector2d force = kBarrierWeight * value.slope * near.direction.transpose();
      all.row(pair.vertex) += force;
      all.row(pair.edge) -= (1 - near.parameter) * force;
      all.row(curve.next(pair.edge)) -= near.parameter * force;
    }
    for (int e : problem_.softEdges()) {
      const Eigen::RowVector2d t = curve.positions.row(curve.next(e)) - curve.positions.row(e);
      const double strain = t.norm() / problem_.restLength(e) - 1;
      energy += 0.5 * kSoftStiffness * strain * strain;
      const Eigen::RowVector2d force =
          kSoftStiffness * strain / problem_.restLength(e) * t / t.norm();
      all.row(e) -= force;
      all.row(curve.next(e)) += force;
    }
    if (gradient) {
      gradient->resize(unknowns_);
      for (std::size_t k = 0; k < problem_.movers().size(); ++k) {
        gradient->segment<2>(2 * static_cast<Eigen::Index>(k)) =
            all.row(problem_.movers()[k]).transpose();
      }
    }
    return energy;
  }

  /// Adds weight * n n' for the linear form n . (sum of share_k x_k).
  void addOuter(const std::array<int, 3>& vertices, const std::array<double, 3>& shares,
                const Eigen::Matrix2d& block) {
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) {
        const int row = vertices[i] < 0 ? -1 : problem_.slot(vertices[i]);
        const int column = vertices[j] < 0 ? -1 : problem_.slot(vertices[j]);
        if (row < 0 || column < 0) continue;
        for (int a = 0; a < 2; ++a) {
          for (int b = 0; b < 2; ++b) {
            addEntry(2 * row + a, 2 * column + b, shares[i] * shares[j] * block(a, b));
          }
        }
      }
    }
  }

  void addEntry(int row, int column, double value) {
    if (row >= column) entries_.emplace_back(row, column, value);
  }

  void factorize(const Curve& curve, const std::vector<VertexEdgePair>& pairs) {
    const double unit = problem_.meanEdge();
    const double metric = damping_ / (unit * unit);
    entries_.clear();
    // Without kept lengths a smooth metric would stretch the region; the plain one is the flow's.
    const bool smooth = constraints_ > 0;
    for (int k = 0; k < unknowns_; ++k) addEntry(k, k, (smooth ? kMassShare : 1) * metric);
    for (int e = 0; smooth && e < curve.edgeCount(); ++e) {
      const int f = curve.next(e);
      if (problem_.slot(e) < 0 || problem_.slot(f) < 0) continue;
      addOuter({e, f, -1}, {1, -1, 0}, metric * Eigen::Matrix2d::Identity());
    }
    for (const VertexEdgePair& pair : pairs) {
      const VertexEdgeDistance near = vertexEdgeDistance(curve, pair.vertex, pair.edge);
      if (near.distance >= pair.range) continue;
      const double curvature = kBarrierWeight * barrier(near.distance, pair.range).curvature;
      addOuter({pair.vertex, pair.edge, curve.next(pair.edge)},
               {1, near.parameter - 1, -near.parameter},
               curvature * near.direction * near.direction.transpose());
    }
    for (int e : problem_.softEdges()) {
      const Point2 t = (curve.point(curve.next(e)) - curve.point(e)).normalized();
      const double rest = problem_.restLength(e);
      addOuter({e, curve.next(e), -1}, {1, -1, 0},
               kSoftStiffness / (rest * rest) * t * t.transpose());
    }
    for (int row = 0; row < constraints_; ++row) {
      const int e = problem_.keptEdges()[row];
      const int f = curve.next(e);
      const Point2 d = curve.point(f) - curve.point(e);
      const double length = d.norm();
      const Point2 t = d / length;
      for (int axis = 0; axis < 2; ++axis) {
        addEntry(unknowns_ + row, 2 * problem_.slot(e) + axis, -t[axis]);
        addEntry(unknowns_ + row, 2 * problem_.slot(f) + axis, t[axis]);
      }
      addEntry(unknowns_ + row, unknowns_ + row, -kCompliance * unit * unit);
      if (tension_[row] > 0) {
        addOuter({e, f, -1}, {1, -1, 0},
                 tension_[row] / length * (Eigen::Matrix2d::Identity() - t * t.transpose()));
      }
    }
    matrix_.resize(unknowns_ + constraints_, unknowns_ + constraints_);
    matrix_.setFromTriplets(entries_.begin(), entries_.end());
    checkpoint();
    solver_.analyzePattern(matrix_);
    checkpoint();
    solver_.factorize(matrix_);
    checkpoint();
  }

  /// Newton steps back to the kept lengths in the metric of the last factorisation.
  bool restoreLengths(Curve& curve) const {
    if (constraints_ == 0) return true;
    for (int k = 0;; ++k) {
      Eigen::VectorXd right = Eigen::VectorXd::Zero(unknowns_ + constraints_);
      double worst = 0;
      for (int row = 0; row < constraints_; ++row) {
        const int e = problem_.keptEdges()[row];
        const double rest = problem_.restLength(e);
        const double excess = (curve.point(curve.next(e)) - curve.point(e)).norm() - rest;
        right[unknowns_ + row] = -excess;
        worst = std::max(worst, std::abs(excess) / rest);
      }
      if (worst < kLengthTolerance) return true;
      if (k == kMostRestorations || !(worst < 1)) return false;
      const Eigen::VectorXd solution = solver_.solve(right);
      if (!solution.allFinite()) return false;
      curve.positions = moved(curve.positions, solution.head(unknowns_));
    }
  }

  [[nodiscard]] Positions2 moved(const Positions2& from, const Eigen::VectorXd& by) const {
    Positions2 to = from;
    for (std::size_t k = 0; k < problem_.movers().size(); ++k) {
      to.row(problem_.movers()[k]) += by.segment<2>(2 * static_cast<Eigen::Index>(k)).transpose();
    }
    return to;
  }

  [[nodiscard]] double largest(const Eigen::VectorXd& motion) const {
    double size = 0;
    for (Eigen::Index k = 0; k < unknowns_; k += 2) {
      size = std::max(size, motion.segment<2>(k).norm());
    }
    return size;
  }

  UnfoldingProblem& problem_;
  int unknowns_;
  int constraints_;
  Eigen::VectorXd tension_;  ///< the constraints' multipliers of the last step, 1/mm
  double damping_ = 1;
  double knotWeight_ = 0;  ///< of this iteration
  std::vector<Eigen::Triplet<double>> entries_;
  Eigen::SparseMatrix<double> matrix_;  ///< lower triangle
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver_;
};

}  // namespace

std::unique_ptr<UnfoldingMethod> makeImplicitMethod(UnfoldingProblem& problem) {
  return std::make_unique<ImplicitMethod>(problem);
}

}  // namespace explica::planar
