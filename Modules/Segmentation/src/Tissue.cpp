// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Segmentation/Tissue.h"

#include "BiasField.h"
#include "BorderLevels.h"
#include "Explica/Core/OrderStatistics.h"
#include "Explica/Core/Parallel.h"
#include "Explica/Core/VoxelSets.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

namespace explica::segmentation {
namespace {

constexpr int kClasses = 3;            // fluid, grey, white
constexpr std::size_t kGrain = 16384;  // elements a task
// Spread of a pure tissue, of the range of means: a narrower one is a single grey value, a wider
// one has begun to stand for mixtures.
constexpr double kLeastDeviation = 0.02;
constexpr double kMostDeviation = 0.08;
constexpr double kFirstDeviation = 0.06;   // of the range of means: the noise to start from
constexpr double kFirstMixedShare = 0.15;  // of the voxels, for each of the two mixtures
constexpr double kRimShare = 0.08;         // of the brain's radius: 5 to 6 mm in an adult
constexpr std::size_t kFewestInCore = 100;
constexpr double kFarVoxels =
    1.9;  // from anything brighter than half way to grey matter: deep fluid
constexpr std::size_t kFewestDeep = 20;  // voxels of deep fluid whose median is believed
constexpr double kDeepFluid = 0.002;  // of the voxels off the rim: fewer do not tell what fluid is
constexpr double kFluidOverGrey = 0.7;  // what is brighter beside grey matter is no fluid
constexpr int kEdgeRounds = 10;         // after which levels move no more
constexpr float kLikelyWhite = 0.5F;    // likelier than all else together
constexpr int kPriorRounds = 4;         // for the neighbours to agree
// Of the prior's weight, while classes are estimated: shares that have been smoothed hide the
// spread of what they came from.
constexpr double kWhileEstimated = 0.125;
constexpr double kLocalBlocks = 2;   // of the local windows' width
constexpr double kDark = 1.0 / 3;    // of the darkest class, in which fluid and grey matter mix
constexpr int kFirstIterations = 3;  // until the classes are where they belong
constexpr double kBeyondNoise = 4;   // deviations
constexpr std::int32_t kNone = -1, kRemains = -2;  // neighbours that are not in the brain

/// Fluid, grey, white, and the voxels where two of them meet.
enum Component { kPureCsf, kPureGrey, kPureWhite, kCsfGrey, kGreyWhite, kComponents };
// Shares of fluid, grey and white in each; half and half where two meet.
constexpr std::array<std::array<float, kClasses>, kComponents> kComposition = {
    {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0.5f, 0.5f, 0}, {0, 0.5f, 0.5f}}};

using Shares = std::array<float, kClasses>;        // of the tissues in a voxel
using Posterior = std::array<float, kComponents>;  // of the components

/// The mixture's parameters.
struct Mixture {
  std::array<double, kClasses> mean{};
  std::array<double, kClasses> deviation{};
  std::array<double, kComponents> share{};
};

/// The brain's voxels, packed, with the packed indices of their six neighbours (kNone outside).
struct Brain {
  std::vector<std::size_t> voxel;
  std::vector<std::array<std::int32_t, 6>> neighbours;
  std::vector<float> intensity;
  std::vector<std::uint8_t> rim;  ///< 1 near what is not brain
  [[nodiscard]] std::size_t size() const { return voxel.size(); }
};

Brain packBrain(const Volume<float>& image, const Volume<Label>& mask) {
  const Grid& grid = image.grid;
  std::vector<std::int32_t> packed(grid.voxelCount(), -1);
  Brain brain;
  for (std::size_t v = 0; v < image.size(); ++v) {
    if (!std::isfinite(image[v])) {
      const auto [i, j, k] = grid.subscripts(v);
      throw InvalidInput("T1: voxel (" + std::to_string(i) + ", " + std::to_string(j) + ", " +
                         std::to_string(k) + ") is not a finite number; replace such voxels by 0");
    }
    const bool inside = mask.size() == 0 ? image[v] > 0 : mask[v] != 0;
    if (!inside) continue;
    packed[v] = static_cast<std::int32_t>(brain.voxel.size());
    brain.voxel.push_back(v);
  }
  brain.neighbours.resize(brain.size());
  brain.intensity.resize(brain.size());
  for (std::size_t b = 0; b < brain.size(); ++b) {
    brain.intensity[b] = image[brain.voxel[b]];
    const auto neighbours = grid.neighbours(brain.voxel[b]);
    for (std::size_t n = 0; n < neighbours.size(); ++n) {
      brain.neighbours[b][n] = neighbours[n] < 0 ? kNone : packed[neighbours[n]];
    }
  }
  return brain;
}

/// Marks the voxels near the brain's border, where masks leave dark remains that are darker than
/// fluid, by their distance as a share of the radius of a ball of the brain's volume.
void markRim(const Grid& grid, Brain& brain) {
  VoxelSet outside(grid, 1);
  for (const std::size_t v : brain.voxel) outside[v] = 0;
  const Volume<float> squared = squaredDistanceTo(outside);
  const double volume = static_cast<double>(brain.size()) * grid.voxelVolume();
  const double most = kRimShare * std::cbrt(0.75 / kPi * volume);
  brain.rim.resize(brain.size());
  for (std::size_t b = 0; b < brain.size(); ++b) {
    brain.rim[b] = squared[brain.voxel[b]] <= most * most ? 1 : 0;
  }
}

/// The two thresholds that leave the least variance within three classes [Otsu1979],
/// by trying all pairs on a histogram of the middle 99 % of the intensities.
Mixture guessFrom(std::vector<float> sorted) {
  constexpr int kBins = 256;
  std::sort(sorted.begin(), sorted.end());
  const std::size_t first = sorted.size() / 200;
  const std::size_t last = sorted.size() - first;
  const double low = sorted[first];
  const double high = sorted[last - 1];
  std::array<double, kBins + 1> count{};
  std::array<double, kBins + 1> sum{};
  for (std::size_t s = first; s < last; ++s) {
    const int bin =
        high > low ? std::min(static_cast<int>((sorted[s] - low) / (high - low) * kBins), kBins - 1)
                   : 0;
    count[bin + 1] += 1;
    sum[bin + 1] += sorted[s];
  }
  for (int bin = 0; bin < kBins; ++bin) {
    count[bin + 1] += count[bin];
    sum[bin + 1] += sum[bin];
  }
  double most = -1;
  std::array<int, kClasses + 1> border = {0, 0, 0, kBins};
  for (int a = 1; a < kBins; ++a) {
    for (int b = a + 1; b < kBins; ++b) {
      const std::array<int, kClasses + 1> tried = {0, a, b, kBins};
      double between = 0;
      for (int k = 0; k < kClasses; ++k) {
        const double n = count[tried[k + 1]] - count[tried[k]];
        const double m = sum[tried[k + 1]] - sum[tried[k]];
        between = n > 0 && between >= 0 ? between + m * m / n : -1;
      }
      if (between > most) {
        most = between;
        border = tried;
      }
    }
  }
  if (most < 0) {
    throw InvalidInput("T1: fewer than three distinct intensities in the brain (from " +
                       std::to_string(sorted.front()) + " to " + std::to_string(sorted.back()) +
                       "); give the skull-stripped image, not a mask");
  }
  std::array<double, kClasses> mean;
  for (int k = 0; k < kClasses; ++k) {
    mean[k] = (sum[border[k + 1]] - sum[border[k]]) / (count[border[k + 1]] - count[border[k]]);
  }
  Mixture mixture;
  mixture.mean = mean;
  mixture.deviation.fill(kFirstDeviation * (mean[2] - mean[0]));
  for (int k = 0; k < kClasses; ++k) {
    mixture.share[k] =
        (1 - 2 * kFirstMixedShare) * (count[border[k + 1]] - count[border[k]]) / count[kBins];
  }
  mixture.share[kCsfGrey] = kFirstMixedShare;
  mixture.share[kGreyWhite] = kFirstMixedShare;
  return mixture;
}

/// First guess, without the rim where the rest shows fluid; else the rim counts like the rest.
Mixture firstGuess(Brain& brain) {
  std::vector<float> core;
  for (std::size_t b = 0; b < brain.size(); ++b) {
    if (brain.rim[b] == 0) core.push_back(brain.intensity[b]);
  }
  const auto [least, most] = std::minmax_element(core.begin(), core.end());
  if (core.size() >= kFewestInCore && *least < *most) {
    const Mixture guess = guessFrom(std::move(core));
    if (guess.mean[0] < kFluidOverGrey * guess.mean[1] && guess.share[kPureCsf] > kDeepFluid) {
      return guess;
    }
  }
  std::fill(brain.rim.begin(), brain.rim.end(), std::uint8_t{0});
  return guessFrom(brain.intensity);
}

/// Dark remains at the rim of an image without skull: darker than a third of its fluid, and
/// connected by such voxels to what is not above 0.  Resampling blends the brain with the zeros
/// around it, and stripping leaves bone.  How dark fluid is, is the darkest of three classes away
/// from the rim.
/// @return for each of the brain's voxels, whether it is one
std::vector<std::uint8_t> darkRemains(const Grid& grid, Brain& brain) {
  std::vector<std::uint8_t> dark(brain.size(), 0);
  if (brain.size() < kFewestInCore) return dark;
  markRim(grid, brain);
  const double darkest = kDark * firstGuess(brain).mean[0];
  std::vector<std::int32_t> front;
  const auto reach = [&](std::int32_t b) {
    if (b < 0 || dark[b] != 0 || !(brain.intensity[b] < darkest)) return;
    dark[b] = 1;
    front.push_back(b);
  };
  for (std::size_t b = 0; b < brain.size(); ++b) {
    const auto& near = brain.neighbours[b];
    if (std::find(near.begin(), near.end(), kNone) != near.end()) reach(static_cast<int>(b));
  }
  while (!front.empty()) {
    const std::int32_t b = front.back();
    front.pop_back();
    for (const std::int32_t next : brain.neighbours[b]) reach(next);
  }
  return dark;
}

/// Leaves the values of what is kept.
template <class Value>
void keep(const std::vector<std::uint8_t>& remains, std::vector<Value>& values) {
  std::size_t kept = 0;
  for (std::size_t b = 0; b < remains.size(); ++b) {
    if (remains[b] == 0) values[kept++] = values[b];
  }
  values.resize(kept);
}

/// Takes remains out of the brain; to their neighbours they are fluid.
/// @param taken  their voxels are added to it
void takeOut(const std::vector<std::uint8_t>& remains, Brain& brain,
             std::vector<std::size_t>& taken) {
  std::vector<std::int32_t> now(brain.size(), kRemains);
  std::int32_t kept = 0;
  for (std::size_t b = 0; b < brain.size(); ++b) {
    if (remains[b] != 0) {
      taken.push_back(brain.voxel[b]);
    } else {
      now[b] = kept++;
    }
  }
  keep(remains, brain.voxel);
  keep(remains, brain.neighbours);
  keep(remains, brain.intensity);
  keep(remains, brain.rim);
  for (auto& neighbours : brain.neighbours) {
    for (std::int32_t& other : neighbours) other = other < 0 ? other : now[other];
  }
}

/// Logarithm of each component's weighted density between the outer means, tabulated.
/// A mixed voxel's intensity is uniform between two means, blurred by the noise [Santago1993]:
/// (Phi((y - a) / s) - Phi((y - b) / s)) / (b - a).
class LogDensities {
 public:
  explicit LogDensities(const Mixture& mixture)
      : low_(static_cast<float>(mixture.mean.front())),
        high_(static_cast<float>(mixture.mean.back())),
        scale_(kCells / (high_ - low_)),
        table_(kCells + 1) {
    for (int cell = 0; cell <= kCells; ++cell) {
      const double y = low_ + cell / static_cast<double>(scale_);
      for (int c = 0; c < kComponents; ++c) {
        table_[cell][c] = static_cast<float>(
            std::log(std::max(mixture.share[c], 1e-9) * density(mixture, c, y) + 1e-30));
      }
    }
  }

