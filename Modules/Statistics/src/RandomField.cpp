// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Statistics/RandomField.h"

#include "Explica/Core/Types.h"
#include "Explica/Statistics/Distributions.h"

#include <algorithm>
#include <cmath>

namespace explica::statistics {
namespace {

const double kFourLog2 = 4 * std::log(2.0);  // from a Gaussian kernel's variance to its FWHM^2

// The expected Euler characteristic of fields in two dimensions has its maximum near 1 for t, near
// (df1 + 1) / df1 for F, and falls beyond 3 for all but the smallest df.
constexpr double kTailBegins = 3;
constexpr double kTailSteps = 48;

bool allIn(const std::vector<bool>& mask, const Faces& faces, Eigen::Index f) {
  return mask[faces(f, 0)] && mask[faces(f, 1)] && mask[faces(f, 2)];
}

std::array<double, 3> densitiesOfT(double t, double df) {
  if (std::isinf(df)) {
    const double tail = std::exp(-t * t / 2);
    return {tTail(t, df), std::sqrt(kFourLog2) / (2 * kPi) * tail,
            kFourLog2 / std::pow(2 * kPi, 1.5) * t * tail};
  }
  const double tail = std::exp(-(df - 1) / 2 * std::log1p(t * t / df));
  const double gammas =
      std::exp(std::lgamma((df + 1) / 2) - std::lgamma(df / 2)) / std::sqrt(df / 2);
  return {tTail(t, df), std::sqrt(kFourLog2) / (2 * kPi) * tail,
          kFourLog2 / std::pow(2 * kPi, 1.5) * gammas * t * tail};
}

/// Of F with infinite df2: a chi-squared field at df1 f.
std::array<double, 3> densitiesOfChi(double f, double k) {
  const double x = k * f;
  const double log =
      (k - 2) / 2 * std::log(x) - x / 2 - (k - 2) / 2 * std::log(2.0) - std::lgamma(k / 2);
  const double shared = std::exp(log);
  return {fTail(f, k, kInfinity), std::sqrt(kFourLog2 * x) * shared / std::sqrt(2 * kPi),
          kFourLog2 / (2 * kPi) * shared * (x - (k - 1))};
}

std::array<double, 3> densitiesOfF(double f, double k, double df) {
  if (f <= 0) return {1, 0, 0};
  if (std::isinf(df)) return densitiesOfChi(f, k);
  const double x = k * f / df;
  const double shared =
      -(df + k - 2) / 2 * std::log1p(x) - std::lgamma(df / 2) - std::lgamma(k / 2);
  const double one = std::sqrt(kFourLog2 / kPi) *
                     std::exp(shared + std::lgamma((df + k - 1) / 2) + (k - 1) / 2 * std::log(x));
  const double two = kFourLog2 / (2 * kPi) *
                     std::exp(shared + std::lgamma((df + k - 2) / 2) + (k - 2) / 2 * std::log(x)) *
                     ((df - 1) * x - (k - 1));
  return {fTail(f, k, df), one, two};
}

}  // namespace

Resels reselsOf(const Faces& faces, const geometry::MeshTopology& topology,
                const Eigen::VectorXd& roughness, const std::vector<bool>& mask) {
  Resels resels;
  resels.perVertex = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(mask.size()));
  resels.places = static_cast<double>(std::count(mask.begin(), mask.end(), true));
  double euler = resels.places, halfLength = 0, area = 0;
  for (Eigen::Index e = 0; e < topology.edges.rows(); ++e) {
    if (!mask[topology.edges(e, 0)] || !mask[topology.edges(e, 1)]) {
      continue;
    }
    euler -= 1;
    halfLength += std::sqrt(roughness[e]);
  }
  for (Eigen::Index f = 0; f < faces.rows(); ++f) {
    if (!allIn(mask, faces, f)) continue;
    const double a = roughness[topology.faceEdges(f, 0)], b = roughness[topology.faceEdges(f, 1)],
                 c = roughness[topology.faceEdges(f, 2)];
    euler += 1;
    halfLength -= (std::sqrt(a) + std::sqrt(b) + std::sqrt(c)) / 2;
    const double faceArea = std::sqrt(std::max(4 * a * b - (a + b - c) * (a + b - c), 0.0)) / 4;
    area += faceArea;
    for (int k = 0; k < 3; ++k) resels.perVertex[faces(f, k)] += faceArea / 3 / kFourLog2;
  }
  resels.byDimension = {euler, halfLength / std::sqrt(kFourLog2), area / kFourLog2};
  return resels;
}

std::array<double, 3> eulerDensities(double threshold, const FieldKind& kind) {
  return kind.df1 > 0 ? densitiesOfF(threshold, kind.df1, kind.df)
                      : densitiesOfT(threshold, kind.df);
}

double peakProbability(double threshold, const FieldKind& kind, const Resels& resels) {
  const auto bound = [&](double height) {
    const auto densities = eulerDensities(height, kind);
    double expected = 0;
    for (std::size_t d = 0; d < 3; ++d) expected += resels.byDimension[d] * densities[d];
    return std::min(expected, resels.places * densities[0]);
  };
  // The Euler characteristic falls again towards low thresholds, where it counts holes; the
  // probability does not.
  double largest = bound(threshold);
  for (double height = threshold; height < kTailBegins && largest < 1;) {
    height = std::max(height, 0.0) + kTailBegins / kTailSteps;
    largest = std::max(largest, bound(height));
  }
  return std::clamp(largest, 0.0, 1.0);
}

}  // namespace explica::statistics
