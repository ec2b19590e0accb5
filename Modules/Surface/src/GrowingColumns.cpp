// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "GrowingColumns.h"

#include "Explica/Core/Parallel.h"
#include "Explica/Geometry/MeshMeasures.h"
#include "PathProfile.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
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
  if (length - first < 0.5 * window) return length;
  const double last = distanceAt(length), gained = last - distanceAt(0);
  if (length - gained < 0.5 * (1 - kRate) * window) return length;  // what it need not look at
  // Window k goes from place k to place k + 2.
  std::vector<double> places = {first, std::min(first + 0.5 * window, length)};
  for (double from = first; from < length; from += 0.5 * window) {
    places.push_back(std::min(from + window, length));
  }
  std::vector<double> distances(places.size(), kNaN);
  const auto at = [&](std::size_t k) {
    if (std::isnan(distances[k])) distances[k] = places[k] < length ? distanceAt(places[k]) : last;
    return distances[k];
  };
  // The first of some windows along which distance grows too little, or the number of all.  It
  // grows no more than the way: what is missing of it is no more in one of them than in all.
  const std::size_t windows = places.size() - 2;
  const auto firstSlow = [&](const auto& self, std::size_t begin, std::size_t end) -> std::size_t {
    const double shortest = std::max(0.5 * window, places[end + 1] - places[end - 1]);
    const double way = places[end + 1] - places[begin];
    if (way - (at(end + 1) - at(begin)) <= (1 - kRate) * shortest) return windows;
    if (end - begin == 1) return way >= 0.5 * window ? begin : windows;
    const std::size_t middle = (begin + end) / 2, found = self(self, begin, middle);
    return found < windows ? found : self(self, middle, end);
  };
  const std::size_t slow = windows > 0 ? firstSlow(firstSlow, 0, windows) : 0;
  return slow < windows ? places[slow] : length;
}

void takePaths(const TriangleMesh& white, const RibbonPaths& ribbon, GrowingColumns& columns) {
  const LevelSet& tissue = columns.tissue.tissue;
  const double voxel = voxelSize(tissue.grid), off = kStartOff * voxel;
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
