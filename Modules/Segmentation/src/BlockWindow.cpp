// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "BlockWindow.h"

#include "Explica/Core/GridLines.h"
#include "Explica/Core/Parallel.h"

#include <algorithm>
#include <cmath>

namespace explica::segmentation {
namespace {

constexpr std::size_t kWindowGrain = 16384;  // elements a task
constexpr std::size_t kLineGrain = 256;      // elements a task

/// Subscripts of voxels, one after the other; those in a row take no division.
class Walk {
 public:
  explicit Walk(const Grid& grid) : grid_(grid) {}
  const std::array<int, 3>& to(std::size_t voxel) {
    if (voxel - row_ >= static_cast<std::size_t>(grid_.size[0])) {
      at_ = grid_.subscripts(voxel);
      row_ = voxel - static_cast<std::size_t>(at_[0]);
    }
    at_[0] = static_cast<int>(voxel - row_);
    return at_;
  }

 private:
  const Grid& grid_;
  std::size_t row_ = 0;
  std::array<int, 3> at_{};
};

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
    for (int at = 0; at < length; ++at) {
      const double x = std::clamp((at + 0.5) / step_[a] - 0.5, 0.0, size_[a] - 1.0);
      const int low = static_cast<int>(x);
      places_[a].push_back({at / step_[a], low, std::min(low + 1, size_[a] - 1), x - low});
    }
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
  const GridLines lines(size_, axis);
  parallelForBlocks(lines.count, kLineGrain, [&](std::size_t begin, std::size_t end) {
    std::vector<double> line(lines.length);
    for (std::size_t l = begin; l < end; ++l) {
      double* const start = values.data() + lines.begin(l);
      for (int s = 0; s < lines.length; ++s) line[s] = start[s * lines.stride];
      for (int s = 0; s < lines.length; ++s) {
        double sum = 0;
        const int low = std::max(0, s - radius), high = std::min(lines.length - 1, s + radius);
        for (int t = low; t <= high; ++t) sum += kernel[t - s + radius] * line[t];
        start[s * lines.stride] = sum;
      }
    }
  });
}

std::vector<double> BlockWindow::sums(const std::vector<std::size_t>& voxel,
                                      const std::vector<float>& values) const {
  std::vector<double> sums(count(), 0.0);
  const auto firstOf = [&](std::size_t layer) {
    const std::size_t slice = first_[2] + layer * step_[2];
    const std::size_t begin = slice * grid_.size[0] * grid_.size[1];
    return static_cast<std::size_t>(std::ranges::lower_bound(voxel, begin) - voxel.begin());
  };
  parallelFor(size_[2], 1, [&](std::size_t layer) {  // of blocks, whose voxels lie together
    Walk walk(grid_);
    const std::size_t end = firstOf(layer + 1);
    for (std::size_t s = firstOf(layer); s < end; ++s) {
      const auto& at = walk.to(voxel[s]);
      sums[linear(placeOf(at, 0).block, placeOf(at, 1).block, static_cast<int>(layer))] +=
          values[s];
    }
  });
  for (int a = 0; a < 3; ++a) {
    if (size_[a] > 1) smoothAlong(sums, a);
  }
  return sums;
}

std::vector<float> BlockWindow::atVoxels(const std::vector<double>& values,
                                         const std::vector<std::size_t>& voxel) const {
  std::vector<float> result(voxel.size());
  parallelForBlocks(voxel.size(), kWindowGrain, [&](std::size_t begin, std::size_t end) {
    Walk walk(grid_);
    std::vector<double> row(size_[0]);  // of blocks, at the place of a row of voxels
    std::array<int, 2> placed = {-1, -1};
    for (std::size_t s = begin; s < end; ++s) {
      const auto& at = walk.to(voxel[s]);
      if (placed != std::array{at[1], at[2]}) {
        placed = {at[1], at[2]};
        blend(values, placeOf(at, 1), placeOf(at, 2), row);
      }
      const Place& x = placeOf(at, 0);
      result[s] = static_cast<float>((1 - x.share) * row[x.low] + x.share * row[x.high]);
    }
  });
  return result;
}

void BlockWindow::blend(const std::vector<double>& values, const Place& y, const Place& z,
                        std::vector<double>& row) const {
  const auto between = [&](int i, int k) {
    return (1 - y.share) * values[linear(i, y.low, k)] + y.share * values[linear(i, y.high, k)];
  };
  for (int i = 0; i < size_[0]; ++i) {
    row[i] = (1 - z.share) * between(i, z.low) + z.share * between(i, z.high);
  }
}

}  // namespace explica::segmentation
