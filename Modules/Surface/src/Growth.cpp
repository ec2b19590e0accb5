// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Growth.h"

namespace explica::surface {

Growth::Growth(const TriangleMesh& white, const std::vector<Trajectory>& paths, double edge)
    : mesh_(white, edge), paths_(paths), reached_(paths.size(), 0.0) {}

void Growth::goTo(double share) {
  constexpr int kSweeps = 3;
  share_ = share;
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    const auto waiting = mesh_.sweep([&](std::int32_t v, GuardedMesh::Scratch& scratch) {
      const double target = share * paths_[v].length();
      if (reached_[v] >= target || tryReach(v, target, scratch)) return true;
      tryReach(v, 0.5 * (reached_[v] + target), scratch);
      return false;
    });
    if (waiting == 0) return;
  }
}

bool Growth::tryReach(std::int32_t v, double arc, GuardedMesh::Scratch& scratch) {
  if (!mesh_.move(v, paths_[v].at(arc), scratch)) return false;
  reached_[v] = arc;
  return true;
}

}  // namespace explica::surface
