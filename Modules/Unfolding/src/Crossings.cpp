// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Unfolding/Crossings.h"

#include <algorithm>

namespace explica::unfolding {
namespace {

using geometry::FacePair;

std::vector<bool> movedFaces(const UnfoldResult& result) {
  std::vector<bool> moved(static_cast<std::size_t>(result.mesh.faceCount()), false);
  for (const std::int32_t f : result.region.faces) moved[f] = true;
  for (const std::int32_t f : result.collar) moved[f] = true;
  return moved;
}

std::size_t countNew(std::span<const FacePair> after, std::span<const FacePair> before) {
  return static_cast<std::size_t>(std::count_if(after.begin(), after.end(), [&](const auto& pair) {
    return !std::binary_search(before.begin(), before.end(), pair);
  }));
}

/// A detached patch beside the surface that it was cut from, whose rim stays where it was.
CrossingAccount countDetached(const TriangleMesh& original, const Region& region,
                              const UnfoldResult& result, std::span<const FacePair> before) {
  TriangleMesh both = original;
  const Eigen::Index count = original.vertexCount();
  both.positions.conservativeResize(2 * count, 3);
  both.positions.bottomRows(count) = result.mesh.positions;
  std::vector<bool> moved(static_cast<std::size_t>(original.faceCount()), false);
  for (const std::int32_t f : region.faces) {
    moved[f] = true;
    both.faces.row(f).array() += static_cast<std::int32_t>(count);
  }
  CrossingAccount account;
  std::vector<FacePair> within;
  for (const FacePair& pair : geometry::findSelfIntersections(both, moved)) {
    if (moved[pair[0]] && moved[pair[1]]) {
      within.push_back(pair);
    } else {
      ++account.withRest;
    }
  }
  account.added = countNew(within, before);
  for (FacePair pair : within) {
    for (std::int32_t& f : pair) {
      const auto at = std::lower_bound(region.faces.begin(), region.faces.end(), f);
      f = static_cast<std::int32_t>(at - region.faces.begin());
    }
    account.after.push_back(pair);
  }
  return account;
}

}  // namespace

CrossingAccount countCrossings(const TriangleMesh& original, const Region& region,
                               const UnfoldResult& result, std::span<const FacePair> before) {
  if (result.mesh.faceCount() != original.faceCount()) {
    return countDetached(original, region, result, before);
  }
  const std::vector<bool> moved = movedFaces(result);
  CrossingAccount account;
  account.after = geometry::findSelfIntersections(result.mesh, moved, before);
  account.added = countNew(account.after, before);
  account.withRest = static_cast<std::size_t>(
      std::count_if(account.after.begin(), account.after.end(),
                    [&](const FacePair& pair) { return moved[pair[0]] != moved[pair[1]]; }));
  return account;
}

}  // namespace explica::unfolding
