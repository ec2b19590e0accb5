// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "BiasField.h"

#include "BlockWindow.h"
#include "Explica/Core/OrderStatistics.h"
#include "Explica/Core/Parallel.h"

#include <algorithm>
#include <cmath>

namespace explica::segmentation {
namespace {

constexpr std::size_t kBiasGrain = 16384;    // elements a task
constexpr float kDarkShare = 0.4f;           // of the median: fluid lies below
constexpr std::size_t kMostSamples = 50000;  // enough for a smooth field
constexpr std::size_t kFewestSamples = 100;  // fewer say nothing about a field
constexpr int kSharpenings = 150;            // at most, until kSettled
constexpr double kOverstep = 1.8;  // the window's gain is below 1, so that this converges, faster
constexpr double kSettled = 1e-4;  // of the field's logarithm in one iteration
constexpr double kLeastWeight = 1e-3;  // samples under a window: else the field stays as it is

double meanOf(const std::vector<float>& values) {
  return parallelSum(values.size(), kBiasGrain, 0.0,
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
std::vector<double> sharpenOnce(const BlockWindow& window, const std::vector<std::size_t>& voxel,
                                const std::vector<float>& logarithm) {
  const auto weight = window.sums(voxel, std::vector<float>(voxel.size(), 1.0f));
  std::vector<double> field(window.count(), 0.0);
  std::vector<float> residual(voxel.size());
  std::vector<float> corrected = logarithm;
  for (int iteration = 0; iteration < kSharpenings; ++iteration) {
    const Sharpening sharp(corrected);
    for (std::size_t s = 0; s < corrected.size(); ++s) {
      residual[s] = corrected[s] - sharp(corrected[s]);
    }
    const auto sums = window.sums(voxel, residual);
    double most = 0;
    for (std::size_t b = 0; b < field.size(); ++b) {
      if (!(weight[b] > kLeastWeight)) continue;
      const double step = kOverstep * sums[b] / weight[b];
      field[b] += step;
      most = std::max(most, std::abs(step));
    }
    const std::vector<float> found = window.atVoxels(field, voxel);
    for (std::size_t s = 0; s < corrected.size(); ++s) corrected[s] = logarithm[s] - found[s];
    if (most < kSettled) break;
  }
  return field;
}

}  // namespace

std::vector<float> fitBiasField(const Grid& grid, const BiasSamples& samples, double width) {
  const std::vector<std::size_t>& voxel = *samples.voxel;
  const BlockWindow window(grid, voxel, width);
  const auto numerator = window.sums(voxel, samples.numerator);
  const auto denominator = window.sums(voxel, samples.denominator);
  std::vector<double> logField(window.count(), 0.0);
  for (std::size_t b = 0; b < logField.size(); ++b) {
    if (numerator[b] > 0 && denominator[b] > 0)
      logField[b] = std::log(numerator[b] / denominator[b]);
  }
  return fieldOf(window.atVoxels(logField, voxel));
}

std::vector<float> sharpenHistogram(const Grid& grid, const std::vector<std::size_t>& voxel,
                                    const std::vector<float>& intensity, double width) {
  // Tissue only: the logarithm of dark fluid is all noise.
  const float dark = kDarkShare * upperMedian(intensity);
  std::vector<std::size_t> chosen;
  std::vector<float> logarithm;
  const std::size_t stride = std::max<std::size_t>(1, voxel.size() / kMostSamples);
  for (std::size_t s = 0; s < voxel.size(); s += stride) {
    if (!(intensity[s] > dark)) continue;
    chosen.push_back(voxel[s]);
    logarithm.push_back(std::log(intensity[s]));
  }
  if (chosen.size() < kFewestSamples) return std::vector<float>(voxel.size(), 1.0f);
  const BlockWindow window(grid, voxel, width);
  return fieldOf(window.atVoxels(sharpenOnce(window, chosen, logarithm), voxel));
}

}  // namespace explica::segmentation
