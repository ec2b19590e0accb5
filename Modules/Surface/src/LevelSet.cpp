// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Surface/LevelSet.h"

#include "Explica/Core/Parallel.h"
#include "Explica/Core/VoxelSets.h"
#include "Explica/Harmonic/LabelBoundary.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

namespace explica::surface {
namespace {

/// The level's means over neighbouring links smooth by themselves, so that steps are believed
/// sooner than where single links are measured: known points of a cortex are nearest with a strong
/// pull, spheres want it only where curvature changes, noisy masks want little of it.
constexpr harmonic::LabelTrust kTrust{30, 0.004F, 0.02F};
/// Distance at which a label's level reaches 1, in voxels of the coarsest axis.
constexpr float kBand = 2;

/// A mask's boundary as a voxel beside it sees it.
struct Seen {
  float level = 0;                                   ///< signed distance, mm, positive inside
  Eigen::Vector3f inward = Eigen::Vector3f::Zero();  ///< its gradient along the grid's axes
  int crossings = 0;                                 ///< of the voxel's links; 0: not beside it
};

/// The zero of a level set as LabelBoundary describes that of labels: linear between voxel centres.
class ZeroBoundary {
 public:
  explicit ZeroBoundary(const LevelSet& level) : level_(level) {}

  /// From voxel p towards the next one along an axis, voxels.
  [[nodiscard]] double place(std::int32_t p, int axis) const {
    const double here = level_[p], there = level_[p + stride(axis)];
    return here / (here - there);
  }
  /// Outward there, per voxel of each axis, of any length.
  [[nodiscard]] Eigen::Vector3f normal(std::int32_t p, int axis) const {
    Eigen::Vector3f rise;
    for (int a = 0; a < 3; ++a) {
      rise[a] = a == axis ? level_[p + stride(a)] - level_[p]
                          : 0.5F * (slope(p, a) + slope(p + stride(axis), a));
    }
    return -rise;
  }

 private:
  [[nodiscard]] std::int32_t stride(int axis) const {
    const auto& n = level_.grid.size;
    return axis == 0 ? 1 : axis == 1 ? n[0] : n[0] * n[1];
  }
  [[nodiscard]] float slope(std::int32_t p, int axis) const {
    const int at = level_.grid.subscripts(static_cast<std::size_t>(p))[axis];
    const std::int32_t before = at > 0 ? p - stride(axis) : p;
    const std::int32_t after = at + 1 < level_.grid.size[axis] ? p + stride(axis) : p;
    return after > before ? (level_[after] - level_[before]) /
                                static_cast<float>((after - before) / stride(axis))
                          : 0;
  }
  const LevelSet& level_;
};

/// Means over a voxel's crossed links of the distance to the tangent plane there, and of its
/// normal.
template <class Boundary>
Seen seenFrom(const std::array<int, 3>& at, const Volume<std::uint8_t>& mask,
              const Boundary& boundary) {
  const auto& n = mask.grid.size;
  const std::array<std::int32_t, 3> strides = {1, n[0], n[0] * n[1]};
  const auto p = static_cast<std::int32_t>(mask.grid.linear(at[0], at[1], at[2]));
  Seen seen;
  for (int axis = 0; axis < 3; ++axis) {
    for (const int step : {-1, 1}) {
      const int to = at[axis] + step;
      if (to < 0 || to >= n[axis] || mask[p + step * strides[axis]] == mask[p]) continue;
      const std::int32_t low = step > 0 ? p : p - strides[axis];
      const auto place = static_cast<float>(boundary.place(low, axis));
      const Eigen::Vector3f inIndex = boundary.normal(low, axis);
      const Eigen::Vector3f outward = inIndex.cwiseQuotient(mask.grid.spacing.cast<float>());
      seen.level += (step > 0 ? place : 1 - place) * std::abs(inIndex[axis]) / outward.norm();
      seen.inward -= outward.normalized();
      ++seen.crossings;
    }
  }
  if (seen.crossings == 0) return seen;
  seen.level *= (mask[p] ? 1.0F : -1.0F) / static_cast<float>(seen.crossings);
  seen.inward /= static_cast<float>(seen.crossings);
  return seen;
}

template <class T>
Volume<T> cropped(const Volume<T>& volume, const VoxelBox& box, T outside) {
  Volume<T> part(gridOf(volume.grid, box), outside);
  for (int k = 0; k < box.size[2]; ++k) {
    for (int j = 0; j < box.size[1]; ++j) {
      for (int i = 0; i < box.size[0]; ++i) {
        const int x = i + box.low[0], y = j + box.low[1], z = k + box.low[2];
        if (volume.grid.contains(x, y, z)) part(i, j, k) = volume(x, y, z);
      }
    }
  }
  return part;
}

}  // namespace

VoxelBox boundingBox(const Volume<std::uint8_t>& mask, int margin) {
  const auto& n = mask.grid.size;
  struct Range {
    Eigen::AlignedBox3i box;
    void operator+=(const Range& other) { box.extend(other.box); }
  };
  const auto slices = static_cast<std::size_t>(n[2]);
  const Eigen::AlignedBox3i found =
      parallelSum(slices, 4, Range{}, [&](std::size_t begin, std::size_t end) {
        Range range;
        for (int k = static_cast<int>(begin); k < static_cast<int>(end); ++k) {
          for (int j = 0; j < n[1]; ++j) {
            for (int i = 0; i < n[0]; ++i) {
              if (mask(i, j, k)) range.box.extend(Eigen::Vector3i(i, j, k));
            }
          }
        }
        return range;
      }).box;
  VoxelBox box;
  if (found.isEmpty()) return box;
  for (int a = 0; a < 3; ++a) {
    box.low[a] = found.min()[a] - margin;
    box.size[a] = found.sizes()[a] + 1 + 2 * margin;
  }
  return box;
}

Grid gridOf(const Grid& grid, const VoxelBox& box) {
  Grid part = grid;
  part.size = box.size;
  part.origin = grid.toWorld(Vector(box.low[0], box.low[1], box.low[2]));
  return part;
}

Volume<std::uint8_t> crop(const Volume<std::uint8_t>& volume, const VoxelBox& box,
                          std::uint8_t outside) {
  return cropped(volume, box, outside);
}

Volume<float> crop(const Volume<float>& volume, const VoxelBox& box, float outside) {
  return cropped(volume, box, outside);
}

namespace {

/// Where in each row of a grid there are crossings, so that nobody looks for them elsewhere.
class CrossedRows {
 public:
  /// @param numberOf  per voxel; below 0 where there is no crossing
  CrossedRows(const std::vector<std::int32_t>& numberOf, const std::array<int, 3>& size)
      : size_(size), rows_(static_cast<std::size_t>(size[1]) * size[2], {size[0], -2}) {
    parallelFor(rows_.size(), 256, [&](std::size_t row) {
      for (int i = 0; i < size_[0]; ++i) {
        if (numberOf[row * size_[0] + i] < 0) continue;
        rows_[row][0] = std::min(rows_[row][0], i);
        rows_[row][1] = i;
      }
    });
  }

