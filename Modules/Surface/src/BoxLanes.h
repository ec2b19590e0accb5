// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <limits>

namespace explica::surface {

/// Least and greatest coordinates: x, y, z of the low corner, then of the high one.
using Box = std::array<float, 6>;

inline bool contains(const Box& outer, const Box& inner) {
  return outer[0] <= inner[0] && outer[1] <= inner[1] && outer[2] <= inner[2] &&
         inner[3] <= outer[3] && inner[4] <= outer[4] && inner[5] <= outer[5];
}

/// Four boxes that are compared with a fifth at once.
class BoxLanes {
 public:
  static constexpr int kLanes = 4;

  BoxLanes() {
    for (int lane = 0; lane < kLanes; ++lane) clear(lane);
  }
  void set(int lane, const Box& box) {
    for (int a = 0; a < 6; ++a) side_[a][lane] = box[a];
  }
  /// A box that meets none.
  void clear(int lane) {
    for (int a = 0; a < 3; ++a) {
      side_[a][lane] = std::numeric_limits<float>::infinity();
      side_[a + 3][lane] = -std::numeric_limits<float>::infinity();
    }
  }
  void copy(int lane, const BoxLanes& from, int fromLane) {
    for (int a = 0; a < 6; ++a) side_[a][lane] = from.side_[a][fromLane];
  }
  /// Bit n is 1 if box n has a point in common with `box`.
  [[nodiscard]] unsigned meeting(const Box& box) const {
    const Four hit = (side_[0] <= box[3]) & (side_[3] >= box[0]) & (side_[1] <= box[4]) &
                     (side_[4] >= box[1]) & (side_[2] <= box[5]) & (side_[5] >= box[2]);
    return (static_cast<unsigned>(hit[0]) & 1U) | (static_cast<unsigned>(hit[1]) & 2U) |
           (static_cast<unsigned>(hit[2]) & 4U) | (static_cast<unsigned>(hit[3]) & 8U);
  }

 private:
  // The compiler's own vectors: four numbers in one register on every machine that has such.
  using FourFloats = float __attribute__((vector_size(16)));
  using Four = std::int32_t __attribute__((vector_size(16)));
  std::array<FourFloats, 6> side_;
};

}  // namespace explica::surface
