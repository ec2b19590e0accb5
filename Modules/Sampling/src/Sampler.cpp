// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Sampling/Sampler.h"

#include "Explica/Core/Errors.h"
#include "Explica/Core/Parallel.h"
#include "Known.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace explica::sampling {
namespace {

constexpr std::size_t kChunk = 64;        // points that follow each other, written together
constexpr std::size_t kChunksATask = 16;  // taken by one thread
constexpr std::size_t kPointGrain = kChunk * kChunksATask;  // points a task
constexpr std::size_t kVoxelGrain = 1 << 15;                // elements a task
constexpr auto kNotKnown = static_cast<float>(kNaN);        // outside of the volume or mask

/// Frames voxel by voxel, and which voxels are known in each of them.
struct Block {
  std::vector<float> values;        ///< voxels x F, frames beyond the last are 0
  std::vector<std::uint8_t> whole;  ///< 1: known in every frame; empty: all are
};

template <int F>
Block blockOf(std::span<const float> frames, std::size_t voxels, std::size_t count,
              const std::vector<std::uint8_t>& mask) {
  Block block;
  block.values.resize(voxels * F);
  block.whole.resize(voxels);
  const auto unknown =
      parallelSum(voxels, kVoxelGrain, std::size_t{0}, [&](std::size_t begin, std::size_t end) {
        std::size_t bad = 0;
        for (std::size_t v = begin; v < end; ++v) {
          bool known = mask.empty() || mask[v] != 0;
          for (std::size_t f = 0; f < count; ++f) {
            const float value = frames[f * voxels + v];
            block.values[v * F + f] = value;
            known = known && std::isfinite(value);
          }
          block.whole[v] = known;
          bad += !known;
        }
        return bad;
      });
  if (unknown == 0) block.whole.clear();
  return block;
}

std::array<float, 4> keysWeights(float t) {
  const float t2 = t * t, t3 = t2 * t;
  return {0.5F * (-t3 + 2 * t2 - t), 0.5F * (3 * t3 - 5 * t2 + 2), 0.5F * (-3 * t3 + 4 * t2 + t),
          0.5F * (t3 - t2)};
}

}  // namespace

Sampler::Sampler(const Grid& grid, const Positions& points, Interpolation interpolation,
                 const Volume<std::uint8_t>* mask)
    : grid_(grid),
      interpolation_(interpolation),
      corners_(static_cast<std::size_t>(points.rows())) {
  if (mask != nullptr) {
    if (mask->grid.size != grid.size) {
      throw InvalidInput("mask: its size differs from the volume's");
    }
    mask_ = mask->data;
  }
  parallelFor(corners_.size(), [&](std::size_t p) {
    const Vector index = grid_.toIndex(points.row(p).transpose());
    Corner& corner = corners_[p];
    corner.inside = index.allFinite();
    for (int axis = 0; axis < 3; ++axis) {
      // Points of a slice are those within half a voxel of it, and rounding at the outermost voxel
      // centres does not take a point out of the grid.
      const double at = corner.inside ? index[axis] : -2;
      const double low = std::floor(at);
      corner.inside = corner.inside && low >= -1 && low < grid_.size[axis];
      corner.voxel[axis] = corner.inside ? static_cast<std::int32_t>(low) : 0;
      corner.fraction[axis] = static_cast<float>(at - low);
    }
  });
  orderChunks();
}

void Sampler::orderChunks() {
  const std::size_t count = (corners_.size() + kChunk - 1) / kChunk;
  std::vector<std::pair<std::size_t, std::uint32_t>> places(count);
  for (std::size_t c = 0; c < count; ++c) {
    const Corner& first = corners_[c * kChunk];
    std::size_t place = 0;
    for (int axis = 2; axis >= 0; --axis) {
      place = place * static_cast<std::size_t>(grid_.size[axis]) +
              static_cast<std::size_t>(std::max(first.voxel[axis], 0));
    }
    places[c] = {place, static_cast<std::uint32_t>(c)};
  }
  std::ranges::sort(places);
  chunks_.resize(count);
  std::ranges::transform(places, chunks_.begin(), [](const auto& place) { return place.second; });
}

bool Sampler::allKnown(const Corner& corner, const std::uint8_t* whole, int reach) const {
  for (int axis = 0; axis < 3; ++axis) {
    if (corner.voxel[axis] < reach - 1 || corner.voxel[axis] + reach >= grid_.size[axis]) {
      return false;
    }
  }
  if (whole == nullptr) return true;
  for (int k = 1 - reach; k <= reach; ++k) {
    for (int j = 1 - reach; j <= reach; ++j) {
      const std::size_t row =
          grid_.linear(corner.voxel[0], corner.voxel[1] + j, corner.voxel[2] + k);
      for (int i = 1 - reach; i <= reach; ++i) {
        if (whole[row + i] == 0) return false;
      }
    }
  }
  return true;
}