  /// Beyond the outer means only the outer classes are meant, so y is clamped to them: a wide class
  /// must not win there.
  [[nodiscard]] Posterior operator()(float y) const {
    const float x = (std::clamp(y, low_, high_) - low_) * scale_;
    const int cell = std::min(static_cast<int>(x), kCells - 1);
    const float t = x - static_cast<float>(cell);
    Posterior log;
    for (int c = 0; c < kComponents; ++c)
      log[c] = (1 - t) * table_[cell][c] + t * table_[cell + 1][c];
    return log;
  }

 private:
  static constexpr int kCells = 2048;

  static double density(const Mixture& m, int component, double y) {
    if (component < kClasses) {
      const double z = (y - m.mean[component]) / m.deviation[component];
      return std::exp(-0.5 * z * z) / (m.deviation[component] * std::sqrt(2 * kPi));
    }
    const int a = component == kCsfGrey ? 0 : 1;
    const auto below = [&](int k) {
      return 0.5 * (1 + std::erf((y - m.mean[k]) / (m.deviation[k] * std::sqrt(2.0))));
    };
    return std::max(0.0, below(a) - below(a + 1)) / (m.mean[a + 1] - m.mean[a]);
  }

  float low_;
  float high_;
  float scale_;
  std::vector<Posterior> table_;
};

/// What a voxel holds, given its components' posterior and its intensity: a mixed voxel's shares
/// are where it lies between the two means.
Shares sharesOf(const Posterior& p, float y, const Mixture& mixture) {
  Shares shares = {p[kPureCsf], p[kPureGrey], p[kPureWhite]};
  for (int a = 0; a < 2; ++a) {
    const auto low = static_cast<float>(mixture.mean[a]);
    const auto high = static_cast<float>(mixture.mean[a + 1]);
    const float upper = std::clamp((y - low) / (high - low), 0.0f, 1.0f);
    const float mixed = p[a == 0 ? kCsfGrey : kGreyWhite];
    shares[a] += (1 - upper) * mixed;
    shares[a + 1] += upper * mixed;
  }
  return shares;
}

/// Posterior of each voxel given the mixture and its neighbours' contents, which count by weights.
void expect(const Brain& brain, const std::vector<float>& corrected, const Mixture& mixture,
            const std::array<float, 6>& weights, const std::vector<Shares>& before,
            std::vector<Posterior>& after) {
  const LogDensities densities(mixture);
  parallelForBlocks(brain.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t b = begin; b < end; ++b) {
      Posterior energy = densities(corrected[b]);
      if (!before.empty()) {
        Shares around = {};
        for (int n = 0; n < 6; ++n) {
          const std::int32_t other = brain.neighbours[b][n];
          if (other == kRemains) around[kPureCsf] += weights[n];
          if (other < 0) continue;
          for (int k = 0; k < kClasses; ++k) around[k] += weights[n] * before[other][k];
        }
        for (int c = 0; c < kComponents; ++c) {
          for (int k = 0; k < kClasses; ++k) energy[c] += kComposition[c][k] * around[k];
        }
      }
      const float highest = *std::max_element(energy.begin(), energy.end());
      float sum = 0;
      for (int c = 0; c < kComponents; ++c) {
        after[b][c] = std::exp(energy[c] - highest);
        sum += after[b][c];
      }
      for (int c = 0; c < kComponents; ++c) after[b][c] /= sum;
    }
  });
}

