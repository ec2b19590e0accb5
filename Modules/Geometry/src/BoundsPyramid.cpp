// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Geometry/BoundsPyramid.h"

#include "Explica/Core/Parallel.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

namespace explica::geometry {
namespace {

constexpr int kLanes = BoundsBlock::kLanes;  // boxes a block
constexpr std::size_t kGrain = 2048;         // elements a task
constexpr float kFar = 1e30F;                // of lanes without an item: nothing is near them

constexpr int kCodeBits = 10;  // per axis

/// The bits of an axis's coordinate, each followed by two zeros.
std::uint32_t spread(std::uint32_t bits) {
  bits = (bits | (bits << 16)) & 0x030000FFU;
  bits = (bits | (bits << 8)) & 0x0300F00FU;
  bits = (bits | (bits << 4)) & 0x030C30C3U;
  return (bits | (bits << 2)) & 0x09249249U;
}

struct Placed {
  std::uint32_t code;
  std::int32_t item;
};

/// Items along the Morton curve through their middles.
std::vector<Placed> alongCurve(std::span<const MotionBounds> items) {
  struct Union {
    MotionBounds bounds;
    void operator+=(const Union& other) { bounds.extend(other.bounds); }
  };
  const MotionBounds all =
      parallelSum(items.size(), kGrain, Union{items[0]}, [&](std::size_t begin, std::size_t end) {
        Union part{items[begin]};
        for (std::size_t n = begin; n < end; ++n) {
          part.bounds.extend(items[n]);
        }
        return part;
      }).bounds;
  float widest = 0;
  for (int k = 0; k < 3; ++k) widest = std::max(widest, all.upper[k] - all.lower[k]);
  const float scale = widest > 0 ? static_cast<float>((1 << kCodeBits) - 1) / widest : 0;
  std::vector<Placed> placed(items.size());
  parallelFor(items.size(), [&](std::size_t n) {
    std::uint32_t code = 0;
    for (int k = 0; k < 3; ++k) {
      const float middle = 0.5F * (items[n].lower[k] + items[n].upper[k]) - all.lower[k];
      const float cell = std::clamp(scale * middle, 0.0F, static_cast<float>((1 << kCodeBits) - 1));
      code |= spread(static_cast<std::uint32_t>(cell)) << k;
    }
    placed[n] = {code, static_cast<std::int32_t>(n)};
  });
  // Stable passes over ten bits each.
  std::vector<Placed> sorted(placed.size());
  for (int pass = 0; pass < 3; ++pass) {
    constexpr std::uint32_t kMask = (1U << kCodeBits) - 1;
    const auto digit = [&](const Placed& p) { return (p.code >> (kCodeBits * pass)) & kMask; };
    std::array<std::size_t, (1U << kCodeBits) + 1> begin{};
    for (const Placed& p : placed) ++begin[digit(p) + 1];
    for (std::size_t n = 1; n < begin.size(); ++n) begin[n] += begin[n - 1];
    for (const Placed& p : placed) sorted[begin[digit(p)]++] = p;
    std::swap(placed, sorted);
  }
  return placed;
}

void put(const MotionBounds& bounds, BoundsBlock& block, int lane) {
  for (int k = 0; k < 3; ++k) {
    block.lower[k][lane] = bounds.lower[k];
    block.upper[k][lane] = bounds.upper[k];
    block.least[k][lane] = bounds.least[k];
    block.most[k][lane] = bounds.most[k];
  }
}

MotionBounds nothing() {
  MotionBounds bounds;
  for (int k = 0; k < 3; ++k) {
    bounds.lower[k] = bounds.least[k] = kFar;
    bounds.upper[k] = bounds.most[k] = -kFar;
  }
  return bounds;
}

MotionBounds boundsOf(const BoundsBlock& block) {
  MotionBounds bounds;
  for (int k = 0; k < 3; ++k) {
    bounds.lower[k] = *std::min_element(block.lower[k], block.lower[k] + kLanes);
    bounds.upper[k] = *std::max_element(block.upper[k], block.upper[k] + kLanes);
    bounds.least[k] = *std::min_element(block.least[k], block.least[k] + kLanes);
    bounds.most[k] = *std::max_element(block.most[k], block.most[k] + kLanes);
  }
  return bounds;
}

/// Next single-precision number or two below (sign -1) or above (sign 1); what is too large for
/// that, or no number, bounds nothing.
float roundedOutwards(double value, float sign) {
  constexpr double kLargest = 1e29;
  if (!(std::abs(value) < kLargest)) return sign * std::numeric_limits<float>::max();
  const auto near = static_cast<float>(value);
  return near + sign * (1.2e-7F * std::abs(near) + 1e-30F);
}

}  // namespace

MotionBounds MotionBounds::ofPoint(const Vector& fromOrigin, const Vector& motion) {
  MotionBounds bounds;
  for (int k = 0; k < 3; ++k) {
    bounds.lower[k] = roundedOutwards(fromOrigin[k], -1);
    bounds.upper[k] = roundedOutwards(fromOrigin[k], 1);
    bounds.least[k] = roundedOutwards(motion[k], -1);
    bounds.most[k] = roundedOutwards(motion[k], 1);
  }
  return bounds;
}

void MotionBounds::extend(const MotionBounds& other) {
  for (int k = 0; k < 3; ++k) {
    lower[k] = std::min(lower[k], other.lower[k]);
    upper[k] = std::max(upper[k], other.upper[k]);
    least[k] = std::min(least[k], other.least[k]);
    most[k] = std::max(most[k], other.most[k]);
  }
}

BoundsPyramid::BoundsPyramid(std::span<const MotionBounds> items) : items_(items.size()) {
  if (items.empty()) return;
  const std::vector<Placed> order = alongCurve(items);
  const auto blocksFor = [](std::size_t count) { return (count + kLanes - 1) / kLanes; };
  const auto fill = [&](std::size_t count, const auto& boundsAt) {
    std::vector<BoundsBlock> level(blocksFor(count));
    parallelFor(level.size(), kGrain / kLanes, [&](std::size_t b) {
      for (int lane = 0; lane < kLanes; ++lane) {
        const std::size_t n = kLanes * b + static_cast<std::size_t>(lane);
        put(n < count ? boundsAt(n) : nothing(), level[b], lane);
      }
    });
    return level;
  };
  for (std::size_t n = 0; n < order.size(); ++n) items_[n] = order[n].item;
  levels_.push_back(fill(items.size(), [&](std::size_t n) { return items[order[n].item]; }));
  while (levels_.back().size() > 1) {
    const std::vector<BoundsBlock>& below = levels_.back();
    levels_.push_back(fill(below.size(), [&](std::size_t n) { return boundsOf(below[n]); }));
  }
  const MotionBounds all = boundsOf(levels_.back().front());
  const MotionBounds still = MotionBounds::ofPoint(Vector::Zero(), Vector::Zero());
  for (int k = 0; k < 3; ++k) {
    isStill_ = isStill_ && all.least[k] >= still.least[k] && all.most[k] <= still.most[k];
  }
}

}  // namespace explica::geometry
