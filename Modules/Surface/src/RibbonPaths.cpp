// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "RibbonPaths.h"

#include "Explica/Core/Parallel.h"
#include "Explica/Core/VoxelSets.h"
#include "Explica/Surface/LevelSet.h"

#include <array>
#include <cmath>
#include <utility>

namespace explica::surface {

RibbonPaths::RibbonPaths(const correspondence::Ribbon& ribbon)
    : annulus_(ribbon.annulus),
      tracer_(ribbon.annulus, ribbon.interpolant),
      isSulcal_(ribbon.annulus.count(), 0) {
  for (const std::int32_t n : ribbon.sulcalVoxels) isSulcal_[n] = 1;
}

double middleGap(const Grid& grid) {
  constexpr double kGap = 0.1;  // voxels
  return kGap * voxelSize(grid);
}

Trajectory RibbonPaths::none(const Point& start) {
  return {{{start}, {0}}, TrajectoryEnd::NoRibbon};
}

Trajectory RibbonPaths::from(const Point& start, double target) const {
  auto found = tracer_.path(start, target);
  if (!found || found->points.size() < 2) return none(start);
  Trajectory path{std::move(*found), TrajectoryEnd::Outer};
  cut(path, path.length());
  if (target > 0 && isBank(path.points.back())) path.end = TrajectoryEnd::Bank;
  return path;
}

Trajectory RibbonPaths::outwardFrom(const Point& start, const Vector& normal) const {
  // A little outward, so that a thin sheet's other side is not the nearest tissue.
  const double off = kStartOff * voxelSize(annulus_.grid);
  Trajectory path = from(start + off * normal, 1);
  path.points.front() = start;
  for (std::size_t k = 1; k < path.along.size(); ++k) path.along[k] += static_cast<float>(off);
  return path;
}

bool RibbonPaths::isTissue(const Point& point) const {
  const std::int64_t voxel = voxelAt(annulus_.grid, point);
  return voxel >= 0 && annulus_.numberOf(annulus_.grid.subscripts(voxel)) >= 0;
}

bool RibbonPaths::isBank(const Point& point) const {
  const Vector index = annulus_.grid.toIndex(point);
  for (int c = 0; c < 8; ++c) {
    std::array<int, 3> corner;
    for (int a = 0; a < 3; ++a) corner[a] = static_cast<int>(std::floor(index[a])) + (c >> a & 1);
    const std::int32_t n = annulus_.numberOf(corner);
    if (n >= 0 && isSulcal_[n]) return true;
  }
  return false;
}

void cut(Trajectory& path, double end) {
  // What goes on beyond the end has the last segment's direction: it must not be a splinter.
  constexpr double kShortest = 0.1;  // of the path
  const Point last = path.at(end);
  while (path.along.size() > 2 && path.along[path.along.size() - 2] > (1 - kShortest) * end) {
    path.along.pop_back();
    path.points.pop_back();
  }
  path.points.back() = last;
  path.along.back() = static_cast<float>(end);
}

void keepFromMiddles(double gap, std::vector<Trajectory>& paths) {
  parallelFor(paths.size(), 1024, [&](std::size_t v) {
    Trajectory& path = paths[v];
    if (path.end == TrajectoryEnd::Bank && path.length() > gap) cut(path, path.length() - gap);
  });
}

}  // namespace explica::surface