  /// First and last voxel of a row that may have a crossing among its 26 neighbours or itself.
  [[nodiscard]] std::array<int, 2> near(int j, int k) const {
    std::array<int, 2> range = {size_[0], -2};
    for (int z = std::max(k - 1, 0); z <= std::min(k + 1, size_[2] - 1); ++z) {
      for (int y = std::max(j - 1, 0); y <= std::min(j + 1, size_[1] - 1); ++y) {
        const auto& row = rows_[static_cast<std::size_t>(z) * size_[1] + y];
        range[0] = std::min(range[0], row[0]);
        range[1] = std::max(range[1], row[1]);
      }
    }
    return {range[0] - 1, range[1] + 1};
  }

 private:
  std::array<int, 3> size_;
  std::vector<std::array<int, 2>> rows_;
};

/// Distance to a boundary between voxels of two sides, 1 inside, in bands of it.
template <class Boundary>
LevelSet distanceTo(const Boundary& boundary, const Volume<std::uint8_t>& side) {
  const Grid& grid = side.grid;
  const auto& n = grid.size;
  std::vector<std::vector<Seen>> seenIn(n[2]);
  std::vector<std::int32_t> numberOf(side.size(), -1);  // within the slice
  parallelFor(n[2], 1, [&](std::size_t slice) {
    const int k = static_cast<int>(slice);
    for (int j = 0; j < n[1]; ++j) {
      for (int i = 0; i < n[0]; ++i) {
        const Seen seen = seenFrom({i, j, k}, side, boundary);
        if (seen.crossings == 0) continue;
        numberOf[grid.linear(i, j, k)] = static_cast<std::int32_t>(seenIn[k].size());
        seenIn[k].push_back(seen);
      }
    }
  });

  const Eigen::Vector3f spacing = grid.spacing.cast<float>();
  const float scale = 1 / (kBand * spacing.maxCoeff());
  const float least = kLeastLevel * spacing.minCoeff() / spacing.maxCoeff();
  LevelSet level(grid);
  const CrossedRows crossed(numberOf, n);
  parallelFor(n[2], 1, [&](std::size_t slice) {
    const int k = static_cast<int>(slice);
    for (int j = 0; j < n[1]; ++j) {
      const auto [first, last] = crossed.near(j, k);
      for (int i = 0; i < n[0]; ++i) {
        const std::size_t v = grid.linear(i, j, k);
        if (i < first || i > last) {
          level[v] = side[v] ? 1.0F : -1.0F;
          continue;
        }
        float distance = 0, weightSum = 0;
        const auto add = [&](int x, int y, int z) {
          if (!grid.contains(x, y, z)) return;
          const std::size_t w = grid.linear(x, y, z);
          if (numberOf[w] < 0 || side[w] != side[v]) return;
          const Seen& seen = seenIn[z][numberOf[w]];
          const Eigen::Vector3f way(i - x, j - y, k - z);
          const float weight = w == v ? 1 : 1 / way.squaredNorm();
          distance += weight * (seen.level + seen.inward.dot(way.cwiseProduct(spacing)));
          weightSum += weight;
        };
        if (numberOf[v] >= 0) {
          add(i, j, k);
        } else {
          // Cells that the surface crosses have corners that no crossed link ends at.
          for (int z = k - 1; z <= k + 1; ++z) {
            for (int y = j - 1; y <= j + 1; ++y) {
              for (int x = i - 1; x <= i + 1; ++x) add(x, y, z);
            }
          }
        }
        const float magnitude =
            weightSum > 0 ? (side[v] ? 1.0F : -1.0F) * scale * distance / weightSum : 1.0F;
        level[v] = (side[v] ? 1.0F : -1.0F) * std::clamp(magnitude, least, 1.0F);
      }
    }
  });
  return level;
}

}  // namespace

LevelSet levelSetOf(const Volume<std::uint8_t>& mask) {
  const VoxelSet side = setWhere(mask.grid, [&](std::size_t v) { return mask[v] != 0; });
  const harmonic::LabelBoundary boundary(side.data, mask.grid.size, 3, kTrust);
  return distanceTo(boundary, side);
}

double bandOf(const Grid& grid) {
  return kBand * grid.spacing.maxCoeff();
}

LevelSet distanceLevelOf(const LevelSet& level) {
  return distanceTo(ZeroBoundary(level),
                    setWhere(level.grid, [&](std::size_t v) { return level[v] > 0; }));
}

LevelSet levelSetOf(const Volume<float>& share) {
  LevelSet level(share.grid);
  parallelFor(level.size(), 1 << 16, [&](std::size_t v) {
    level[v] = offZero(std::clamp(2 * share[v] - 1, -1.0F, 1.0F));
  });
  return level;
}

LevelSample sample(const LevelSet& level, const Point& world) {
  const Grid& grid = level.grid;
  const Vector index = grid.toIndex(world);
  std::array<int, 3> base;
  Vector t;
  for (int a = 0; a < 3; ++a) {
    base[a] = std::clamp(static_cast<int>(std::floor(index[a])), 0, grid.size[a] - 2);
    t[a] = std::clamp(index[a] - base[a], 0.0, 1.0);
  }
  const float* p = &level(base[0], base[1], base[2]);
  const std::size_t row = grid.size[0], slice = row * grid.size[1];
  const double c000 = p[0], c100 = p[1], c010 = p[row], c110 = p[row + 1];
  const double c001 = p[slice], c101 = p[slice + 1], c011 = p[slice + row],
               c111 = p[slice + row + 1];
  const double x00 = c000 + t[0] * (c100 - c000), x10 = c010 + t[0] * (c110 - c010);
  const double x01 = c001 + t[0] * (c101 - c001), x11 = c011 + t[0] * (c111 - c011);
  const double y0 = x00 + t[1] * (x10 - x00), y1 = x01 + t[1] * (x11 - x01);
  LevelSample result;
  result.value = y0 + t[2] * (y1 - y0);
  const auto bilinear = [](double a, double b, double c, double d, double s, double r) {
    return (a * (1 - s) + b * s) * (1 - r) + (c * (1 - s) + d * s) * r;
  };
  const Vector perIndex(bilinear(c100 - c000, c110 - c010, c101 - c001, c111 - c011, t[1], t[2]),
                        (x10 - x00) * (1 - t[2]) + (x11 - x01) * t[2], y1 - y0);
  result.gradient = grid.axesToWorld(perIndex.cwiseQuotient(grid.spacing));
  return result;
}

}  // namespace explica::surface
