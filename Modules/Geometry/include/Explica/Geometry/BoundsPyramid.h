// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Types.h"

#include <cstdint>
#include <span>
#include <vector>

namespace explica::geometry {

/// Where a thing starts and how far it goes, axis by axis: mm, single precision, rounded outwards.
/// What stands still has motions of zero.
struct MotionBounds {
  float lower[3], upper[3];  ///< of its points at the start, from a common origin
  float least[3], most[3];   ///< of their motions

  [[nodiscard]] static MotionBounds ofPoint(const Vector& fromOrigin, const Vector& motion);
  void extend(const MotionBounds& other);
};

/// Bounds of eight things side by side, for vector arithmetic.
struct alignas(64) BoundsBlock {
  static constexpr int kLanes = 8;
  float lower[3][kLanes], upper[3][kLanes], least[3][kLanes], most[3][kLanes];
};

/// Hierarchy over bounds in which every node has eight children: level 0 holds the items, along a
/// space-filling curve, and lane n of the level above bounds block n of a level.
///
/// A build sorts by Morton codes and costs about as much as one pass over the items.
class BoundsPyramid {
 public:
  BoundsPyramid() = default;
  explicit BoundsPyramid(std::span<const MotionBounds> items);

  [[nodiscard]] int levelCount() const { return static_cast<int>(levels_.size()); }
  [[nodiscard]] const BoundsBlock& block(int level, std::int32_t n) const {
    return levels_[level][n];
  }
  /// True if nothing moves.
  [[nodiscard]] bool isStill() const { return isStill_; }
  /// Item in a lane of level 0, counted through its blocks.
  [[nodiscard]] std::int32_t item(std::int32_t place) const { return items_[place]; }

 private:
  std::vector<std::vector<BoundsBlock>> levels_;
  std::vector<std::int32_t> items_;
  bool isStill_ = true;
};

/// Which lanes of a come within reach of which lanes of b (bit 8 i + j) at some time of their
/// motion: along each axis the gap at the start less what the motions may take of it, and the three
/// together. Vectorised, with the same bits on every processor.
/// @param still  nothing moves in either
[[nodiscard]] std::uint64_t mayMeet(const BoundsBlock& a, const BoundsBlock& b, float squaredReach,
                                    bool still);

}  // namespace explica::geometry
