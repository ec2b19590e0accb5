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
constexpr float kDarkShare = 0.4f;           // of the median: fluid lies below
constexpr std::size_t kMostSamples = 50000;  // enough for a smooth field
constexpr std::size_t kFewestSamples = 100;
constexpr int kSharpenings = 150;
constexpr double kOverstep = 1.8;  // the window's gain is below 1, so that this converges, faster
constexpr double kSettled = 1e-4;  // of the field's logarithm in one iteration
constexpr double kLeastWeight = 1e-3;  // samples under a window: else the field stays as it is

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

Blocks blocksOf(const Grid& grid, double width) {
  Blocks blocks;
  for (int a = 0; a < 3; ++a) {
    blocks.step[a] = std::clamp(
        static_cast<int>(std::lround(width / kBlocksPerWidth / grid.spacing[a])), 1, grid.size[a]);
    blocks.size[a] = (grid.size[a] + blocks.step[a] - 1) / blocks.step[a];
  }
  return blocks;
}

/// Sums of the samples in each block, under a Gaussian window.
std::vector<double> windowed(const Grid& grid, const Blocks& blocks,
                             const std::vector<std::size_t>& voxel,
                             const std::vector<float>& values, double width) {
  std::vector<double> sums(blocks.count(), 0.0);
  for (std::size_t s = 0; s < voxel.size(); ++s) {
    const auto at = grid.subscripts(voxel[s]);
    sums[blocks.linear(at[0] / blocks.step[0], at[1] / blocks.step[1], at[2] / blocks.step[2])] +=
        values[s];
  }
  for (int a = 0; a < 3; ++a) {
    if (blocks.size[a] == 1) continue;
    smoothAlong(sums, blocks, a, width / (grid.spacing[a] * blocks.step[a]));
  }
  return sums;
}

/// The block values at voxels, trilinear between the blocks' centres.
std::vector<float> atVoxels(const Grid& grid, const Blocks& blocks,
                            const std::vector<double>& values,
                            const std::vector<std::size_t>& voxel) {
  std::vector<float> result(voxel.size());
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
               ((c & 4) != 0 ? share[2] : 1 - share[2]) * values[blocks.linear(i, j, k)];
      }
      result[s] = static_cast<float>(sum);
    }
  });
  return result;
}

double meanOf(const std::vector<float>& values) {
  return parallelSum(values.size(), kGrain, 0.0,
                     [&](std::size_t begin, std::size_t end) {
                       double sum = 0;
                       for (std::size_t s = begin; s < end; ++s) sum += values[s];
                       return sum;
                     }) /
         static_cast<double>(values.size());
}

/// Field of a logarithm, its geometric mean 1.
std::vector<float> fieldOf(std::vector<float> logarithm) {
  const double mean = meanOf(logarithm);
  for (float& f : logarithm) f = static_cast<float>(std::exp(f - mean));
  return logarithm;
}

/// What a value would be without the blur that the field puts on the histogram: the expectation of
/// the sharp logarithm given the blurred one, as a table over the range of values [Sled1998].
class Sharpening {
 public:
  explicit Sharpening(const std::vector<float>& values) {
    const auto [least, most] = std::minmax_element(values.begin(), values.end());
    low_ = *least;
    width_ = std::max(1e-6, (*most - low_) / (kBins - 1.0));
    std::vector<double> count(kPadded, 0.0);
    for (const float value : values) {
      const double x = (value - low_) / width_;
      const int cell = std::min(static_cast<int>(x), kBins - 2);
      count[kPadding + cell] += 1 - (x - cell);
      count[kPadding + cell + 1] += x - cell;
    }
    const std::vector<double> blur = gaussian();
    const std::vector<double> sharp = deconvolved(count, blur);
    for (int v = 0; v < kBins; ++v) {
      double total = 0;
      double first = 0;
      for (int u = 0; u < kPadded; ++u) {
        const double weight = sharp[u] * blur[std::abs(v + kPadding - u)];
        total += weight;
        first += weight * (u - kPadding);
      }
      expected_[v] = low_ + width_ * (total > 0 ? first / total : v);
    }
  }

  [[nodiscard]] float operator()(float value) const {
    const double x = std::clamp((value - low_) / width_, 0.0, kBins - 1.0);
    const int cell = std::min(static_cast<int>(x), kBins - 2);
    return static_cast<float>((1 - (x - cell)) * expected_[cell] +
                              (x - cell) * expected_[cell + 1]);
  }

 private:
  static constexpr int kBins = 200;
  static constexpr int kPadding = 28;  // so that the blur does not wrap around
  static constexpr int kPadded = kBins + 2 * kPadding;
  static constexpr double kFullWidth = 0.15;  // of the field's blur at half height, in logarithms
  static constexpr double kNoise = 0.01;      // of Wiener's filter

  /// The blur's density at so many bins' distance.
  [[nodiscard]] std::vector<double> gaussian() const {
    const double sigma = kFullWidth / 2.3548 / width_;
    std::vector<double> density(kPadded);
    double sum = 0;
    for (int d = 0; d < kPadded; ++d) {
      density[d] = std::exp(-0.5 * d * d / (sigma * sigma));
      sum += d == 0 ? density[d] : 2 * density[d];
    }
    for (double& value : density) value /= sum;
    return density;
  }

