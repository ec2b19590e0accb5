// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Geometry/BoundsSearch.h"

#include <algorithm>
#include <utility>

namespace explica::geometry {

void openBlocks(const BoundsSearch& search, const BlockPair& pair, std::vector<BlockPair>& opened) {
  constexpr int kLanes = BoundsBlock::kLanes;
  if (pair.firstLevel == pair.secondLevel) {
    visitLanes(search, pair, [&](int i, int j) {
      opened.push_back({pair.firstLevel - 1, pair.secondLevel - 1, kLanes * pair.first + i,
                        kLanes * pair.second + j});
    });
    return;
  }
  const bool firstOpens = pair.firstLevel > pair.secondLevel;
  unsigned seen = 0;
  visitLanes(search, pair, [&](int i, int j) { seen |= 1U << (firstOpens ? i : j); });
  for (; seen != 0; seen &= seen - 1) {
    BlockPair child = pair;
    (firstOpens ? child.firstLevel : child.secondLevel) -= 1;
    std::int32_t& block = firstOpens ? child.first : child.second;
    block = kLanes * block + std::countr_zero(seen);
    opened.push_back(child);
  }
}

std::vector<BlockPair> blocksToShareOut(const BoundsSearch& search) {
  constexpr std::size_t kEnough = 256;
  if (search.first->levelCount() == 0 || search.second->levelCount() == 0) return {};
  std::vector<BlockPair> pairs = {
      {search.first->levelCount() - 1, search.second->levelCount() - 1, 0, 0}};
  while (pairs.size() < kEnough &&
         std::ranges::any_of(pairs, [](const auto& p) { return !p.ofItems(); })) {
    std::vector<BlockPair> opened;
    for (const BlockPair& pair : pairs) {
      if (pair.ofItems()) {
        opened.push_back(pair);
      } else {
        openBlocks(search, pair, opened);
      }
    }
    pairs = std::move(opened);
  }
  return pairs;
}

}  // namespace explica::geometry
