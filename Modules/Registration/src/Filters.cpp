// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Filters.h"

#include "Explica/Core/GridLines.h"
#include "Explica/Core/Parallel.h"

#include <Eigen/Core>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace explica::registration {
namespace {

constexpr int kLanes = 16;  // lines that are filtered at once
using Lanes = Eigen::Array<float, kLanes, 1>;
/// Lines beside each other, a row each.
using Bundle = Eigen::Array<float, kLanes, Eigen::Dynamic>;

/// Replaces each line of the volume by what `filter` makes of it.
/// @param margin  values before and after the line that the filter is given: those at its ends
/// @param filter  (in, out): what is in `out` on entry does not matter
template <class Filter>
void filterLines(Volume<float>& volume, int axis, int margin, const Filter& filter) {
  const GridLines lines(volume.grid.size, axis);
  parallelForBlocks((lines.count + kLanes - 1) / kLanes, 32, [&](std::size_t from, std::size_t to) {
    Bundle in(kLanes, lines.length + 2 * margin), out(kLanes, lines.length);
    for (std::size_t bundle = from; bundle < to; ++bundle) {
      std::array<float*, kLanes> start;  // spare lanes of the last bundle repeat its last line
      for (int l = 0; l < kLanes; ++l) {
        const std::size_t line = std::min(bundle * kLanes + l, lines.count - 1);
        start[l] = volume.data.data() + lines.begin(line);
      }
      for (int s = -margin; s < lines.length + margin; ++s) {
        const std::size_t at = std::clamp(s, 0, lines.length - 1) * lines.stride;
        for (int l = 0; l < kLanes; ++l) in(l, s + margin) = start[l][at];
      }
      filter(in, out);
      for (int s = 0; s < lines.length; ++s) {
        for (int l = 0; l < kLanes; ++l) start[l][s * lines.stride] = out(l, s);
      }
    }
  });
}

std::vector<float> gaussian(double sigma) {
  const int radius = std::max(1, static_cast<int>(std::ceil(3 * sigma)));
  std::vector<float> kernel(static_cast<std::size_t>(2 * radius + 1));
  double sum = 0;
  for (int r = -radius; r <= radius; ++r) sum += std::exp(-0.5 * r * r / (sigma * sigma));
  for (int r = -radius; r <= radius; ++r) {
    kernel[r + radius] = static_cast<float>(std::exp(-0.5 * r * r / (sigma * sigma)) / sum);
  }
  return kernel;
}

}  // namespace

Volume<float> smoothed(Volume<float> volume, double sigma) {
  for (int axis = 0; axis < 3; ++axis) {
    const double inVoxels = sigma / volume.grid.spacing[axis];
    if (inVoxels < 0.2 || volume.grid.size[axis] == 1) continue;
    const std::vector<float> kernel = gaussian(inVoxels);
    const int radius = static_cast<int>(kernel.size() / 2);
    filterLines(volume, axis, radius, [&](const Bundle& in, Bundle& out) {
      for (Eigen::Index s = 0; s < out.cols(); ++s) {
        Lanes sum = Lanes::Zero();
        for (std::size_t r = 0; r < kernel.size(); ++r) sum += kernel[r] * in.col(s + r);
        out.col(s) = sum;
      }
    });
  }
  return volume;
}

Volume<float> boxMean(Volume<float> volume, int radius) {
  for (int axis = 0; axis < 3; ++axis) {
    filterLines(volume, axis, 0, [radius](const Bundle& in, Bundle& out) {
      const int length = static_cast<int>(in.cols());
      Eigen::Array<double, kLanes, 1> sum =
          in.leftCols(std::min(radius, length)).cast<double>().rowwise().sum();
      for (int s = 0; s < length; ++s) {
        if (s + radius < length) sum += in.col(s + radius).cast<double>();
        if (s - radius - 1 >= 0) sum -= in.col(s - radius - 1).cast<double>();
        const int count = std::min(length - 1, s + radius) - std::max(0, s - radius) + 1;
        out.col(s) = (sum / count).cast<float>();
      }
    });
  }
  return volume;
}

Cell::Cell(const Grid& grid, const Vector& index) {
  std::size_t stride = 1;
  for (int a = 0; a < 3; ++a) {
    const double x = std::clamp(index[a], 0.0, grid.size[a] - 1.0);
    const int low = static_cast<int>(x);
    first_ += stride * low;
    step_[a] = low + 1 < grid.size[a] ? stride : 0;
    share_[a] = static_cast<float>(x - low);
    stride *= grid.size[a];
  }
}

float Cell::of(const Volume<float>& volume) const {
  const float* const value = volume.data.data() + first_;
  const auto along = [&](std::size_t row) {
    return (1 - share_[0]) * value[row] + share_[0] * value[row + step_[0]];
  };
  const float near = (1 - share_[1]) * along(0) + share_[1] * along(step_[1]);
  const float far = (1 - share_[1]) * along(step_[2]) + share_[1] * along(step_[1] + step_[2]);
  return (1 - share_[2]) * near + share_[2] * far;
}

float valueAt(const Volume<float>& volume, const Vector& index, float outside) {
  for (int a = 0; a < 3; ++a) {
    if (!(index[a] > -0.5 && index[a] < volume.grid.size[a] - 0.5)) return outside;
  }
  return Cell(volume.grid, index).of(volume);
}

Grid cubicGrid(const Grid& like, const Vector& low, const Vector& high, double spacing) {
  Grid grid;
  grid.spacing = Vector::Constant(spacing);
  grid.direction = like.direction;
  grid.origin = like.toWorld(low);
  for (int a = 0; a < 3; ++a) {
    const double extent = (high[a] - low[a]) * like.spacing[a];
    grid.size[a] = std::max(1, static_cast<int>(std::ceil(extent / spacing)) + 1);
  }
  return grid;
}

Volume<float> resampled(const Volume<float>& volume, const Grid& grid) {
  const double wanted = grid.spacing.maxCoeff();
  const double present = volume.grid.spacing.minCoeff();
  // The blur that makes a voxel of the finer grid as wide as one of the coarser.
  const double sigma = 0.5 * std::sqrt(std::max(0.0, wanted * wanted - present * present));
  const Volume<float> source = smoothed(volume, sigma);
  return volumeBy(grid, [&](const Vector& index) {
    return valueAt(source, source.grid.toIndex(grid.toWorld(index)));
  });
}

Volume<float> inCubes(const Volume<float>& volume, double spacing) {
  const auto& n = volume.grid.size;
  const Vector last(n[0] - 1, n[1] - 1, n[2] - 1);
  return resampled(volume, cubicGrid(volume.grid, Vector::Zero(), last, spacing));
}

Volume<float> headOf(const Volume<float>& image) {
  double sum = 0;
  for (const float value : image.data) sum += value;
  const double mean = sum / static_cast<double>(image.size());
  Volume<float> head(image.grid);
  for (std::size_t v = 0; v < head.size(); ++v) head[v] = image[v] > mean ? 1.0F : 0.0F;
  return head;
}

Point centreOf(const Volume<float>& head) {
  Point sum = Point::Zero();
  double count = 0;
  for (std::size_t v = 0; v < head.size(); ++v) {
    if (head[v] <= 0) continue;
    const auto [i, j, k] = head.grid.subscripts(v);
    sum += Point(i, j, k);
    ++count;
  }
  return head.grid.toWorld(sum / std::max(count, 1.0));
}

}  // namespace explica::registration