  /// Wiener's filter: a product of Fourier coefficients, here as sums, for 256 bins are few.
  static std::vector<double> deconvolved(const std::vector<double>& count,
                                         const std::vector<double>& blur) {
    static const std::array<double, kPadded> cosine = [] {
      std::array<double, kPadded> table{};
      for (int b = 0; b < kPadded; ++b) table[b] = std::cos(2 * kPi * b / kPadded);
      return table;
    }();
    const auto cosAt = [&](int turn) { return cosine[turn % kPadded]; };
    const auto sinAt = [&](int turn) { return cosine[(turn + 3 * kPadded / 4) % kPadded]; };
    std::vector<double> sharp(kPadded, 0.0);
    for (int f = 0; f <= kPadded / 2; ++f) {
      double real = 0;
      double imaginary = 0;
      double response = blur[0];
      for (int b = 0; b < kPadded; ++b) {
        real += count[b] * cosAt(f * b);
        imaginary -= count[b] * sinAt(f * b);
        if (b > 0 && b < kPadded / 2) response += 2 * blur[b] * cosAt(f * b);
      }
      const double gain = response / (response * response + kNoise) / kPadded *
                          (f == 0 || f == kPadded / 2 ? 1 : 2);
      for (int b = 0; b < kPadded; ++b) {
        sharp[b] += gain * (real * cosAt(f * b) - imaginary * sinAt(f * b));
      }
    }
    for (double& value : sharp) value = std::max(0.0, value);
    return sharp;
  }

  double low_ = 0;
  double width_ = 1;
  std::array<double, kBins> expected_{};
};

/// The field on blocks that makes the histogram of these logarithms sharpest.
std::vector<double> sharpenOnce(const Grid& grid, const Blocks& blocks,
                                const std::vector<std::size_t>& voxel,
                                const std::vector<float>& logarithm, double width) {
  const auto weight = windowed(grid, blocks, voxel, std::vector<float>(voxel.size(), 1.0f), width);
  std::vector<double> field(blocks.count(), 0.0);
  std::vector<float> residual(voxel.size());
  std::vector<float> corrected = logarithm;
  for (int iteration = 0; iteration < kSharpenings; ++iteration) {
    const Sharpening sharp(corrected);
    for (std::size_t s = 0; s < corrected.size(); ++s) {
      residual[s] = corrected[s] - sharp(corrected[s]);
    }
    const auto sums = windowed(grid, blocks, voxel, residual, width);
    double most = 0;
    for (std::size_t b = 0; b < field.size(); ++b) {
      if (!(weight[b] > kLeastWeight)) continue;
      const double step = kOverstep * sums[b] / weight[b];
      field[b] += step;
      most = std::max(most, std::abs(step));
    }
    const std::vector<float> found = atVoxels(grid, blocks, field, voxel);
    for (std::size_t s = 0; s < corrected.size(); ++s) corrected[s] = logarithm[s] - found[s];
    if (most < kSettled) break;
  }
  return field;
}

}  // namespace

std::vector<float> fitBiasField(const Grid& grid, const BiasSamples& samples, double width) {
  const Blocks blocks = blocksOf(grid, width);
  const std::vector<std::size_t>& voxel = *samples.voxel;
  const auto numerator = windowed(grid, blocks, voxel, samples.numerator, width);
  const auto denominator = windowed(grid, blocks, voxel, samples.denominator, width);
  std::vector<double> logField(blocks.count(), 0.0);
  for (std::size_t b = 0; b < logField.size(); ++b) {
    if (numerator[b] > 0 && denominator[b] > 0)
      logField[b] = std::log(numerator[b] / denominator[b]);
  }
  return fieldOf(atVoxels(grid, blocks, logField, voxel));
}

std::vector<float> sharpenHistogram(const Grid& grid, const std::vector<std::size_t>& voxel,
                                    const std::vector<float>& intensity, double width) {
  // Tissue only: the logarithm of dark fluid is all noise.
  std::vector<float> sorted = intensity;
  const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
  std::nth_element(sorted.begin(), middle, sorted.end());
  const float dark = kDarkShare * *middle;
  std::vector<std::size_t> chosen;
  std::vector<float> logarithm;
  const std::size_t stride = std::max<std::size_t>(1, voxel.size() / kMostSamples);
  for (std::size_t s = 0; s < voxel.size(); s += stride) {
    if (!(intensity[s] > dark)) continue;
    chosen.push_back(voxel[s]);
    logarithm.push_back(std::log(intensity[s]));
  }
  if (chosen.size() < kFewestSamples) return std::vector<float>(voxel.size(), 1.0f);
  const Blocks blocks = blocksOf(grid, width);
  return fieldOf(
      atVoxels(grid, blocks, sharpenOnce(grid, blocks, chosen, logarithm, width), voxel));
}

}  // namespace explica::segmentation