template <int F>
void Sampler::linear(const Corner& corner, const float* values, float* to) const {
  const auto [x, y, z] = corner.fraction;
  const std::size_t stepJ = grid_.size[0];
  const std::size_t stepK = stepJ * grid_.size[1];
  const float* at = values + F * grid_.linear(corner.voxel[0], corner.voxel[1], corner.voxel[2]);
  const float* rows[4] = {at, at + F * stepJ, at + F * stepK, at + F * (stepJ + stepK)};
  const float w[4] = {(1 - y) * (1 - z), y * (1 - z), (1 - y) * z, y * z};
  std::array<float, F> sum{};  // apart from the voxels, so that it stays in registers
  for (int r = 0; r < 4; ++r) {
    const float a = w[r] * (1 - x), b = w[r] * x;
    for (int f = 0; f < F; ++f) sum[f] += a * rows[r][f] + b * rows[r][F + f];
  }
  std::ranges::copy(sum, to);
}

template <int F>
void Sampler::cubic(const Corner& corner, const float* values, float* to) const {
  const auto x = keysWeights(corner.fraction[0]), y = keysWeights(corner.fraction[1]),
             z = keysWeights(corner.fraction[2]);
  for (int f = 0; f < F; ++f) to[f] = 0;
  for (int k = 0; k < 4; ++k) {
    for (int j = 0; j < 4; ++j) {
      const float* row = values + F * grid_.linear(corner.voxel[0] - 1, corner.voxel[1] + j - 1,
                                                   corner.voxel[2] + k - 1);
      for (int i = 0; i < 4; ++i) {
        const float weight = x[i] * y[j] * z[k];
        for (int f = 0; f < F; ++f) to[f] += weight * row[F * i + f];
      }
    }
  }
}

void Sampler::linearOfKnown(const Corner& corner, const float* values, int frameCount,
                            float* to) const {
  std::array<double, kFramesAtOnce> sum{}, weights{};  // a constant map comes back exactly
  const int stride = frameCount == 1 ? 1 : kFramesAtOnce;
  for (int n = 0; n < 8; ++n) {
    double weight = 1;
    std::array<int, 3> voxel;
    for (int axis = 0; axis < 3; ++axis) {
      const bool upper = (n >> axis & 1) != 0;
      const double t = corner.fraction[axis];
      voxel[axis] = corner.voxel[axis] + upper;
      weight *= upper ? t : 1 - t;
    }
    if (weight == 0 || !grid_.contains(voxel[0], voxel[1], voxel[2])) continue;
    const std::size_t at = grid_.linear(voxel[0], voxel[1], voxel[2]);
    if (masked(at)) continue;
    for (int f = 0; f < frameCount; ++f) {
      const float value = values[at * stride + f];
      if (!std::isfinite(value)) continue;
      sum[f] += weight * value;
      weights[f] += weight;
    }
  }
  for (int f = 0; f < frameCount; ++f) {
    to[f] = weights[f] >= kEnough ? static_cast<float>(sum[f] / weights[f]) : kNotKnown;
  }
}

void Sampler::cubicOfKnown(const Corner& corner, const float* values, int frameCount,
                           float* to) const {
  const auto x = keysWeights(corner.fraction[0]), y = keysWeights(corner.fraction[1]),
             z = keysWeights(corner.fraction[2]);
  std::array<float, kFramesAtOnce> sum{};
  const int stride = frameCount == 1 ? 1 : kFramesAtOnce;
  for (int n = 0; n < 64; ++n) {
    const int i = n % 4, j = n / 4 % 4, k = n / 16;
    const std::size_t at =
        grid_.linear(corner.voxel[0] + i - 1, corner.voxel[1] + j - 1, corner.voxel[2] + k - 1);
    if (masked(at)) return;
    for (int f = 0; f < frameCount; ++f) sum[f] += x[i] * y[j] * z[k] * values[at * stride + f];
  }
  for (int f = 0; f < frameCount; ++f) {
    if (std::isfinite(sum[f])) to[f] = sum[f];  // a voxel that is not finite makes the sum so
  }
}

void Sampler::nearest(const Corner& corner, const float* values, int frameCount, float* to) const {
  std::fill(to, to + frameCount, kNotKnown);
  std::array<int, 3> voxel;
  for (int axis = 0; axis < 3; ++axis) {
    voxel[axis] = corner.voxel[axis] + (corner.fraction[axis] >= 0.5F);
  }
  if (!grid_.contains(voxel[0], voxel[1], voxel[2])) return;
  const std::size_t at = grid_.linear(voxel[0], voxel[1], voxel[2]);
  if (masked(at)) return;
  const int stride = frameCount == 1 ? 1 : kFramesAtOnce;
  for (int f = 0; f < frameCount; ++f) {
    const float value = values[at * stride + f];
    if (std::isfinite(value)) to[f] = value;
  }
}

