// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "LevelOfEnds.h"

#include "Explica/Core/Parallel.h"
#include "PathProfile.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace explica::surface {
namespace {

/// Share of its band in which a level is a distance.
constexpr float kKnown = 0.98F;

/// A place along a trajectory, in voxels of the grid.
struct Place {
  Eigen::Vector3f index;    ///< continuous
  Eigen::Vector3f outward;  ///< fall of the distance to the border, mm per voxel of each axis
  float rest = 0;           ///< way to the old border, mm; negative beyond it
  float moved = 0;          ///< of the border, outward, mm
};

/// Places along a trajectory around its old border and its new one, half a voxel apart.
void addPlaces(const Trajectory& path, PathBorder border, double moved, const Grid& grid,
               std::vector<Place>& places) {
  constexpr double kAround = 2.5;  // voxels of both sides: a level's band and a half
  const double voxel = voxelSize(grid), step = 0.5 * voxel, around = kAround * voxel;
  const double length = path.length(), old = border == PathBorder::Inner ? 0 : length;
  // Nothing is said beyond the other border.
  const double least = border == PathBorder::Inner ? -around + std::min(0.0, moved) : 0;
  const double most = border == PathBorder::Inner ? length : length + around;
  const double first = std::max(least, old + std::min(0.0, moved) - around);
  const double last = std::min(most, old + around);
  const Along whole(path);
  for (double arc = first; arc <= last; arc += step) {
    const Point at = whole.at(arc);
    const Vector way = whole.at(arc + 0.5 * step) - whole.at(arc - 0.5 * step);
    const Vector axes = (grid.direction.transpose() * way.normalized()).cwiseProduct(grid.spacing);
    places.push_back({grid.toIndex(at).cast<float>(), axes.cast<float>(),
                      static_cast<float>(old - arc), static_cast<float>(moved)});
  }
}

/// What a place says of the distance of a voxel to the new border, mm; NaN where it is another
/// bank's.
/// @param old   distance to the old border, mm, known within `band`
/// @param rest  what it would be by the plane across the trajectory, mm
float saidOf(const Place& place, float old, float rest, float band, float voxel) {
  const bool known = std::abs(old) < kKnown * band;
  const bool own = known ? std::abs(rest - old) < voxel : (rest > 0) == (old > 0);
  return own ? (known ? old : rest) + place.moved : static_cast<float>(kNaN);
}

/// Places by the slice of their nearest voxel.
std::vector<std::vector<Place>> bySlice(const std::vector<Trajectory>& paths, PathBorder border,
                                        const Eigen::VectorXd& moved, const Grid& grid) {
  constexpr std::size_t kBlock = 1024;
  std::vector<std::vector<Place>> parts((paths.size() + kBlock - 1) / kBlock);
  parallelFor(parts.size(), 1, [&](std::size_t part) {
    const std::size_t end = std::min(paths.size(), (part + 1) * kBlock);
    for (std::size_t v = part * kBlock; v < end; ++v) {
      const bool has = border == PathBorder::Inner ? paths[v].end != TrajectoryEnd::NoRibbon
                                                   : paths[v].end == TrajectoryEnd::Outer;
      if (!has) continue;
      addPlaces(paths[v], border, moved[static_cast<Eigen::Index>(v)], grid, parts[part]);
    }
  });
  std::vector<std::vector<Place>> slices(grid.size[2]);
  for (const auto& part : parts) {
    for (const Place& place : part) {
      const auto k = static_cast<int>(std::lround(place.index[2]));
      if (k >= 0 && k < grid.size[2]) slices[k].push_back(place);
    }
  }
  return slices;
}

}  // namespace

LevelSet levelOfEnds(const LevelSet& distance, const std::vector<Trajectory>& paths,
                     PathBorder border, const Eigen::VectorXd& moved) {
  const Grid& grid = distance.grid;
  const auto& n = grid.size;
  const auto voxel = static_cast<float>(voxelSize(grid));
  const auto band = static_cast<float>(bandOf(grid));
  const std::vector<std::vector<Place>> slices = bySlice(paths, border, moved, grid);
  LevelSet level = distance;
  parallelFor(n[2], 1, [&](std::size_t slice) {
    const int k = static_cast<int>(slice);
    const std::size_t size = static_cast<std::size_t>(n[0]) * n[1];
    std::vector<std::array<float, 2>> sums(size, {0, 0});  // of weights and of weighted distances
    for (int z = std::max(0, k - 1); z <= std::min(n[2] - 1, k + 1); ++z) {
      for (const Place& place : slices[z]) {
        const auto i = static_cast<int>(std::lround(place.index[0]));
        const auto j = static_cast<int>(std::lround(place.index[1]));
        for (int y = std::max(0, j - 1); y <= std::min(n[1] - 1, j + 1); ++y) {
          for (int x = std::max(0, i - 1); x <= std::min(n[0] - 1, i + 1); ++x) {
            const Eigen::Vector3f way = Eigen::Vector3f(x, y, k) - place.index;
            const float said = saidOf(place, band * distance(x, y, k),
                                      place.rest - way.dot(place.outward), band, voxel);
            if (std::isnan(said)) continue;
            const float weight = std::exp(-way.squaredNorm());
            auto& sum = sums[x + static_cast<std::size_t>(y) * n[0]];
            sum[0] += weight;
            sum[1] += weight * said;
          }
        }
      }
    }
    constexpr float kOld = 0.1F;  // weight of the old border, of that of a place at the voxel
    for (std::size_t p = 0; p < size; ++p) {
      const std::size_t v = slice * size + p;
      const float mean = (sums[p][1] + kOld * band * distance[v]) / (sums[p][0] + kOld);
      if (sums[p][0] > 0) level[v] = offZero(std::clamp(mean / band, -1.0F, 1.0F));
    }
  });
  return level;
}

}  // namespace explica::surface