/// Sums of the maximisation step, for each component.
enum Moment { kWeight, kPure, kFirst, kSecond, kMoments };
using Moments = Eigen::Array<double, kMoments, kComponents>;

/// Deviation of the noise, by the median of second differences along the axes: borders are few.
double noiseOf(const Brain& brain) {
  constexpr double kNormal = 0.6745;  // median of a normal variable's size, of its deviation
  std::vector<float> bends;
  for (std::size_t b = 0; b < brain.size(); ++b) {
    for (int axis = 0; axis < 3; ++axis) {
      const std::int32_t before = brain.neighbours[b][2 * axis];
      const std::int32_t after = brain.neighbours[b][2 * axis + 1];
      if (before < 0 || after < 0) continue;
      bends.push_back(
          std::abs(brain.intensity[before] - 2 * brain.intensity[b] + brain.intensity[after]));
    }
  }
  return bends.empty() ? 0 : upperMedian(std::move(bends)) / (kNormal * std::sqrt(6.0));
}

Mixture maximise(const Brain& brain, const std::vector<float>& corrected,
                 const std::vector<Posterior>& posterior) {
  const Moments none = Moments::Zero();
  const Moments sums =
      parallelSum(corrected.size(), kGrain, none, [&](std::size_t begin, std::size_t end) {
        Moments part = none;
        for (std::size_t b = begin; b < end; ++b) {
          const double y = corrected[b];
          for (int c = 0; c < kComponents; ++c) part(kWeight, c) += posterior[b][c];
          for (int k = brain.rim[b]; k < kClasses; ++k) {  // fluid not from the rim
            part(kPure, k) += posterior[b][k];
            part(kFirst, k) += posterior[b][k] * y;
            part(kSecond, k) += posterior[b][k] * y * y;
          }
        }
        return part;
      });
  Mixture mixture;
  for (int k = 0; k < kClasses; ++k) mixture.mean[k] = sums(kFirst, k) / sums(kPure, k);
  for (int c = 0; c < kComponents; ++c) {
    mixture.share[c] = sums(kWeight, c) / static_cast<double>(corrected.size());
  }
  const double range = mixture.mean[2] - mixture.mean[0];
  for (int k = 0; k < kClasses; ++k) {
    const double variance = sums(kSecond, k) / sums(kPure, k) - mixture.mean[k] * mixture.mean[k];
    mixture.deviation[k] = std::clamp(std::sqrt(std::max(0.0, variance)), kLeastDeviation * range,
                                      kMostDeviation * range);
  }
  return mixture;
}

