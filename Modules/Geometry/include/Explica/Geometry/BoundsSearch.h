// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Geometry/BoundsPyramid.h"

#include <bit>
#include <cstdint>
#include <vector>

namespace explica::geometry {

/// Two pyramids, or one with itself, and how near their items come to count.
struct BoundsSearch {
  const BoundsPyramid* first;
  const BoundsPyramid* second;
  float squaredReach;  ///< mm^2
  [[nodiscard]] bool same() const { return first == second; }
};

/// A block of each whose contents may meet.
struct BlockPair {
  int firstLevel, secondLevel;
  std::int32_t first, second;
  [[nodiscard]] bool ofItems() const { return firstLevel == 0 && secondLevel == 0; }
};

/// Calls visit(lane of first, lane of second) for what may meet in a pair of blocks.
template <class Visit>
void visitLanes(const BoundsSearch& search, const BlockPair& pair, const Visit& visit) {
  std::uint64_t near =
      mayMeet(search.first->block(pair.firstLevel, pair.first),
              search.second->block(pair.secondLevel, pair.second), search.squaredReach,
              search.first->isStill() && search.second->isStill());
  if (search.same() && pair.firstLevel == pair.secondLevel && pair.first == pair.second) {
    constexpr std::uint64_t kNotBelow = 0x80C0E0F0F8FCFEFFU;  // j >= i of bits 8 i + j
    constexpr std::uint64_t kItself = 0x8040201008040201U;
    near &= pair.ofItems() ? kNotBelow & ~kItself : kNotBelow;
  }
  for (; near != 0; near &= near - 1) {
    const int bit = std::countr_zero(near);
    visit(bit / BoundsBlock::kLanes, bit % BoundsBlock::kLanes);
  }
}

/// Appends the pairs among the children of the higher block and the other one, or its children if
/// they are of one level.
void openBlocks(const BoundsSearch& search, const BlockPair& pair, std::vector<BlockPair>& opened);

/// Enough pairs of blocks to share out; which they are does not depend on threads.
[[nodiscard]] std::vector<BlockPair> blocksToShareOut(const BoundsSearch& search);

/// Calls visit(item of first, item of second) for all below a pair of blocks that may meet.
template <class Visit>
void visitItems(const BoundsSearch& search, const BlockPair& from, const Visit& visit) {
  constexpr int kLanes = BoundsBlock::kLanes;
  std::vector<BlockPair> waiting = {from};
  while (!waiting.empty()) {
    const BlockPair pair = waiting.back();
    waiting.pop_back();
    if (!pair.ofItems()) {
      openBlocks(search, pair, waiting);
      continue;
    }
    visitLanes(search, pair, [&](int i, int j) {
      visit(search.first->item(kLanes * pair.first + i),
            search.second->item(kLanes * pair.second + j));
    });
  }
}

}  // namespace explica::geometry
