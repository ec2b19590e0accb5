// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Growth.h"

#include "MoveTogether.h"
#include "Turns.h"

#include <cstdint>

namespace explica::surface {
namespace {

/// All vertices, then one half and the other, then quarters, at the end eighths: what stood in each
/// other's way going together may pass going one after another.
constexpr int kSweeps = 7, kLastSweeps = 15;

bool takesTurn(std::int32_t v, int sweep) {
  const std::uint32_t mixed = mixedBits(v);
  if (sweep == 0) return true;
  if (sweep < 3) return (mixed & 1U) == static_cast<std::uint32_t>(sweep - 1);
  if (sweep < 7) return (mixed >> 1 & 3U) == static_cast<std::uint32_t>(sweep - 3);
  return (mixed >> 3 & 7U) == static_cast<std::uint32_t>(sweep - 7);
}

}  // namespace

Growth::Growth(const TriangleMesh& white, const std::vector<Trajectory>& paths)
    : mesh_(white), paths_(paths), lengths_(paths.size()), reached_(paths.size(), 0.0) {
  for (std::size_t v = 0; v < paths.size(); ++v) lengths_[v] = paths[v].length();
  for (Eigen::Index v = 0; v < mesh_.vertexCount(); ++v) {
    mesh_.positions.row(v) = asStored(mesh_.positions.row(v));
  }
}

void Growth::goTo(double share) {
  constexpr int kWays = 2;
  share_ = share;
  const auto target = [&](std::int32_t v) { return share * lengths_[v]; };
  const auto arcAt = [&](std::int32_t v, int way) {
    return way == 0 ? target(v) : 0.5 * (reached_[v] + target(v));
  };
  std::vector<std::int32_t> waiting;
  for (int sweep = 0; sweep < (share < 1 ? kSweeps : kLastSweeps); ++sweep) {
    waiting.clear();
    bool any = false;
    for (std::int32_t v = 0; v < static_cast<std::int32_t>(paths_.size()); ++v) {
      if (reached_[v] >= target(v)) continue;
      any = true;
      if (takesTurn(v, sweep)) waiting.push_back(v);
    }
    if (!any) return;
    const std::vector<std::uint8_t> way =
        moveTogether(mesh_, search_, waiting, kWays,
                     [&](std::int32_t v, int attempt) { return paths_[v].at(arcAt(v, attempt)); });
    for (std::size_t n = 0; n < waiting.size(); ++n) {
      if (way[n] < kWays) reached_[waiting[n]] = arcAt(waiting[n], way[n]);
    }
  }
}

}  // namespace explica::surface
