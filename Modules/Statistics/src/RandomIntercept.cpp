// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "RandomIntercept.h"

#include "Explica/Core/Types.h"

#include <Eigen/Cholesky>
#include <Eigen/QR>
#include <boost/math/tools/minima.hpp>

#include <algorithm>
#include <cmath>
#include <map>

namespace explica::statistics {
namespace {

/// Sums over the groups of one size: all that the likelihood needs of them.
struct SizeSums {
  double count = 0;          // groups of this size
  Eigen::MatrixXd squares;   // p x p, sum of s s^T with s the group's sum of rows of X
  Eigen::VectorXd products;  // p, sum of s times the group's sum of values
  double values = 0;         // sum of squared sums of values
};

/// The restricted likelihood as a function of the ratio alone: coefficients and variance of the
/// residuals have closed forms.
class Profile {
 public:
  Profile(const Eigen::MatrixXd& x, const Eigen::VectorXd& residuals,
          const std::vector<int>& groups)
      : n_(static_cast<double>(x.rows())),
        p_(x.cols()),
        squares_(x.transpose() * x),
        values_(residuals.squaredNorm()) {
    const int count = 1 + *std::max_element(groups.begin(), groups.end());
    Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(p_, count);
    Eigen::VectorXd sums = Eigen::VectorXd::Zero(count);
    std::vector<int> sizes(static_cast<std::size_t>(count), 0);
    for (Eigen::Index i = 0; i < x.rows(); ++i) {
      const int g = groups[i];
      rows.col(g) += x.row(i).transpose();
      sums[g] += residuals[i];
      ++sizes[g];
    }
    for (int g = 0; g < count; ++g) add(sizes[g], rows.col(g), sums[g]);
  }

  /// At a ratio: -2 log restricted likelihood, up to a constant; fills the fit.
  double evaluate(double ratio, PlaceFit* fit = nullptr) const {
    Eigen::MatrixXd a = squares_;
    Eigen::VectorXd c = Eigen::VectorXd::Zero(p_);  // X^T residuals is 0
    double q = values_, logDeterminant = 0;
    for (const auto& [size, sums] : sizes_) {
      const double weight = ratio / (1 + ratio * size);
      a -= weight * sums.squares;
      c -= weight * sums.products;
      q -= weight * sums.values;
      logDeterminant += sums.count * std::log1p(ratio * size);
    }
    const Eigen::LLT<Eigen::MatrixXd> factor(a);
    const Eigen::VectorXd b = factor.solve(c);
    const double variance = std::max((q - c.dot(b)) / (n_ - static_cast<double>(p_)), 0.0);
    if (fit != nullptr) {
      *fit = {b, factor.solve(Eigen::MatrixXd::Identity(p_, p_)), variance, ratio};
    }
    const double logFactor = 2 * factor.matrixLLT().diagonal().array().log().sum();
    return (n_ - static_cast<double>(p_)) * std::log(variance) + logFactor + logDeterminant;
  }

 private:
  void add(int size, const Eigen::VectorXd& row, double sum) {
    if (size == 0) return;
    SizeSums& sums = sizes_[size];
    if (sums.count == 0) {
      sums.squares = Eigen::MatrixXd::Zero(p_, p_);
      sums.products = Eigen::VectorXd::Zero(p_);
    }
    ++sums.count;
    sums.squares += row * row.transpose();
    sums.products += row * sum;
    sums.values += sum * sum;
  }

  double n_;
  Eigen::Index p_;
  Eigen::MatrixXd squares_;
  double values_;
  std::map<int, SizeSums> sizes_;
};

constexpr int kSteps = 48;  // of the first search, over the share of the variance
constexpr int kBits = 40;   // of the refined share: Brent's method halves digits at most

/// The search is over the intercepts' share of the variance, ratio / (1 + ratio), in [0, 1).
double ratioOf(double share) {
  return share / (1 - share);
}

}  // namespace

PlaceFit fitRandomIntercept(const Eigen::MatrixXd& design, const Eigen::VectorXd& values,
                            const std::vector<int>& groups) {
  const Eigen::VectorXd start = design.householderQr().solve(values);
  const Profile profile(design, values - design * start, groups);
  const auto cost = [&](double share) { return profile.evaluate(ratioOf(share)); };
  double best = 0, least = cost(0);
  for (int k = 1; k < kSteps; ++k) {
    const double share = static_cast<double>(k) / kSteps, found = cost(share);
    if (found < least) {
      least = found;
      best = share;
    }
  }
  constexpr double kMostShare = 1 - 1e-9;
  const auto [share, value] = boost::math::tools::brent_find_minima(
      cost, std::max(best - 1.0 / kSteps, 0.0), std::min(best + 1.0 / kSteps, kMostShare), kBits);
  if (value < least) best = share;
  PlaceFit fit;
  profile.evaluate(ratioOf(best), &fit);
  fit.coefficients += start;
  return fit;
}

}  // namespace explica::statistics
