// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Freudenthal.h"

#include <bitset>

namespace explica::surface {
namespace {

constexpr unsigned kAll = (1u << kNeighbours) - 1;  // a bit each

/// Bit sets of the link's edges: neighbours a and b are joined if the step between them is a step.
std::array<unsigned, kNeighbours> linkEdges() {
  std::array<unsigned, kNeighbours> joined{};
  for (int a = 0; a < kNeighbours; ++a) {
    for (int b = 0; b < kNeighbours; ++b) {
      const std::array<int, 3> between = {kSteps[b][0] - kSteps[a][0], kSteps[b][1] - kSteps[a][1],
                                          kSteps[b][2] - kSteps[a][2]};
      for (const auto& step : kSteps) {
        if (step == between) joined[a] |= 1u << b;
      }
    }
  }
  return joined;
}

bool isOnePiece(unsigned set, const std::array<unsigned, kNeighbours>& joined) {
  if (set == 0) return false;
  unsigned reached = set & (~set + 1);
  for (unsigned before = 0; before != reached;) {
    before = reached;
    for (int n = 0; n < kNeighbours; ++n) {
      if (reached >> n & 1u) reached |= joined[n] & set;
    }
  }
  return reached == set;
}

}  // namespace

bool isSimple(Neighbourhood foreground) {
  static const std::bitset<kAll + 1> table = [] {
    const auto joined = linkEdges();
    std::bitset<kAll + 1> simple;
    for (unsigned set = 0; set <= kAll; ++set) {
      simple[set] = isOnePiece(set, joined) && isOnePiece(~set & kAll, joined);
    }
    return simple;
  }();
  return table[foreground & kAll];
}

}  // namespace explica::surface
