// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Correspondence/ImageEdge.h"

#include "Explica/Core/Parallel.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

namespace explica::correspondence {

namespace {

using harmonic::Annulus;

/// The voxels' centres, mm along the grid's axes.
std::vector<Vector> placesOf(const Annulus& annulus) {
  std::vector<Vector> places(annulus.count());
  parallelFor(places.size(), 1 << 14, [&](std::size_t n) {
    places[n] = annulus.index(static_cast<std::int32_t>(n)).cwiseProduct(annulus.grid.spacing);
  });
  return places;
}

bool onEdge(const Annulus& annulus, std::int32_t n, const std::array<bool, 3>& axes) {
  const auto s = annulus.boxSubscripts(n);
  for (int a = 0; a < 3; ++a) {
    const int at = s[a] + annulus.first[a];
    if (axes[a] && (at == 0 || at + 1 == annulus.grid.size[a])) return true;
  }
  return false;
}

/// For each tissue voxel the nearest one that `isSource` holds for, carried from voxel to voxel
/// through the tissue; -1: none.
template <class IsSource>
std::vector<std::int32_t> nearestOf(const Annulus& annulus, const std::vector<Vector>& places,
                                    const IsSource& isSource) {
  const Vector& h = annulus.grid.spacing;
  std::vector<std::int32_t> nearest(annulus.count(), -1), waiting, next;
  std::vector<double> squared(annulus.count(), kInfinity);  // distance, mm^2
  for (std::int32_t n = 0; n < static_cast<std::int32_t>(annulus.count()); ++n) {
    if (!isSource(n)) continue;
    nearest[n] = n;
    squared[n] = 0;
    waiting.push_back(n);
  }
  for (; !waiting.empty(); waiting.swap(next), next.clear()) {
    for (const std::int32_t n : waiting) {
      const Vector way = places[n] - places[nearest[n]];
      const double here = way.squaredNorm();
      for (int d = 0; d < 6; ++d) {
        const std::int32_t m = annulus.links[n][d];
        if (m < 0) continue;
        const int a = harmonic::axisOf(d);
        const double offered = here + h[a] * (h[a] + 2 * harmonic::signOf(d) * way[a]);
        if (!(offered < squared[m])) continue;
        squared[m] = offered;
        nearest[m] = nearest[n];
        next.push_back(m);
      }
    }
  }
  return nearest;
}

/// Marks voxels without thickness that are nearer to the edge than to one of the two boundaries.
void markLeaving(const Annulus& annulus, const std::vector<Vector>& places,
                 const std::vector<std::int32_t>& onEdgeNearest,
                 const Correspondence& correspondence, std::vector<std::uint8_t>& marked) {
  std::array<std::vector<std::int32_t>, 2> beside;
  parallelFor(2, 1, [&](std::size_t side) {
    const std::int32_t wall = side == 0 ? harmonic::kInner : harmonic::kOuter;
    beside[side] = nearestOf(annulus, places, [&annulus, wall](std::int32_t n) {
      const auto& links = annulus.links[n];
      return std::find(links.begin(), links.end(), wall) != links.end();
    });
  });
  const auto wayTo = [&](std::int32_t n, std::int32_t m) {
    return m < 0 ? kInfinity : (places[n] - places[m]).norm();
  };
  for (std::int32_t n = 0; n < static_cast<std::int32_t>(annulus.count()); ++n) {
    if (!std::isnan(correspondence.thickness(n)) || onEdgeNearest[n] < 0) continue;
    marked[n] =
        wayTo(n, onEdgeNearest[n]) < std::max(wayTo(n, beside[0][n]), wayTo(n, beside[1][n]));
  }
}

}  // namespace

std::vector<std::uint8_t> nearImageEdge(const Annulus& annulus, const std::array<bool, 3>& axes,
                                        const Correspondence& correspondence) {
  const std::vector<Vector> places = placesOf(annulus);
  const std::vector<std::int32_t> nearest =
      nearestOf(annulus, places, [&](std::int32_t n) { return onEdge(annulus, n, axes); });
  if (std::all_of(nearest.begin(), nearest.end(), [](std::int32_t n) { return n < 0; })) return {};
  std::vector<std::uint8_t> marked(annulus.count(), 0);
  if (correspondence.missing > 0) markLeaving(annulus, places, nearest, correspondence, marked);
  const Eigen::Matrix3d toAxes = annulus.grid.direction.transpose();
  parallelFor(annulus.count(), 1 << 12, [&](std::size_t index) {
    const auto n = static_cast<std::int32_t>(index);
    const double thickness = correspondence.thickness(n);
    if (nearest[n] < 0 || std::isnan(thickness)) return;
    const Vector way = places[n] - places[nearest[n]];
    const auto from = [&](const Eigen::Vector3f& point) {
      return (way + toAxes * point.cast<double>()).norm();
    };
    const double least = std::min(
        {way.norm(), from(correspondence.innerPoint[n]), from(correspondence.outerPoint[n])});
    marked[n] = least < kEdgeReach * thickness;
  });
  return marked;
}

}  // namespace explica::correspondence