/// The field that best explains what the pure grey and white voxels show.  Fluid and mixtures are
/// left out: what they should show is less certain.
std::vector<float> updateBias(const Grid& grid, const Brain& brain, const Mixture& mixture,
                              const std::vector<Posterior>& posterior, double width) {
  BiasSamples samples;
  samples.voxel = &brain.voxel;
  samples.numerator.resize(brain.size());
  samples.denominator.resize(brain.size());
  parallelForBlocks(brain.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t b = begin; b < end; ++b) {
      double numerator = 0;
      double denominator = 0;
      for (int k = kPureGrey; k <= kPureWhite; ++k) {
        const double p = posterior[b][k] / (mixture.deviation[k] * mixture.deviation[k]);
        numerator += p * mixture.mean[k] * brain.intensity[b];
        denominator += p * mixture.mean[k] * mixture.mean[k];
      }
      samples.numerator[b] = static_cast<float>(numerator);
      samples.denominator[b] = static_cast<float>(denominator);
    }
  });
  return fitBiasField(grid, samples, width);
}

void checkOptions(const TissueOptions& options) {
  if (!(options.smooth >= 0)) throw InvalidInput("smooth: must be 0 or more");
  if (!(options.biasWidth >= 0)) throw InvalidInput("bias-width: must be 0 mm or more");
  if (!(options.localWidth >= 0)) throw InvalidInput("local-width: must be 0 mm or more");
  if (options.maxIterations < 1) throw InvalidInput("max-iterations: must be 1 or more");
  if (!(options.tolerance > 0)) throw InvalidInput("tolerance: must be above 0");
}