template <int F>
void Sampler::sampleOne(const Corner& corner, const float* values, const std::uint8_t* whole,
                        int frameCount, float* to) const {
  if (!corner.inside) {
    std::fill(to, to + F, kNotKnown);
  } else if (interpolation_ == Interpolation::Nearest) {
    nearest(corner, values, frameCount, to);
  } else if (interpolation_ == Interpolation::Cubic && allKnown(corner, whole, 2)) {
    cubic<F>(corner, values, to);
  } else if (interpolation_ == Interpolation::Linear && allKnown(corner, whole, 1)) {
    linear<F>(corner, values, to);
  } else {
    linearOfKnown(corner, values, frameCount, to);
    if (interpolation_ == Interpolation::Cubic && allKnown(corner, nullptr, 2)) {
      cubicOfKnown(corner, values, frameCount, to);
    }
  }
}

template <int F>
void Sampler::sampleBlock(const float* values, const std::uint8_t* whole, std::size_t frameCount,
                          std::vector<float>& result, std::size_t firstFrame) const {
  const std::size_t points = corners_.size();
  parallelFor(chunks_.size(), kChunksATask, [&](std::size_t c) {
    alignas(64) std::array<float, kChunk * F> made;
    const std::size_t begin = chunks_[c] * kChunk, end = std::min(begin + kChunk, points);
    for (std::size_t p = begin; p < end; ++p) {
      sampleOne<F>(corners_[p], values, whole, static_cast<int>(frameCount),
                   made.data() + (p - begin) * F);
    }
    for (std::size_t f = 0; f < frameCount; ++f) {
      float* row = result.data() + (firstFrame + f) * points;
      for (std::size_t p = begin; p < end; ++p) row[p] = made[(p - begin) * F + f];
    }
  });
}

std::vector<float> Sampler::sample(std::span<const float> frames) const {
  const std::size_t voxels = grid_.voxelCount();
  if (voxels == 0 || frames.empty() || frames.size() % voxels != 0) {
    throw InvalidInput("frames: " + std::to_string(frames.size()) +
                       " values are no whole number of volumes of " + std::to_string(voxels));
  }
  const std::size_t count = frames.size() / voxels;
  std::vector<float> result(count * corners_.size());
  for (std::size_t first = 0; first < count; first += kFramesAtOnce) {
    const std::size_t some = std::min<std::size_t>(kFramesAtOnce, count - first);
    const auto part = frames.subspan(first * voxels, some * voxels);
    if (some == 1) {
      const Block block = blockOf<1>(part, voxels, 1, mask_);
      sampleBlock<1>(part.data(), block.whole.empty() ? nullptr : block.whole.data(), 1, result,
                     first);
    } else {
      const Block block = blockOf<kFramesAtOnce>(part, voxels, some, mask_);
      sampleBlock<kFramesAtOnce>(block.values.data(),
                                 block.whole.empty() ? nullptr : block.whole.data(), some, result,
                                 first);
    }
  }
  return result;
}

std::vector<Label> Sampler::sampleLabels(std::span<const Label> labels) const {
  if (labels.size() != grid_.voxelCount()) {
    throw InvalidInput("labels: " + std::to_string(labels.size()) + " values for " +
                       std::to_string(grid_.voxelCount()) + " voxels");
  }
  std::vector<Label> result(corners_.size(), kNoLabel);
  parallelFor(corners_.size(), kPointGrain, [&](std::size_t p) {
    const Corner& corner = corners_[p];
    if (!corner.inside) return;
    struct Vote {
      Label label;
      float weight;
      float largest;  ///< of one voxel
    };
    std::array<Vote, 8> votes;
    int count = 0;
    float known = 0;
    for (int n = 0; n < 8; ++n) {
      float weight = 1;
      std::array<int, 3> voxel;
      for (int axis = 0; axis < 3; ++axis) {
        const bool upper = (n >> axis & 1) != 0;
        const float t = interpolation_ == Interpolation::Nearest
                            ? static_cast<float>(corner.fraction[axis] >= 0.5F)
                            : corner.fraction[axis];
        voxel[axis] = corner.voxel[axis] + upper;
        weight *= upper ? t : 1 - t;
      }
      if (weight == 0 || !grid_.contains(voxel[0], voxel[1], voxel[2])) continue;
      const std::size_t at = grid_.linear(voxel[0], voxel[1], voxel[2]);
      if (masked(at)) continue;
      known += weight;
      int slot = 0;
      while (slot < count && votes[slot].label != labels[at]) ++slot;
      if (slot == count) votes[count++] = {labels[at], 0, 0};
      votes[slot].weight += weight;
      votes[slot].largest = std::max(votes[slot].largest, weight);
    }
    if (known < kEnough) return;
    result[p] =
        std::max_element(votes.begin(), votes.begin() + count, [](const Vote& a, const Vote& b) {
          return std::pair(a.weight, a.largest) < std::pair(b.weight, b.largest);
        })->label;
  });
  return result;
}

std::vector<float> sampleVolume(const Volume<float>& volume, const Positions& points,
                                Interpolation interpolation, const Volume<std::uint8_t>* mask) {
  return Sampler(volume.grid, points, interpolation, mask).sample(volume.data);
}

}  // namespace explica::sampling
