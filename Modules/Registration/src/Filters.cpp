// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Filters.h"

#include "Explica/Core/GridLines.h"
#include "Explica/Core/Parallel.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace explica::registration {
namespace {

/// Replaces each line of the volume by what `filter` makes of it.
/// @param margin  values before and after the line that the filter is given: those at its ends
template <class Filter>
void filterLines(Volume<float>& volume, int axis, int margin, const Filter& filter) {
  const GridLines lines(volume.grid.size, axis);
  parallelForBlocks(lines.count, 512, [&](std::size_t first, std::size_t last) {
    std::vector<float> in(static_cast<std::size_t>(lines.length + 2 * margin));
    std::vector<float> out(static_cast<std::size_t>(lines.length));
    for (std::size_t l = first; l < last; ++l) {
      float* start = volume.data.data() + lines.begin(l);
      for (int s = 0; s < lines.length; ++s) in[margin + s] = start[s * lines.stride];
      std::fill_n(in.begin(), margin, start[0]);
      std::fill_n(in.end() - margin, margin, start[(lines.length - 1) * lines.stride]);
      filter(in, out);
      for (int s = 0; s < lines.length; ++s) start[s * lines.stride] = out[s];
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
    filterLines(volume, axis, radius, [&](const std::vector<float>& in, std::vector<float>& out) {
      std::fill(out.begin(), out.end(), 0.0F);
      for (std::size_t r = 0; r < kernel.size(); ++r) {
        for (std::size_t s = 0; s < out.size(); ++s) out[s] += kernel[r] * in[s + r];
      }
    });
  }
  return volume;
}

Volume<float> boxMean(Volume<float> volume, int radius) {
  for (int axis = 0; axis < 3; ++axis) {
    filterLines(volume, axis, 0, [radius](const std::vector<float>& in, std::vector<float>& out) {
      const int length = static_cast<int>(in.size());
      double sum = 0;
      for (int s = 0; s < std::min(radius, length); ++s) sum += in[s];
      for (int s = 0; s < length; ++s) {
        if (s + radius < length) sum += in[s + radius];
        if (s - radius - 1 >= 0) sum -= in[s - radius - 1];
        const int low = std::max(0, s - radius);
        const int high = std::min(length - 1, s + radius);
        out[s] = static_cast<float>(sum / (high - low + 1));
      }
    });
  }
  return volume;
}

float valueAt(const Volume<float>& volume, const Vector& index, float outside) {
  const Grid& grid = volume.grid;
  int low[3], high[3];
  float share[3];
  for (int a = 0; a < 3; ++a) {
    if (!(index[a] > -0.5 && index[a] < grid.size[a] - 0.5)) return outside;
    const double x = std::clamp(index[a], 0.0, grid.size[a] - 1.0);
    low[a] = static_cast<int>(x);
    high[a] = std::min(low[a] + 1, grid.size[a] - 1);
    share[a] = static_cast<float>(x - low[a]);
  }
  const auto along = [&](int j, int k) {
    return (1 - share[0]) * volume(low[0], j, k) + share[0] * volume(high[0], j, k);
  };
  const float near = (1 - share[1]) * along(low[1], low[2]) + share[1] * along(high[1], low[2]);
  const float far = (1 - share[1]) * along(low[1], high[2]) + share[1] * along(high[1], high[2]);
  return (1 - share[2]) * near + share[2] * far;
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