/// Tissue classes of a brain on their way.
class Classifier {
 public:
  Classifier(const Grid& grid, Brain brain, const TissueOptions& options)
      : grid_(grid), options_(options), brain_(std::move(brain)) {
    // Classes of a strongly shaded image would take the shading for tissue and keep it: so it is
    // taken off first, as far as it can be without classes.
    shading_.assign(brain_.size(), 1.0f);
    if (options_.biasWidth > 0) {
      shading_ = sharpenHistogram(grid_, brain_.voxel, brain_.intensity, options_.biasWidth);
      for (std::size_t b = 0; b < brain_.size(); ++b) brain_.intensity[b] /= shading_[b];
    }
    markRim(grid_, brain_);
    noise_ = noiseOf(brain_);
    mixture_ = firstGuess(brain_);
    corrected_ = brain_.intensity;
    field_.assign(brain_.size(), 1.0f);
    posterior_.resize(brain_.size());
  }

  /// One expectation and maximisation.
  /// @return how far a mean has moved, of their range
  /// @throws InvalidInput  the classes fall together
  double iterate() {
    expect(brain_, corrected_, mixture_, weights(kWhileEstimated), shares_, posterior_);
    if (options_.biasWidth > 0) {
      field_ = updateBias(grid_, brain_, mixture_, posterior_, options_.biasWidth);
      forVoxels([&](std::size_t b) { corrected_[b] = brain_.intensity[b] / field_[b]; });
    }
    const Mixture updated = maximise(brain_, corrected_, posterior_);
    if (!(updated.mean[0] < updated.mean[1] && updated.mean[1] < updated.mean[2])) {
      throw InvalidInput(
          "T1: the intensities do not separate into fluid, grey and white matter; "
          "check that the image is T1-weighted and skull-stripped");
    }
    double moved = 0;
    for (int k = 0; k < kClasses; ++k) {
      moved = std::max(moved, std::abs(updated.mean[k] - mixture_.mean[k]));
    }
    mixture_ = updated;
    takeShares(corrected_);
    return moved / (mixture_.mean[2] - mixture_.mean[0]);
  }

