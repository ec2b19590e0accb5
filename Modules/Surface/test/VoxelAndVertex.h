// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Correspondence/Correspondence.h"
#include "Explica/Correspondence/Ribbon.h"
#include "Explica/Surface/CorticalSurface.h"
#include "Explica/Surface/CorticalTissue.h"

#include <cmath>
#include <cstdio>

namespace explica::surface {

/// Thickness of the voxels around a point, by nearness; NaN if less than a quarter is tissue.
inline double thicknessAround(const Point& point, const harmonic::Annulus& annulus,
                              const correspondence::Correspondence& found) {
  const Vector index = annulus.grid.toIndex(point);
  const auto strides = annulus.strides();
  double sum = 0, weights = 0;
  for (int c = 0; c < 8; ++c) {
    double weight = 1;
    std::ptrdiff_t place = 0;
    bool inBox = true;
    for (int a = 0; a < 3; ++a) {
      const double low = std::floor(index[a]);
      const int at = static_cast<int>(low) + (c >> a & 1) - annulus.first[a];
      inBox = inBox && at >= 0 && at < annulus.size[a];
      weight *= (c >> a & 1) ? index[a] - low : 1 - (index[a] - low);
      place += static_cast<std::ptrdiff_t>(at) * strides[a];
    }
    const std::int32_t n = inBox ? annulus.numberAt[static_cast<std::size_t>(place)] : -1;
    if (n < 0 || std::isnan(found.thickness(static_cast<std::size_t>(n)))) continue;
    sum += weight * found.thickness(static_cast<std::size_t>(n));
    weights += weight;
  }
  return weights > 0.25 ? sum / weights : kNaN;
}

/// A voxel map beside a vertex map.
struct VoxelAndVertex {
  double r = 0, mean = 0, absolute = 0;               ///< voxel minus vertex, mm
  double share = 0;                                   ///< of the vertices, that are compared
  double meanOfVoxels = kNaN, meanOfVertices = kNaN;  ///< over the middle surface, mm
};

inline VoxelAndVertex compare(const char* name, const TissueMasks& masks,
                              const CorticalSurfaces& made) {
  using harmonic::Site;
  Volume<Site> sites(masks.white.grid, Site::Outer);
  for (std::size_t v = 0; v < sites.size(); ++v) {
    sites[v] = masks.white[v]       ? Site::Inner
               : masks.grey[v]      ? Site::Tissue
               : masks.insulated[v] ? Site::Insulated
                                    : Site::Outer;
  }
  const auto ribbon = correspondence::solveRibbon(harmonic::annulusFromSites(sites));
  const auto found = correspondence::findCorrespondences(ribbon.annulus, ribbon.interpolant);
  double n = 0, off = 0, absolute = 0, x = 0, y = 0, xx = 0, yy = 0, xy = 0;
  for (Eigen::Index v = 0; v < made.mid.vertexCount(); ++v) {
    const double a = thicknessAround(made.mid.positions.row(v), ribbon.annulus, found);
    const double b = made.thickness[v];
    if (std::isnan(a) || b == 0) continue;
    ++n;
    off += a - b, absolute += std::abs(a - b);
    x += a, y += b, xx += a * a, yy += b * b, xy += a * b;
  }
  VoxelAndVertex both;
  both.r = (n * xy - x * y) / std::sqrt((n * xx - x * x) * (n * yy - y * y));
  both.mean = off / n;
  both.absolute = absolute / n;
  both.share = n / static_cast<double>((made.thickness.array() > 0).count());
  both.meanOfVoxels = correspondence::summaryOf(found).mean;
  both.meanOfVertices = meanThickness(made.columns.area, made.columns.thickness);
  std::printf(
      "%s, voxel and vertex: r %.4f, mean %+.4f mm, absolute %.4f mm, %.1f %% of the vertices; "
      "means %.4f and %.4f mm\n",
      name, both.r, both.mean, both.absolute, 100 * both.share, both.meanOfVoxels,
      both.meanOfVertices);
  return both;
}

}  // namespace explica::surface
