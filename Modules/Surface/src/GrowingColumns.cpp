// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "GrowingColumns.h"

#include "Explica/Core/Parallel.h"
#include "Explica/Geometry/MeshMeasures.h"
#include "PathProfile.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace explica::surface {

CorticalTissue corrected(CorticalTissue tissue, const LevelSet& white) {
  tissue.white = white;
  for (std::size_t v = 0; v < white.size(); ++v) {
    tissue.tissue[v] = std::max(tissue.tissue[v], white[v]);
  }
  return tissue;
}

double stallOf(const geometry::FaceTree& white, std::int32_t face, double voxel, double first,
               const Trajectory& path) {
  // Along the middle between fronts that meet at 120 degrees, distance grows at half the rate of
  // the way.
  constexpr double kRate = 0.5;
  constexpr double kWindow = 0.5;  // voxels
  const auto distanceAt = [&](double arc) {
    const auto nearest = white.closestPoint(path.at(arc), face);
    face = nearest.face;
    return std::sqrt(nearest.squaredDistance);
  };
  const double window = kWindow * voxel, length = path.length();
  const double last = distanceAt(length), gained = last - distanceAt(0);
  if (length - gained < 0.5 * (1 - kRate) * window) return length;  // what it need not look at
  double here = distanceAt(first), next = distanceAt(std::min(first + 0.5 * window, length));
  for (double from = first; from < length; from += 0.5 * window) {
    const double to = std::min(from + window, length);
    const double there = to < length ? distanceAt(to) : last;
    if (to - from >= 0.5 * window && there - here < kRate * (to - from)) return from;
    here = next;
    next = there;
  }
  return length;
}

void takePaths(const TriangleMesh& white, const RibbonPaths& ribbon, GrowingColumns& columns) {
  const LevelSet& tissue = columns.tissue.tissue;
  constexpr double kOff = 0.125;  // voxels: so far outward tissue begins, or there is none
  const double voxel = voxelSize(tissue.grid), off = kOff * voxel;
  const Positions normals = geometry::vertexNormals(white);
  const std::vector<std::int32_t> faceAt = geometry::faceOfEachVertex(white);
  const geometry::FaceTree tree(white);
  std::vector<Trajectory>& paths = columns.paths;
  paths.resize(white.vertexCount());
  parallelFor(paths.size(), 256, [&](std::size_t v) {
    const auto row = static_cast<Eigen::Index>(v);
    const Point start = white.positions.row(row);
    const Vector normal = normals.row(row);
    Trajectory& path = paths[v];
    path = sample(tissue, start + off * normal).value > 0 ? ribbon.outwardFrom(start, normal)
                                                          : ribbon.none(start);
    if (path.end == TrajectoryEnd::NoRibbon) return;
    // Beside a bank's sheet there may be fluid, too.
    if (sample(tissue, along(path, path.length() + 4 * off)).value <= 0) {
      path.end = TrajectoryEnd::Outer;
    }
    const double stall = stallOf(tree, faceAt[v], voxel, 0.25 * voxel, path);
    if (stall < path.length()) {
      cut(path, stall);
      path.end = TrajectoryEnd::Bank;
    }
  });
  keepFromMiddles(middleGap(tissue.grid), paths);
}

}  // namespace explica::surface
