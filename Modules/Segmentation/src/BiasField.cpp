// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "BiasField.h"

#include "Explica/Core/Parallel.h"

#include <algorithm>
#include <cmath>

namespace explica::segmentation {
namespace {

constexpr double kBlocksPerWidth = 4;
constexpr std::size_t kGrain = 16384;

/// Block lattice: block b along an axis holds voxels [b * step, (b + 1) * step).
struct Blocks {
  std::array<int, 3> step;
  std::array<int, 3> size;
  [[nodiscard]] std::size_t count() const {
    return static_cast<std::size_t>(size[0]) * size[1] * size[2];
  }
  [[nodiscard]] std::size_t linear(int i, int j, int k) const {
    return i + static_cast<std::size_t>(size[0]) * (j + static_cast<std::size_t>(size[1]) * k);
  }
};

void smoothAlong(std::vector<double>& values, const Blocks& blocks, int axis, double sigma) {
  const int radius = static_cast<int>(std::ceil(3 * sigma));
  std::vector<double> kernel(static_cast<std::size_t>(2 * radius + 1));
  for (int r = -radius; r <= radius; ++r)
    kernel[r + radius] = std::exp(-0.5 * r * r / (sigma * sigma));
  std::size_t stride = 1;
  for (int a = 0; a < axis; ++a) stride *= blocks.size[a];
  const int length = blocks.size[axis];
  std::vector<double> line(length);
  for (std::size_t start = 0; start < values.size(); ++start) {
    if ((start / stride) % length != 0) continue;
    for (int s = 0; s < length; ++s) line[s] = values[start + s * stride];
    for (int s = 0; s < length; ++s) {
      double sum = 0;
      const int low = std::max(0, s - radius);
      const int high = std::min(length - 1, s + radius);
      for (int t = low; t <= high; ++t) sum += kernel[t - s + radius] * line[t];
      values[start + s * stride] = sum;
    }
  }
}

}  // namespace

std::vector<float> fitBiasField(const Grid& grid, const BiasSamples& samples, double width) {
  Blocks blocks;
  for (int a = 0; a < 3; ++a) {
    blocks.step[a] = std::clamp(
        static_cast<int>(std::lround(width / kBlocksPerWidth / grid.spacing[a])), 1, grid.size[a]);
    blocks.size[a] = (grid.size[a] + blocks.step[a] - 1) / blocks.step[a];
  }
  std::vector<double> numerator(blocks.count(), 0.0);
  std::vector<double> denominator(blocks.count(), 0.0);
  const std::vector<std::size_t>& voxel = *samples.voxel;
  for (std::size_t s = 0; s < voxel.size(); ++s) {
    const auto at = grid.subscripts(voxel[s]);
    const std::size_t b =
        blocks.linear(at[0] / blocks.step[0], at[1] / blocks.step[1], at[2] / blocks.step[2]);
    numerator[b] += samples.numerator[s];
    denominator[b] += samples.denominator[s];
  }
  for (int a = 0; a < 3; ++a) {
    if (blocks.size[a] == 1) continue;
    const double sigma = width / (grid.spacing[a] * blocks.step[a]);
    smoothAlong(numerator, blocks, a, sigma);
    smoothAlong(denominator, blocks, a, sigma);
  }
  std::vector<double> logField(blocks.count(), 0.0);
  for (std::size_t b = 0; b < logField.size(); ++b) {
    if (numerator[b] > 0 && denominator[b] > 0)
      logField[b] = std::log(numerator[b] / denominator[b]);
  }

  std::vector<float> field(voxel.size());
  parallelForBlocks(voxel.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t s = begin; s < end; ++s) {
      const auto at = grid.subscripts(voxel[s]);
      std::array<int, 3> low;
      std::array<int, 3> high;
      std::array<double, 3> share;
      for (int a = 0; a < 3; ++a) {
        const double x =
            std::clamp((at[a] + 0.5) / blocks.step[a] - 0.5, 0.0, blocks.size[a] - 1.0);
        low[a] = static_cast<int>(x);
        high[a] = std::min(low[a] + 1, blocks.size[a] - 1);
        share[a] = x - low[a];
      }
      double sum = 0;
      for (int c = 0; c < 8; ++c) {
        const int i = (c & 1) != 0 ? high[0] : low[0];
        const int j = (c & 2) != 0 ? high[1] : low[1];
        const int k = (c & 4) != 0 ? high[2] : low[2];
        sum += ((c & 1) != 0 ? share[0] : 1 - share[0]) * ((c & 2) != 0 ? share[1] : 1 - share[1]) *
               ((c & 4) != 0 ? share[2] : 1 - share[2]) * logField[blocks.linear(i, j, k)];
      }
      field[s] = static_cast<float>(sum);
    }
  });
  const double mean = parallelSum(field.size(), kGrain, 0.0,
                                  [&](std::size_t begin, std::size_t end) {
                                    double sum = 0;
                                    for (std::size_t s = begin; s < end; ++s) sum += field[s];
                                    return sum;
                                  }) /
                      static_cast<double>(field.size());
  for (float& f : field) f = static_cast<float>(std::exp(f - mean));
  return field;
}

}  // namespace explica::segmentation
