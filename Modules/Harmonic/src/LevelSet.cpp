// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Core/Parallel.h"
#include "Explica/Harmonic/Annulus.h"

#include <algorithm>
#include <cmath>

namespace explica::harmonic {

namespace {

// Standard deviation of the blur over the spacing.  A step of one voxel in a slanted plane is gone
// (residual ripple below 2 % of a voxel) while sheets two voxels apart stay apart.
constexpr double kBlur = 0.8;
// Along coarse axes at most this many of the finest spacing, so that thick slices are not mixed.
constexpr double kBlurOfFinest = 1.6;
// Where the blur moved the boundary past a voxel's centre, it is put back by this much of the
// finest spacing: half of the greatest distance that a boundary can have from the centre it just
// passed.
constexpr double kHeldBack = 0.25;
constexpr float kSmallest = 1e-4F;  // probability beyond which a voxel is far from the boundary

/// Inverse of the normal distribution function; [Abramowitz & Stegun, Eq. 26.2.23] and two Newton
/// steps.
double normalQuantile(double p) {
  const double tail = std::min(p, 1 - p);
  const double t = std::sqrt(-2 * std::log(tail));
  double x = t - (2.515517 + t * (0.802853 + t * 0.010328)) /
                     (1 + t * (1.432788 + t * (0.189269 + t * 0.001308)));
  for (int k = 0; k < 2; ++k) {
    const double upper = 0.5 * std::erfc(x / std::sqrt(2.0));
    x += (upper - tail) * std::sqrt(2 * kPi) * std::exp(0.5 * x * x);
  }
  return p < 0.5 ? -x : x;
}

std::vector<float> gaussianWeights(double sigmaVoxels) {
  const int radius = std::max(1, static_cast<int>(std::ceil(3.5 * sigmaVoxels)));
  std::vector<float> weights(radius + 1);
  double sum = 0;
  for (int k = 0; k <= radius; ++k) {
    const double w = std::exp(-0.5 * k * k / (sigmaVoxels * sigmaVoxels));
    weights[k] = static_cast<float>(w);
    sum += k == 0 ? w : 2 * w;
  }
  for (float& w : weights) w = static_cast<float>(w / sum);
  return weights;
}

/// Convolves along one axis; voxels beyond the border count as 0.
void blurAxis(std::vector<float>& values, const std::array<int, 3>& size, int axis,
              const std::vector<float>& weights) {
  const int length = size[axis];
  if (length == 1) return;
  const std::size_t rowLength = size[0];
  const std::ptrdiff_t stride = axis == 1 ? size[0] : std::ptrdiff_t{size[0]} * size[1];
  const int radius = static_cast<int>(weights.size()) - 1;
  if (axis == 0) {
    parallelForBlocks(values.size() / rowLength, 256, [&](std::size_t begin, std::size_t end) {
      std::vector<float> padded(rowLength + 2 * radius, 0.0F);
      for (std::size_t row = begin; row < end; ++row) {
        float* line = values.data() + row * rowLength;
        std::copy(line, line + rowLength, padded.begin() + radius);
        for (std::size_t i = 0; i < rowLength; ++i) {
          const float* at = padded.data() + i + radius;
          float sum = weights[0] * at[0];
          for (int k = 1; k <= radius; ++k) sum += weights[k] * (at[-k] + at[k]);
          line[i] = sum;
        }
      }
    });
    return;
  }
  // A column of rows at a time: for axis 1 one slice, for axis 2 one j over all slices.
  const std::size_t columns = axis == 1 ? size[2] : size[1];
  parallelForBlocks(columns, 1, [&](std::size_t begin, std::size_t end) {
    std::vector<float> copy(rowLength * length);
    for (std::size_t column = begin; column < end; ++column) {
      float* base = values.data() + (axis == 1 ? column * rowLength * size[1] : column * rowLength);
      for (int p = 0; p < length; ++p) {
        std::copy(base + p * stride, base + p * stride + rowLength, copy.begin() + p * rowLength);
      }
      for (int p = 0; p < length; ++p) {
        float* out = base + p * stride;
        const float* centre = copy.data() + p * rowLength;
        for (std::size_t i = 0; i < rowLength; ++i) out[i] = weights[0] * centre[i];
        for (int k = 1; k <= radius; ++k) {
          const float w = weights[k];
          if (p - k >= 0) {
            const float* row = copy.data() + (p - k) * rowLength;
            for (std::size_t i = 0; i < rowLength; ++i) out[i] += w * row[i];
          }
          if (p + k < length) {
            const float* row = copy.data() + (p + k) * rowLength;
            for (std::size_t i = 0; i < rowLength; ++i) out[i] += w * row[i];
          }
        }
      }
    }
  });
}

}  // namespace

Volume<float> antialiasedLevel(const Volume<std::uint8_t>& side, bool perSlice) {
  const Grid& grid = side.grid;
  const int axes = perSlice ? 2 : grid.dimension();
  const double finest =
      axes == 2 ? std::min(grid.spacing[0], grid.spacing[1]) : grid.spacing.minCoeff();
  std::array<double, 3> sigma{};  // mm
  for (int a = 0; a < 3; ++a) {
    sigma[a] = std::min(kBlur * grid.spacing[a], kBlurOfFinest * finest);
  }
  std::vector<float> inside(side.size()), known(side.size());
  parallelFor(side.size(), 1 << 16, [&](std::size_t v) {
    inside[v] = side[v] == 1 ? 1.0F : 0.0F;
    known[v] = side[v] == 255 ? 0.0F : 1.0F;
  });
  for (int a = 0; a < axes; ++a) {
    const auto weights = gaussianWeights(sigma[a] / grid.spacing[a]);
    blurAxis(inside, grid.size, a, weights);
    blurAxis(known, grid.size, a, weights);
  }
  parallelFor(side.size(), 1 << 16, [&](std::size_t v) {
    const float p = known[v] > 0 ? inside[v] / known[v] : 0.5F;
    inside[v] = std::clamp(p, kSmallest, 1 - kSmallest);
  });

  Volume<float> level(grid);
  const bool isotropic = sigma[0] == sigma[1] && (axes == 2 || sigma[1] == sigma[2]);
  const float farAway = static_cast<float>(normalQuantile(1 - kSmallest));
  parallelForBlocks(side.size(), 1 << 14, [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v) {
      const float p = inside[v];
      double width = sigma[0];
      double quantile = 0;
      if (p <= kSmallest) {
        quantile = -farAway;
      } else if (p >= 1 - kSmallest) {
        quantile = farAway;
      } else {
        quantile = normalQuantile(p);
        if (!isotropic) {
          // A plane with normal n is blurred by sqrt(sum n_a^2 sigma_a^2).
          const auto s = grid.subscripts(v);
          double normSquared = 0, spread = 0;
          for (int a = 0; a < axes; ++a) {
            auto lower = s, upper = s;
            lower[a] = std::max(0, s[a] - 1);
            upper[a] = std::min(grid.size[a] - 1, s[a] + 1);
            if (lower[a] == upper[a]) continue;
            const double slope = (inside[grid.linear(upper[0], upper[1], upper[2])] -
                                  inside[grid.linear(lower[0], lower[1], lower[2])]) /
                                 ((upper[a] - lower[a]) * grid.spacing[a]);
            normSquared += slope * slope;
            spread += slope * slope * sigma[a] * sigma[a];
          }
          if (normSquared > 0) width = std::sqrt(spread / normSquared);
        }
      }
      double distance = -quantile * width;
      if (side[v] == 1 && distance >= 0) distance = -kHeldBack * finest;
      if (side[v] == 0 && distance <= 0) distance = kHeldBack * finest;
      level[v] = static_cast<float>(distance);
    }
  });
  return level;
}

}  // namespace explica::harmonic
