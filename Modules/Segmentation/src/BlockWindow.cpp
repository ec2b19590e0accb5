// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "BlockWindow.h"

#include "Explica/Core/Parallel.h"

#include <algorithm>
#include <cmath>

namespace explica::segmentation {
namespace {

constexpr std::size_t kWindowGrain = 16384;  // elements a task
constexpr std::size_t kLineGrain = 256;      // elements a task

}  // namespace

BlockWindow::BlockWindow(const Grid& grid, const std::vector<std::size_t>& voxel, double width,
                         double blocksPerWidth)
    : grid_(grid), width_(width), first_(grid.size) {
  std::array<int, 3> last{};
  for (const std::size_t v : voxel) {
    const auto at = grid.subscripts(v);
    for (int a = 0; a < 3; ++a) {
      first_[a] = std::min(first_[a], at[a]);
      last[a] = std::max(last[a], at[a]);
    }
  }
  for (int a = 0; a < 3; ++a) {
    const int length = std::max(1, last[a] - first_[a] + 1);
    step_[a] = std::clamp(static_cast<int>(std::lround(width / blocksPerWidth / grid.spacing[a])),
                          1, length);
    size_[a] = (length + step_[a] - 1) / step_[a];
  }
}

std::size_t BlockWindow::count() const {
  return static_cast<std::size_t>(size_[0]) * size_[1] * size_[2];
}

std::size_t BlockWindow::linear(int i, int j, int k) const {
  return i + static_cast<std::size_t>(size_[0]) * (j + static_cast<std::size_t>(size_[1]) * k);
}

void BlockWindow::smoothAlong(std::vector<double>& values, int axis) const {
  const double sigma = width_ / (grid_.spacing[axis] * step_[axis]);
  const int radius = static_cast<int>(std::ceil(3 * sigma));
  std::vector<double> kernel(static_cast<std::size_t>(2 * radius + 1));
  for (int r = -radius; r <= radius; ++r)
    kernel[r + radius] = std::exp(-0.5 * r * r / (sigma * sigma));
  std::size_t stride = 1;
  for (int a = 0; a < axis; ++a) stride *= static_cast<std::size_t>(size_[a]);
  const int length = size_[axis];
  parallelForBlocks(count() / static_cast<std::size_t>(length), kLineGrain,
                    [&](std::size_t begin, std::size_t end) {
                      std::vector<double> line(length);
                      for (std::size_t l = begin; l < end; ++l) {
                        const std::size_t start = (l / stride) * stride * length + l % stride;
                        for (int s = 0; s < length; ++s) line[s] = values[start + s * stride];
                        for (int s = 0; s < length; ++s) {
                          double sum = 0;
                          const int low = std::max(0, s - radius),
                                    high = std::min(length - 1, s + radius);
                          for (int t = low; t <= high; ++t) sum += kernel[t - s + radius] * line[t];
                          values[start + s * stride] = sum;
                        }
                      }
                    });
}

std::vector<double> BlockWindow::sums(const std::vector<std::size_t>& voxel,
                                      const std::vector<float>& values) const {
  std::vector<double> sums(count(), 0.0);
  for (std::size_t s = 0; s < voxel.size(); ++s) {
    const auto at = grid_.subscripts(voxel[s]);
    sums[linear((at[0] - first_[0]) / step_[0], (at[1] - first_[1]) / step_[1],
                (at[2] - first_[2]) / step_[2])] += values[s];
  }
  for (int a = 0; a < 3; ++a) {
    if (size_[a] > 1) smoothAlong(sums, a);
  }
  return sums;
}

std::vector<float> BlockWindow::atVoxels(const std::vector<double>& values,
                                         const std::vector<std::size_t>& voxel) const {
  std::vector<float> result(voxel.size());
  parallelFor(voxel.size(), kWindowGrain, [&](std::size_t s) {
    const auto at = grid_.subscripts(voxel[s]);
    std::array<int, 3> low;
    std::array<int, 3> high;
    std::array<double, 3> share;
    for (int a = 0; a < 3; ++a) {
      const double x = std::clamp((at[a] - first_[a] + 0.5) / step_[a] - 0.5, 0.0, size_[a] - 1.0);
      low[a] = static_cast<int>(x);
      high[a] = std::min(low[a] + 1, size_[a] - 1);
      share[a] = x - low[a];
    }
    double sum = 0;
    for (int c = 0; c < 8; ++c) {
      const int i = (c & 1) != 0 ? high[0] : low[0];
      const int j = (c & 2) != 0 ? high[1] : low[1];
      const int k = (c & 4) != 0 ? high[2] : low[2];
      sum += ((c & 1) != 0 ? share[0] : 1 - share[0]) * ((c & 2) != 0 ? share[1] : 1 - share[1]) *
             ((c & 4) != 0 ? share[2] : 1 - share[2]) * values[linear(i, j, k)];
    }
    result[s] = static_cast<float>(sum);
  });
  return result;
}

}  // namespace explica::segmentation
