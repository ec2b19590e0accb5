// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Statistics/RandomField.h"

#include <algorithm>
#include <cmath>

namespace explica::statistics {
namespace {

constexpr int kCells = 4096;         // of the table of logarithms
constexpr double kLeastTail = 1e-6;  // P at the table's lower end

/// (chi^2_nu / nu)^power.
struct ChiPower {
  double nu, power;
};

/// Logarithms of positive random variables on a common grid: y = first + i step, where 0 is a
/// multiple of step.
struct LogGrid {
  double first, step;
  std::vector<double> density;

  [[nodiscard]] double at(int i) const { return first + i * step; }

  /// Becomes the density of the sum with an independent variable.
  void convolve(const std::vector<double>& other) {
    const int shift = static_cast<int>(std::lround(first / step));
    std::vector<double> sum(density.size(), 0.0);
    for (int i = 0; i < kCells; ++i) {
      const int begin = std::max(0, -i - shift), end = std::min(kCells, kCells - i - shift);
      for (int j = begin; j < end; ++j) {
        sum[i + j + shift] += density[i] * other[j] * step;
      }
    }
    density = std::move(sum);
  }
};

std::vector<double> logDensity(const LogGrid& grid, const ChiPower& v) {
  std::vector<double> density(kCells);
  for (int i = 0; i < kCells; ++i) {
    const double x = grid.at(i) / v.power + std::log(v.nu);
    density[i] = std::exp(v.nu / 2 * x - std::exp(x) / 2 - v.nu / 2 * std::log(2.0) -
                          std::lgamma(v.nu / 2)) /
                 std::abs(v.power);
  }
  return density;
}

double meanOf(const ChiPower& v) {
  return std::exp(std::lgamma(v.nu / 2 + v.power) - std::lgamma(v.nu / 2) -
                  v.power * std::log(v.nu / 2));
}

/// The height of a peak above the threshold: Beta(1, (df - 2) / 2) times df / 2, or an exponential
/// variable for a Gaussian field; its mean is 1.
double heightDensity(double y, double df) {
  const double x = std::exp(y);
  if (std::isinf(df)) return std::exp(-x) * x;
  const double share = x / df * 2;
  return share < 1 ? std::pow(1 - share, (df - 2) / 2 - 1) * (df - 2) / 2 * share : 0;
}

/// What multiplies the height: the curvature at the peak, and the roughness where it is estimated.
std::vector<ChiPower> factorsOf(const FieldKind& kind, double roughnessDf) {
  std::vector<ChiPower> factors;
  if (!std::isinf(kind.df)) {
    factors = {{std::max(kind.df1, 1.0) + kind.df - 2, 1}, {kind.df + 1, -0.5}, {kind.df, -0.5}};
  }
  if (!std::isinf(roughnessDf)) {
    for (const ChiPower& one :
         {ChiPower{roughnessDf - 1, 0.5}, {roughnessDf - 2, 0.5}, {roughnessDf, -1}}) {
      factors.push_back(one);
    }
  }
  return factors;
}

LogGrid gridFor(const FieldKind& kind, double roughnessDf) {
  const double df = std::min(std::max(kind.df1, 1.0) + kind.df, roughnessDf);
  const double last = 10 * std::max(std::sqrt(2 / df), 1.0);
  const double lowest =
      std::isinf(kind.df)
          ? std::log(-std::log(1 - kLeastTail))
          : std::log((1 - std::pow(1 - kLeastTail, 2 / (kind.df - 2))) * kind.df / 2);
  LogGrid grid{0, (last - lowest) / kCells, std::vector<double>(kCells)};
  grid.first = std::round(lowest / grid.step) * grid.step;
  return grid;
}

}  // namespace

ClusterSizes::ClusterSizes(double threshold, const FieldKind& kind, double resels,
                           double roughnessDf) {
  const auto densities = eulerDensities(threshold, kind);
  expected_ = resels * densities[2];
  scale_ = densities[0] / densities[2];  // mean resels of a cluster
  if (std::isinf(kind.df) && std::isinf(roughnessDf)) return;
  LogGrid grid = gridFor(kind, roughnessDf);
  for (int i = 0; i < kCells; ++i) grid.density[i] = heightDensity(grid.at(i), kind.df);
  for (const ChiPower& v : factorsOf(kind, roughnessDf)) {
    grid.convolve(logDensity(grid, v));
    scale_ /= meanOf(v);
  }
  first_ = grid.first;
  step_ = grid.step;
  tail_.assign(kCells, 0.0);
  double sum = 0;
  for (std::size_t i = kCells; i-- > 0;) tail_[i] = sum += grid.density[i] * step_;
}

double ClusterSizes::single(double resels) const {
  if (!(resels > 0)) return 1;
  if (tail_.empty()) return std::exp(-resels / scale_);
  // A cell's sum reaches from half a step below its place.
  const double place = (std::log(resels / scale_) + step_ / 2 - first_) / step_;
  if (place <= 0) return tail_.front();
  const auto cell = static_cast<std::size_t>(place);
  if (cell + 1 >= tail_.size()) return 0;
  const double share = place - static_cast<double>(cell);
  return tail_[cell] * (1 - share) + tail_[cell + 1] * share;
}

double ClusterSizes::largest(double resels) const {
  return -std::expm1(-single(resels) * expected_);
}

}  // namespace explica::statistics
