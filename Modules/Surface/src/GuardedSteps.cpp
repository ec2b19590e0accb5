// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

// What a GuardedMesh does: moves, collapses, flips and splits.

#include "GuardedMesh.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

namespace explica::surface {
namespace {

double qualityOf(const std::array<Point, 3>& p) {
  const double squares =
      (p[1] - p[0]).squaredNorm() + (p[2] - p[1]).squaredNorm() + (p[0] - p[2]).squaredNorm();
  return 2 * std::sqrt(3.0) * (p[1] - p[0]).cross(p[2] - p[0]).norm() / squares;
}

}  // namespace

std::int32_t GuardedMesh::addFace(const Corners& corners, Scratch& scratch) {
  std::int32_t f;
  if (scratch.freeFaces.empty()) {
    f = faceSlots();
    faces_.emplace_back();
    boxes_.emplace_back();
  } else {
    f = scratch.freeFaces.back();
    scratch.freeFaces.pop_back();
  }
  faces_[f] = corners;
  boxes_[f] =
      roomy(boxOf({positions_[corners[0]], positions_[corners[1]], positions_[corners[2]]}));
  for (const std::int32_t v : corners) vertexFaces_[v].add(f);
  enter(f);
  ++scratch.facesAdded;
  return f;
}

void GuardedMesh::removeFace(std::int32_t f, Scratch& scratch) {
  leave(f);
  for (const std::int32_t v : faces_[f]) vertexFaces_[v].remove(f);
  faces_[f] = {-1, -1, -1};
  scratch.freeFaces.push_back(f);
  --scratch.facesAdded;
}

bool GuardedMesh::move(std::int32_t v, const Point& to) {
  return move(v, to, scratch());
}

bool GuardedMesh::move(std::int32_t v, const Point& wanted, Scratch& scratch) {
  const Point to = asStored(wanted);
  const auto& ring = vertexFaces_[v];
  if (ring.size() > kMostFaces) return false;
  std::array<Placed, kMostFaces> made;
  for (std::size_t k = 0; k < ring.size(); ++k) made[k] = place(faces_[ring[k]], v, to);
  if (!admissible({made.data(), ring.size()}, {ring.begin(), ring.size()}, scratch)) return false;
  positions_[v] = to;
  for (std::size_t k = 0; k < ring.size(); ++k) {
    rebox(ring[k], made[k].box);
  }
  return true;
}

bool GuardedMesh::keepsTopology(std::int32_t u, std::int32_t v) const {
  if (vertexFaces_[u].size() + vertexFaces_[v].size() > kMostFaces) return false;
  const bool rimEdge = open_ && (opposite(u, v) < 0 || opposite(v, u) < 0);
  const bool rimU = onRim(u), rimV = onRim(v);
  if (rimU && rimV && !rimEdge) return false;
  // Link condition: the ends have exactly the corners that face the edge in common.
  std::array<std::int32_t, kMostFaces + 1> around;
  std::size_t aroundCount = 0;
  for (const std::int32_t f : vertexFaces_[u]) {
    for (const std::int32_t w : faces_[f]) {
      if (w != u && w != v &&
          std::find(around.begin(), around.begin() + aroundCount, w) ==
              around.begin() + aroundCount) {
        around[aroundCount++] = w;
      }
    }
  }
  int common = 0;
  for (std::size_t n = 0; n < aroundCount; ++n) {
    if (!areJoined(v, around[n])) continue;
    ++common;
    if (rimEdge && valence(around[n]) < 2) return false;
  }
  const std::size_t fewest = rimEdge ? 4 : (rimU || rimV ? 6 : 8);
  return common == (rimEdge ? 1 : 2) && valence(u) + valence(v) >= fewest;
}

bool GuardedMesh::collapse(std::int32_t u, std::int32_t v, const Point& to,
                           const CollapseLimits& limits) {
  return collapse(u, v, to, limits, scratch());
}

bool GuardedMesh::plan(std::int32_t u, std::int32_t v, const Point& wanted,
                       const CollapseLimits& limits, Scratch& scratch, Step& step) const {
  if (!keepsTopology(u, v)) return false;
  step.to = asStored(wanted);
  if (onRim(u) != onRim(v)) step.to = positions_[onRim(u) ? u : v];

  const auto take = [&](std::int32_t f, std::int32_t from) {
    Corners c = faces_[f];
    step.removed[step.removedCount++] = f;
    bool both = false;
    for (std::int32_t& w : c) {
      if (w == (from == u ? v : u)) both = true;
      if (w == u) w = v;
    }
    if (both) return true;
    const Placed placed = place(c, v, step.to);
    const auto& p = placed.points;
    const Vector before = normalOf(f), after = (p[1] - p[0]).cross(p[2] - p[0]);
    const double sizeBefore = before.norm(), sizeAfter = after.norm();
    if (before.dot(after) < limits.leastCosine * sizeBefore * sizeAfter) return false;
    if (sizeAfter < 2 * limits.leastArea && sizeAfter <= sizeBefore) return false;
    if (qualityOf(p) < limits.leastQuality) return false;
    const double most = limits.longestEdge * limits.longestEdge;
    for (int k = 0; k < 3; ++k) {
      if (c[k] != v && c[(k + 1) % 3] != v) continue;
      if ((p[k] - p[(k + 1) % 3]).squaredNorm() > most) return false;
    }
    step.made[step.madeCount++] = placed;
    return true;
  };
  for (const std::int32_t f : vertexFaces_[u]) {
    if (!take(f, u)) return false;
  }
  for (const std::int32_t f : vertexFaces_[v]) {
    const Corners& c = faces_[f];
    if (c[0] == u || c[1] == u || c[2] == u) continue;
    if (!take(f, v)) return false;
  }
  return admissible({step.made.data(), step.madeCount}, {step.removed.data(), step.removedCount},
                    scratch);
}

void GuardedMesh::replaceFaces(const Step& step, Scratch& scratch) {
  for (std::size_t k = 0; k < step.removedCount; ++k) removeFace(step.removed[k], scratch);
  for (std::size_t k = 0; k < step.madeCount; ++k) addFace(step.made[k].corners, scratch);
}

bool GuardedMesh::collapse(std::int32_t u, std::int32_t v, const Point& to,
                           const CollapseLimits& limits, Scratch& scratch) {
  Step step;
  if (!plan(u, v, to, limits, scratch, step)) return false;
  positions_[v] = step.to;
  replaceFaces(step, scratch);
  scratch.freeVertices.push_back(u);
  return true;
}

bool GuardedMesh::mayCollapse(std::int32_t u, std::int32_t v, const Point& to,
                              const CollapseLimits& limits) {
  Step step;
  return plan(u, v, to, limits, scratch(), step);
}

bool GuardedMesh::flip(std::int32_t a, std::int32_t b) {
  return flip(a, b, scratch());
}

bool GuardedMesh::flip(std::int32_t a, std::int32_t b, Scratch& scratch) {
  const std::int32_t c = opposite(a, b), d = opposite(b, a);
  if (c < 0 || d < 0 || c == d || areJoined(c, d)) return false;
  if (valence(a) <= 3 || valence(b) <= 3) return false;
  std::array<std::int32_t, 2> removed = {-1, -1};
  int found = 0;
  for (const std::int32_t f : vertexFaces_[a]) {
    const Corners& corners = faces_[f];
    if (corners[0] == b || corners[1] == b || corners[2] == b) removed[found++] = f;
  }
  const std::array<Placed, 2> made = {place({a, d, c}, -1, {}), place({d, b, c}, -1, {})};
  if (!admissible(made, removed, scratch)) return false;
  for (const std::int32_t f : removed) removeFace(f, scratch);
  for (const Placed& m : made) addFace(m.corners, scratch);
  return true;
}

bool GuardedMesh::planSplit(std::int32_t a, std::int32_t b, std::int32_t m, Step& step) {
  const std::int32_t c = opposite(a, b), d = opposite(b, a);
  if ((c < 0 || d < 0) && !(open_ && (c >= 0 || d >= 0))) return false;
  step.to = asStored(0.5 * (positions_[a] + positions_[b]));
  for (const std::int32_t f : vertexFaces_[a]) {
    const Corners& corners = faces_[f];
    if (corners[0] == b || corners[1] == b || corners[2] == b) {
      step.removed[step.removedCount++] = f;
    }
  }
  const auto make = [&](const Corners& corners) {
    step.made[step.madeCount++] = place(corners, m, step.to);
  };
  if (c >= 0) {
    make({a, m, c});
    make({m, b, c});
  }
  if (d >= 0) {
    make({b, m, d});
    make({m, a, d});
  }
  return admissible({step.made.data(), step.madeCount}, {step.removed.data(), step.removedCount},
                    scratch());
}

std::int32_t GuardedMesh::split(std::int32_t a, std::int32_t b) {
  const bool reused = !scratch_.freeVertices.empty();
  const std::int32_t m = reused ? scratch_.freeVertices.back() : vertexSlots();
  Step step;
  if (!planSplit(a, b, m, step)) return -1;
  if (reused) {
    scratch_.freeVertices.pop_back();
  } else {
    positions_.emplace_back();
    vertexFaces_.emplace_back();
  }
  positions_[m] = step.to;
  replaceFaces(step, scratch_);
  return m;
}

bool GuardedMesh::maySplit(std::int32_t a, std::int32_t b) {
  Step step;
  return planSplit(a, b, vertexSlots(), step);
}

}  // namespace explica::surface
