// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Core/OrderStatistics.h"
#include "Explica/Core/Parallel.h"
#include "Explica/Correspondence/Correspondence.h"

#include <algorithm>
#include <cmath>

namespace explica::correspondence {

using harmonic::Annulus;

std::vector<double> thicknessOf(const Correspondence& correspondence) {
  std::vector<double> thickness(correspondence.innerDistance.size());
  parallelFor(thickness.size(), 1 << 14,
              [&](std::size_t n) { thickness[n] = correspondence.thickness(n); });
  return thickness;
}

std::optional<double> thicknessAt(const Annulus& annulus, const Correspondence& correspondence,
                                  const Point& point) {
  constexpr double kEnough = 0.25;  // of the weight
  const Vector index = annulus.grid.toIndex(point);
  double sum = 0, weights = 0;
  for (int c = 0; c < 8; ++c) {
    double weight = 1;
    std::array<int, 3> corner;
    for (int a = 0; a < 3; ++a) {
      const double low = std::floor(index[a]), upper = index[a] - low;
      corner[a] = static_cast<int>(low) + (c >> a & 1);
      weight *= (c >> a & 1) ? upper : 1 - upper;
    }
    const std::int32_t n = annulus.numberOf(corner);
    if (n < 0 || std::isnan(correspondence.thickness(n))) continue;
    sum += weight * correspondence.thickness(n);
    weights += weight;
  }
  if (!(weights > kEnough)) return {};
  return sum / weights;
}

double columnWeight(const Correspondence& correspondence, std::size_t n) {
  const double thickness = correspondence.thickness(n);
  if (!(thickness > 0)) return 0;
  return 4 * std::min(correspondence.innerDistance[n], correspondence.outerDistance[n]) /
         (thickness * thickness);
}

ThicknessSummary summaryOf(const Correspondence& correspondence) {
  std::vector<double> known = thicknessOf(correspondence);
  double sum = 0, weighted = 0, weights = 0;
  for (std::size_t n = 0; n < known.size(); ++n) {
    if (!(known[n] > 0)) continue;
    const double weight = columnWeight(correspondence, n);
    sum += known[n];
    weighted += weight * known[n];
    weights += weight;
  }
  std::erase_if(known, [](double t) { return !(t > 0); });
  ThicknessSummary summary;
  if (known.empty()) return summary;
  summary.meanOfVoxels = sum / static_cast<double>(known.size());
  summary.mean = weights > 0 ? weighted / weights : kNaN;
  const auto quantile = [&](double q) {
    return nthSmallest(
        known, static_cast<std::size_t>(std::lround(q * static_cast<double>(known.size() - 1))));
  };
  summary.median = quantile(0.5);
  summary.p05 = quantile(0.05);
  summary.p95 = quantile(0.95);
  return summary;
}

}  // namespace explica::correspondence
