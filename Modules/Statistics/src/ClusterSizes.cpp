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
        sum[static_cast<std::size_t>(i + j + shift)] +=
            density[static_cast<std::size_t>(i)] * other[static_cast<std::size_t>(j)] * step;
      }
    }
    density = std::move(sum);
  }
};

std::vector<double> logDensity(const LogGrid& grid, const ChiPower& v) {
  std::vector<double> density(kCells);
  for (int i = 0; i < kCells; ++i) {
    const double x = grid.at(i) / v.power + std::log(v.nu);
    density[static_cast<std::size_t>(i)] =
        std::exp(v.nu / 2 * x - std::exp(x) / 2 - v.nu / 2 * std::log(2.0) -
                 std::lgamma(v.nu / 2)) /
        std::abs(v.power);
  }
  return density;
}

double meanOf(const ChiPower& v) {
  return std::exp(std::lgamma(v.nu / 2 + v.power) - std::lgamma(v.nu / 2) -
                  v.power * std::log(v.nu / 2));
}

/// The height of a peak above the threshold to the power d / 2: Beta(1, (df - d) / 2), or an
/// exponential variable for a Gaussian field.
double heightDensity(double y, double df, int d) {
  const double a = d / 2.0, x = std::exp(y / a);
  if (std::isinf(df)) return std::exp(-x) * x / a;
  const double share = x / df * 2;
  return share < 1 ? std::pow(1 - share, (df - d) / 2 - 1) * (df - d) / 2 * share / a : 0;
}

double meanHeight(double df, int d) {
  const double a = d / 2.0;
  if (std::isinf(df)) return std::tgamma(a + 1);
  return std::exp(std::lgamma(a + 1) + std::lgamma((df - d + 2) / 2) - std::lgamma((df + 2) / 2) +
                  a * std::log(df / 2));
}

/// What multiplies the height: the curvature at the peak, and the roughness where it is estimated.
std::vector<ChiPower> factorsOf(const FieldKind& kind, double roughnessDf, int d) {
  std::vector<ChiPower> factors;
  const double df1 = kind.df1 > 0 ? kind.df1 : 1;
  if (!std::isinf(kind.df)) {
    factors.push_back({df1 + kind.df - d, d / 2.0});
    for (int k = 1; k <= d; ++k) factors.push_back({kind.df + 2 - k, -0.5});
  }
  if (!std::isinf(roughnessDf)) {
    for (int k = 0; k < d; ++k) factors.push_back({roughnessDf - 1 - k, 0.5});
    factors.push_back({roughnessDf, -d / 2.0});
  }
  return factors;
}

LogGrid gridFor(const FieldKind& kind, double roughnessDf, int d) {
  const double a = d / 2.0, df1 = kind.df1 > 0 ? kind.df1 : 1;
  const double last = a * 10 * std::max(std::sqrt(2 / std::min(df1 + kind.df, roughnessDf)), 1.0);
  const double lowest =
      std::isinf(kind.df)
          ? a * std::log(-std::log(1 - kLeastTail))
          : a * std::log((1 - std::pow(1 - kLeastTail, 2 / (kind.df - d))) * kind.df / 2);
  LogGrid grid{0, (last - lowest) / kCells, std::vector<double>(kCells)};
  grid.first = std::round(lowest / grid.step) * grid.step;
  return grid;
}

}  // namespace

ClusterSizes::ClusterSizes(double threshold, const FieldKind& kind, double resels,
                           double roughnessDf, int dimension) {
  const auto densities = eulerDensities(threshold, kind);
  const double rate = densities[static_cast<std::size_t>(dimension)];
  expected_ = resels * rate;
  const double mean = densities[0] / rate;  // resels of a cluster
  if (std::isinf(kind.df) && std::isinf(roughnessDf)) {
    exponent_ = 2.0 / dimension;
    scale_ = mean / std::tgamma(dimension / 2.0 + 1);
    return;
  }
  LogGrid grid = gridFor(kind, roughnessDf, dimension);
  for (int i = 0; i < kCells; ++i) {
    grid.density[static_cast<std::size_t>(i)] = heightDensity(grid.at(i), kind.df, dimension);
  }
  double factor = meanHeight(kind.df, dimension);
  for (const ChiPower& v : factorsOf(kind, roughnessDf, dimension)) {
    grid.convolve(logDensity(grid, v));
    factor *= meanOf(v);
  }
  first_ = grid.first;
  step_ = grid.step;
  scale_ = mean / factor;
  tail_.assign(kCells, 0.0);
  double sum = 0;
  for (std::size_t i = kCells; i-- > 0;) tail_[i] = sum += grid.density[i] * step_;
}

double ClusterSizes::single(double resels) const {
  if (!(resels > 0)) return 1;
  if (exponent_ > 0) return std::exp(-std::pow(resels / scale_, exponent_));
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
