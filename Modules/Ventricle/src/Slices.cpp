// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Ventricle/Slices.h"

#include "Explica/Core/Parallel.h"
#include "Explica/Core/VoxelSets.h"

#include <numeric>

namespace explica::ventricle {

namespace {

SliceKind kindOf(const Slice& slice) {
  if (slice.cavity == 0) return slice.wall == 0 ? SliceKind::Empty : SliceKind::Cap;
  if (slice.wall == 0) return SliceKind::CavityOnly;
  if (slice.openShare >= kValveShare) return SliceKind::Valve;
  return slice.openShare > 0 ? SliceKind::OpenRing : SliceKind::Ring;
}

Slice sliceAt(const Volume<Label>& heart, int k) {
  const auto& size = heart.grid.size;
  const Eigen::Vector2d pixel = heart.grid.spacing.head<2>();
  Slice slice;
  Eigen::Vector2d cavitySum = Eigen::Vector2d::Zero(), wallSum = cavitySum;
  std::size_t outline = 0;
  const auto edge = [&](int i, int j, int di, int dj) {
    const int p = i + di, q = j + dj;
    const bool inside = p >= 0 && q >= 0 && p < size[0] && q < size[1];
    const Label other = inside ? heart(p, q, k) : kOutside;
    if (other == kCavity) return;
    ++outline;
    if (other == kWall) return;
    slice.contacts.emplace_back(Eigen::Vector2d(i + 0.5 * di, j + 0.5 * dj).cwiseProduct(pixel));
  };
  for (int j = 0; j < size[1]; ++j) {
    for (int i = 0; i < size[0]; ++i) {
      const Label label = heart(i, j, k);
      const Eigen::Vector2d at = Eigen::Vector2d(i, j).cwiseProduct(pixel);
      if (label == kWall) {
        ++slice.wall;
        wallSum += at;
      }
      if (label != kCavity) continue;
      ++slice.cavity;
      cavitySum += at;
      edge(i, j, -1, 0), edge(i, j, 1, 0), edge(i, j, 0, -1), edge(i, j, 0, 1);
    }
  }
  if (slice.cavity > 0) {
    slice.centre = cavitySum / static_cast<double>(slice.cavity);
  } else if (slice.wall > 0) {
    slice.centre = wallSum / static_cast<double>(slice.wall);
  }
  if (outline > 0) {
    slice.openShare = static_cast<double>(slice.contacts.size()) / static_cast<double>(outline);
  }
  slice.kind = kindOf(slice);
  return slice;
}

}  // namespace

std::vector<Slice> slicesOf(const Volume<Label>& heart) {
  std::vector<Slice> slices(static_cast<std::size_t>(heart.grid.size[2]));
  parallelFor(slices.size(), 1,
              [&](std::size_t k) { slices[k] = sliceAt(heart, static_cast<int>(k)); });
  return slices;
}

std::int64_t missingSlices(const Volume<Label>& heart) {
  std::int64_t missing = 0, since = 0;
  bool begun = false;
  for (const Slice& slice : slicesOf(heart)) {
    if (slice.cavity > 0 && slice.wall > 0) {
      if (begun) missing += since;
      begun = true;
      since = 0;
    } else {
      ++since;
    }
  }
  return missing;
}

std::int64_t enclosedVoxels(const Volume<Label>& heart) {
  Grid plane = heart.grid;
  plane.size[2] = 1;
  std::int64_t enclosed = 0;
  for (int k = 0; k < heart.grid.size[2]; ++k) {
    VoxelSet rest(plane, 0);
    for (std::size_t v = 0; v < rest.size(); ++v) {
      const Label label = heart[v + static_cast<std::size_t>(k) * rest.size()];
      rest[v] = label != kCavity && label != kWall;
    }
    const Components pieces = componentsOf(rest);
    std::vector<std::int64_t> inside = pieces.size;
    for (std::size_t v = 0; v < rest.size(); ++v) {
      const auto [i, j, _] = plane.subscripts(v);
      const bool atEdge = i == 0 || j == 0 || i + 1 == plane.size[0] || j + 1 == plane.size[1];
      if (rest[v] && atEdge) inside[pieces.number[v]] = 0;
    }
    enclosed += std::accumulate(inside.begin(), inside.end(), std::int64_t{0});
  }
  return enclosed;
}

double openShareOf(const Volume<Label>& heart) {
  const Grid& grid = heart.grid;
  const Vector area(grid.spacing[1] * grid.spacing[2], grid.spacing[2] * grid.spacing[0],
                    grid.spacing[0] * grid.spacing[1]);
  struct Faces {
    double all = 0, open = 0;
    Faces& operator+=(const Faces& other) {
      all += other.all, open += other.open;
      return *this;
    }
  };
  const Faces faces =
      parallelSum(heart.size(), 1 << 14, Faces{}, [&](std::size_t begin, std::size_t end) {
        Faces sum;
        for (std::size_t v = begin; v < end; ++v) {
          if (heart[v] != kCavity) continue;
          const auto neighbours = grid.neighbours(v);
          for (int d = 0; d < 6; ++d) {
            const Label other = neighbours[d] < 0 ? kOutside : heart[neighbours[d]];
            if (other == kCavity) continue;
            sum.all += area[d / 2];
            if (other != kWall) sum.open += area[d / 2];
          }
        }
        return sum;
      });
  return faces.all > 0 ? faces.open / faces.all : kNaN;
}

}  // namespace explica::ventricle