  /// Puts the borders where brightness changes most steeply around each voxel.
  void followEdges() {
    const BlockWindow window(grid_, brain_.voxel, options_.localWidth, kLocalBlocks);
    const std::array<double, kClasses> mean = mixture_.mean;
    EdgeSamples samples{&brain_.voxel, &brain_.neighbours,
                        &brain_.rim,   &corrected_,
                        grid_.spacing, std::vector<std::uint8_t>(brain_.size())};
    forVoxels(
        [&](std::size_t b) { samples.pure[b] = posterior_[b][kPureWhite] > kLikelyWhite ? 1 : 0; });
    BorderFinder finder(window, samples, mean);
    // Two tissues of equal spread and share meet half way between their means.  No tissue spreads
    // less than the noise.  Mixtures, which explain any voxel's noise, have done their work.
    const double spread = 0.5 * (mixture_.deviation[kPureGrey] + mixture_.deviation[kPureWhite]);
    Mixture fair{mean, {}, {}};
    fair.deviation.fill(std::max(spread, noise_));
    std::fill_n(fair.share.begin(), kClasses, 1.0 / kClasses);
    for (int round = 0; round < kEdgeRounds; ++round) finder.improve();
    const auto even = evened(corrected_, finder.levels(), mean);
    for (int round = 0; round < kPriorRounds; ++round) {
      expect(brain_, even, fair, weights(1), shares_, posterior_);
      takeShares(even);
    }
  }

  /// The median of fluid that nothing else mixes with: thin layers are never seen as dark as they
  /// are, nor is what lies beside a sheet of dura.
  [[nodiscard]] double deepFluid() const {
    const double half = 0.5 * (mixture_.mean[0] + mixture_.mean[1]);
    VoxelSet bright(grid_, 1);
    for (std::size_t b = 0; b < brain_.size(); ++b) {
      bright[brain_.voxel[b]] = corrected_[b] > half ? 1 : 0;
    }
    const Volume<float> squared = squaredDistanceTo(bright);
    const double far = kFarVoxels * std::cbrt(grid_.voxelVolume());
    std::vector<float> deep;
    for (std::size_t b = 0; b < brain_.size(); ++b) {
      if (brain_.rim[b] == 0 && squared[brain_.voxel[b]] > far * far) deep.push_back(corrected_[b]);
    }
    return deep.size() < kFewestDeep ? mixture_.mean[0] : upperMedian(std::move(deep));
  }

  /// Takes out what is too bright for any tissue, as fat and vessels are.
  /// @param taken  their voxels are added to it
  /// @return whether there was any
  bool takeOutBright(std::vector<std::size_t>& taken) {
    const std::vector<std::uint8_t> bright = brightRemains();
    if (std::find(bright.begin(), bright.end(), 1) == bright.end()) return false;
    takeOut(bright, brain_, taken);
    for (auto* values : {&shading_, &field_, &corrected_}) keep(bright, *values);
    keep(bright, posterior_);
    keep(bright, shares_);
    return true;
  }

  /// @param remains  voxels that are fluid without being looked at
  void write(const std::vector<std::size_t>& remains, TissueSegmentation& result) const {
    result.deepFluid = deepFluid();
    result.noise = noise_;
    for (int k = 0; k < kClasses; ++k) {
      result.classes[k] = {mixture_.mean[k], mixture_.deviation[k], 0};
    }
    result.labels = Volume<Label>(grid_, 0);
    result.bias = Volume<float>(grid_, 1.0f);
    for (auto& p : result.probability) p = Volume<float>(grid_, 0.0f);
    for (std::size_t b = 0; b < shares_.size(); ++b) {
      const std::size_t v = brain_.voxel[b];
      for (int k = 0; k < kClasses; ++k) {
        result.probability[k][v] = shares_[b][k];
        result.classes[k].share += shares_[b][k] / static_cast<double>(result.brainVoxels);
      }
      const auto likeliest = std::max_element(shares_[b].begin(), shares_[b].end());
      result.labels[v] = static_cast<Label>(likeliest - shares_[b].begin()) + kCsf;
      result.bias[v] = shading_[b] * field_[b];
    }
    for (const std::size_t v : remains) {
      result.probability[kPureCsf][v] = 1;
      result.labels[v] = kCsf;
    }
    result.classes[kPureCsf].share +=
        static_cast<double>(remains.size()) / static_cast<double>(result.brainVoxels);
  }

