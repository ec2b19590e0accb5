// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Surface/LevelSet.h"

#include "Explica/Core/Parallel.h"

#include <algorithm>
#include <cmath>

namespace explica::surface {
namespace {

/// Normalised weights of a Gaussian at -radius .. radius.
std::vector<float> gaussianWeights(double deviation) {
  const int radius = static_cast<int>(std::ceil(3.5 * deviation));
  std::vector<float> weights(2 * radius + 1);
  double sum = 0;
  for (int i = -radius; i <= radius; ++i) sum += std::exp(-0.5 * i * i / (deviation * deviation));
  for (int i = -radius; i <= radius; ++i) {
    weights[i + radius] =
        static_cast<float>(std::exp(-0.5 * i * i / (deviation * deviation)) / sum);
  }
  return weights;
}

/// One pass of a separable filter along `axis`; borders repeat.
Volume<float> filterAlong(const Volume<float>& in, int axis, const std::vector<float>& weights) {
  Volume<float> out(in.grid);
  const auto& n = in.grid.size;
  const int radius = static_cast<int>(weights.size() / 2);
  parallelFor(n[2], 1, [&](std::size_t slice) {
    const int k = static_cast<int>(slice);
    for (int j = 0; j < n[1]; ++j) {
      float* row = &out(0, j, k);
      for (int s = -radius; s <= radius; ++s) {
        const float weight = weights[s + radius];
        if (axis == 0) {
          const float* from = &in(0, j, k);
          for (int i = 0; i < n[0]; ++i) row[i] += weight * from[std::clamp(i + s, 0, n[0] - 1)];
          continue;
        }
        const float* from = axis == 1 ? &in(0, std::clamp(j + s, 0, n[1] - 1), k)
                                      : &in(0, j, std::clamp(k + s, 0, n[2] - 1));
        for (int i = 0; i < n[0]; ++i) row[i] += weight * from[i];
      }
    }
  });
  return out;
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
  std::array<int, 3> low = n, high = {-1, -1, -1};
  for (int k = 0; k < n[2]; ++k) {
    for (int j = 0; j < n[1]; ++j) {
      for (int i = 0; i < n[0]; ++i) {
        if (!mask(i, j, k)) continue;
        const std::array<int, 3> at = {i, j, k};
        for (int a = 0; a < 3; ++a) {
          low[a] = std::min(low[a], at[a]);
          high[a] = std::max(high[a], at[a]);
        }
      }
    }
  }
  VoxelBox box;
  if (high[0] < 0) return box;
  for (int a = 0; a < 3; ++a) {
    box.low[a] = low[a] - margin;
    box.size[a] = high[a] - low[a] + 1 + 2 * margin;
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

LevelSet levelSetOf(const Volume<std::uint8_t>& mask, double blur) {
  LevelSet level(mask.grid);
  parallelFor(level.size(), 1 << 16, [&](std::size_t v) { level[v] = mask[v] ? 1.0F : -1.0F; });
  if (blur > 0) {
    const auto weights = gaussianWeights(blur);
    for (int axis = 0; axis < 3; ++axis) level = filterAlong(level, axis, weights);
  }
  parallelFor(level.size(), 1 << 16, [&](std::size_t v) {
    level[v] = mask[v] ? std::max(level[v], kLeastLevel) : std::min(level[v], -kLeastLevel);
  });
  return level;
}

LevelSet levelSetOf(const Volume<float>& share) {
  LevelSet level(share.grid);
  // A share of exactly one half counts as inside.
  constexpr float kOffZero = 1e-3F;
  parallelFor(level.size(), 1 << 16, [&](std::size_t v) {
    const float value = std::clamp(2 * share[v] - 1, -1.0F, 1.0F);
    level[v] = value >= 0 ? std::max(value, kOffZero) : std::min(value, -kOffZero);
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