 private:
  /// What is too bright for any tissue, and what looks like tissue between it and what is dark,
  /// where the two share voxels.
  [[nodiscard]] std::vector<std::uint8_t> brightRemains() const {
    const double white = mixture_.mean[kPureWhite];
    const double least = std::max(kBrighterThanTissue * white, white + kBeyondNoise * noise_);
    const double dark = 0.5 * (mixture_.mean[kPureCsf] + mixture_.mean[kPureGrey]);
    std::vector<std::uint8_t> remains(brain_.size(), 0);
    for (std::size_t b = 0; b < brain_.size(); ++b) {
      if (!(corrected_[b] > least)) continue;
      remains[b] = 1;
      for (int n = 0; n < 6; ++n) {
        const std::int32_t next = brain_.neighbours[b][n];
        if (next < 0) continue;
        const std::int32_t beyond = brain_.neighbours[next][n];
        if (beyond < 0 || corrected_[beyond] < dark) remains[next] = 1;
      }
    }
    return remains;
  }

  template <class Work>
  void forVoxels(const Work& work) const {
    parallelFor(brain_.size(), kGrain, work);
  }

  void takeShares(const std::vector<float>& seen) {
    shares_.resize(brain_.size());
    forVoxels([&](std::size_t b) { shares_[b] = sharesOf(posterior_[b], seen[b], mixture_); });
  }

  /// What each of the six neighbours counts, times a factor: a farther one less.
  [[nodiscard]] std::array<float, 6> weights(double factor) const {
    std::array<float, 6> result;
    const Vector& spacing = grid_.spacing;
    for (int n = 0; n < 6; ++n) {
      result[n] =
          static_cast<float>(factor * options_.smooth * spacing.minCoeff() / spacing[n / 2]);
    }
    return result;
  }

  Grid grid_;
  TissueOptions options_;
  Brain brain_;
  std::vector<float> shading_, field_, corrected_;
  double noise_ = 0;  ///< deviation
  Mixture mixture_;
  std::vector<Posterior> posterior_;
  std::vector<Shares> shares_;
};

}  // namespace

TissueSegmentation segmentTissue(const Volume<float>& intensity, const Volume<Label>& mask,
                                 const TissueOptions& options, const Monitor& monitor) {
  checkOptions(options);
  if (mask.size() != 0 && !sameGrid(mask.grid, intensity.grid)) {
    throw InvalidInput("mask: lies on another grid than the T1; resample it to the T1's grid");
  }
  Brain brain = packBrain(intensity, mask);
  if (brain.size() < 100) {
    throw InvalidInput("T1: found " + std::to_string(brain.size()) +
                       " brain voxels (intensity above 0, or in the mask), expected a "
                       "skull-stripped brain");
  }
  TissueSegmentation result;
  result.brainVoxels = static_cast<std::int64_t>(brain.size());
  result.termination = Termination::MaxIterations;
  std::vector<std::size_t> remains;
  if (mask.size() == 0) takeOut(darkRemains(intensity.grid, brain), brain, remains);
  Classifier classifier(intensity.grid, std::move(brain), options);
  while (result.iterations < options.maxIterations) {
    if (monitor.shouldStop()) {
      result.termination = Termination::Interrupted;
      break;
    }
    monitor.progress(static_cast<double>(result.iterations) / options.maxIterations,
                     "tissue classes");
    const double moved = classifier.iterate();
    if (++result.iterations <= kFirstIterations) continue;
    if (!classifier.takeOutBright(remains) && moved <= options.tolerance) {
      result.termination = Termination::Converged;
      break;
    }
  }
  if (options.localWidth > 0 && !monitor.shouldStop()) classifier.followEdges();
  classifier.write(remains, result);
  monitor.progress(1, "tissue classes");
  return result;
}

}  // namespace explica::segmentation
