// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "GuardedMesh.h"

#include "Explica/Core/Parallel.h"
#include "Explica/Geometry/Predicates.h"
#include "Explica/Geometry/TriangleIntersection.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

namespace explica::surface {
namespace {

constexpr std::size_t kMostFaces = 64;  ///< made by one step; a step that makes more is refused

std::array<float, 6> boxOf(const std::array<Point, 3>& p) {
  std::array<float, 6> box;
  for (int a = 0; a < 3; ++a) {
    const double low = std::min({p[0][a], p[1][a], p[2][a]});
    const double high = std::max({p[0][a], p[1][a], p[2][a]});
    // Outward by more than the rounding to float.
    box[a] = static_cast<float>(low - 1e-6 * (1 + std::abs(low)));
    box[a + 3] = static_cast<float>(high + 1e-6 * (1 + std::abs(high)));
  }
  return box;
}

bool overlap(const std::array<float, 6>& a, const std::array<float, 6>& b) {
  return a[0] <= b[3] && b[0] <= a[3] && a[1] <= b[4] && b[1] <= a[4] && a[2] <= b[5] &&
         b[2] <= a[5];
}

void erase(std::vector<std::int32_t>& list, std::int32_t value) {
  const auto it = std::find(list.begin(), list.end(), value);
  if (it == list.end()) return;
  *it = list.back();
  list.pop_back();
}

/// Faces f and g, given by corners and points, meet where they may not.
bool facesMeet(const GuardedMesh::Corners& fc, const std::array<Point, 3>& fp,
               const GuardedMesh::Corners& gc, const std::array<Point, 3>& gp) {
  std::array<int, 3> ofF = {0, 1, 2}, ofG = {0, 1, 2};
  int shared = 0;
  for (int i = 0; i < 3; ++i) {
    for (int j = shared; j < 3; ++j) {
      if (fc[i] == gc[ofG[j]]) {
        std::swap(ofF[i], ofF[shared]);
        std::swap(ofG[j], ofG[shared]);
        ++shared;
        break;
      }
    }
  }
  using namespace geometry;
  switch (shared) {
    case 0:
      return trianglesIntersect(fp, gp);
    case 1: {
      // Strictly on one side of the other's plane but for the common vertex: nothing else meets.
      const Point &p = fp[ofF[0]], &a = fp[ofF[1]], &b = fp[ofF[2]];
      const Point &c = gp[ofG[1]], &d = gp[ofG[2]];
      if (orientation(p, a, b, c) * orientation(p, a, b, d) > 0) return false;
      return trianglesSharingVertexIntersect(p, a, b, c, d);
    }
    case 2:
      return trianglesSharingEdgeIntersect(fp[ofF[0]], fp[ofF[1]], fp[ofF[2]], gp[ofG[2]]);
    default:
      return true;
  }
}

/// Files hold float32: what is checked must be what is written.
Point asStored(const Point& p) {
  Point stored;
  for (int a = 0; a < 3; ++a) {
    // Volatile: GCC 12 at -O3 takes the way to float and back for nothing when it joins two
    // components into one vector.
    const volatile float rounded = static_cast<float>(p[a]);
    stored[a] = rounded;
  }
  return stored;
}

double qualityOf(const std::array<Point, 3>& p) {
  const double squares =
      (p[1] - p[0]).squaredNorm() + (p[2] - p[1]).squaredNorm() + (p[0] - p[2]).squaredNorm();
  return 2 * std::sqrt(3.0) * (p[1] - p[0]).cross(p[2] - p[0]).norm() / squares;
}

}  // namespace

GuardedMesh::GuardedMesh(const TriangleMesh& mesh, double cell)
    : positions_(mesh.vertexCount()), vertexFaces_(mesh.vertexCount()), cellsPerMm_(1 / cell) {
  Point low = Point::Constant(kInfinity), high = Point::Constant(-kInfinity);
  for (Eigen::Index v = 0; v < mesh.vertexCount(); ++v) {
    positions_[v] = asStored(mesh.positions.row(v));
    low = low.cwiseMin(positions_[v]);
    high = high.cwiseMax(positions_[v]);
  }
  // Points beyond the cells fall to the outermost ones.
  constexpr double kMargin = 4;  // mm
  constexpr int kMostCells = 512;
  cellOrigin_ = low - Point::Constant(kMargin);
  for (int a = 0; a < 3; ++a) {
    cellSize_[a] = std::clamp(static_cast<int>((high[a] - low[a] + 2 * kMargin) * cellsPerMm_) + 1,
                              1, kMostCells);
  }
  cells_.resize(static_cast<std::size_t>(cellSize_[0]) * cellSize_[1] * cellSize_[2]);
  faces_.reserve(mesh.faceCount());
  boxes_.reserve(mesh.faceCount());
  for (Eigen::Index f = 0; f < mesh.faceCount(); ++f) {
    addFace({mesh.faces(f, 0), mesh.faces(f, 1), mesh.faces(f, 2)});
  }
}

Vector GuardedMesh::normalOf(std::int32_t f) const {
  const Corners& c = faces_[f];
  return (positions_[c[1]] - positions_[c[0]]).cross(positions_[c[2]] - positions_[c[0]]);
}

std::int32_t GuardedMesh::opposite(std::int32_t a, std::int32_t b) const {
  for (const std::int32_t f : vertexFaces_[a]) {
    const Corners& c = faces_[f];
    for (int k = 0; k < 3; ++k) {
      if (c[k] == a && c[(k + 1) % 3] == b) return c[(k + 2) % 3];
    }
  }
  return -1;
}

bool GuardedMesh::areJoined(std::int32_t a, std::int32_t b) const {
  for (const std::int32_t f : vertexFaces_[a]) {
    const Corners& c = faces_[f];
    if (c[0] == b || c[1] == b || c[2] == b) return true;
  }
  return false;
}

GuardedMesh::Placed GuardedMesh::place(const Corners& corners, std::int32_t moved,
                                       const Point& to) const {
  Placed placed;
  placed.corners = corners;
  for (int k = 0; k < 3; ++k) placed.points[k] = corners[k] == moved ? to : positions_[corners[k]];
  placed.box = boxOf(placed.points);
  return placed;
}

GuardedMesh::CellRange GuardedMesh::cellsOf(const std::array<float, 6>& box) const {
  CellRange range;
  for (int a = 0; a < 3; ++a) {
    for (int end = 0; end < 2; ++end) {
      const double cell = std::floor((box[a + 3 * end] - cellOrigin_[a]) * cellsPerMm_);
      range[a + 3 * end] = static_cast<int>(std::clamp(cell, 0.0, cellSize_[a] - 1.0));
    }
  }
  return range;
}

void GuardedMesh::enter(std::int32_t f) {
  const CellRange r = cellsOf(boxes_[f]);
  for (int k = r[2]; k <= r[5]; ++k) {
    for (int j = r[1]; j <= r[4]; ++j) {
      for (int i = r[0]; i <= r[3]; ++i) {
        cells_[i + static_cast<std::size_t>(cellSize_[0]) *
                       (j + static_cast<std::size_t>(cellSize_[1]) * k)]
            .push_back(f);
      }
    }
  }
}

void GuardedMesh::leave(std::int32_t f) {
  const CellRange r = cellsOf(boxes_[f]);
  for (int k = r[2]; k <= r[5]; ++k) {
    for (int j = r[1]; j <= r[4]; ++j) {
      for (int i = r[0]; i <= r[3]; ++i) {
        erase(cells_[i + static_cast<std::size_t>(cellSize_[0]) *
                             (j + static_cast<std::size_t>(cellSize_[1]) * k)],
              f);
      }
    }
  }
}

std::int32_t GuardedMesh::addFace(const Corners& corners) {
  std::int32_t f;
  if (freeFaces_.empty()) {
    f = faceSlots();
    faces_.emplace_back();
    boxes_.emplace_back();
    scratch_.stamp.push_back(0);
  } else {
    f = freeFaces_.back();
    freeFaces_.pop_back();
  }
  faces_[f] = corners;
  boxes_[f] = boxOf({positions_[corners[0]], positions_[corners[1]], positions_[corners[2]]});
  for (const std::int32_t v : corners) vertexFaces_[v].push_back(f);
  enter(f);
  ++faceCount_;
  return f;
}

void GuardedMesh::removeFace(std::int32_t f) {
  leave(f);
  for (const std::int32_t v : faces_[f]) erase(vertexFaces_[v], f);
  faces_[f] = {-1, -1, -1};
  freeFaces_.push_back(f);
  --faceCount_;
}

bool GuardedMesh::admissible(std::span<const Placed> made, std::span<const std::int32_t> removed,
                             Scratch& scratch) const {
  std::array<float, 6> all = made[0].box;
  for (const Placed& m : made) {
    for (int a = 0; a < 3; ++a) {
      all[a] = std::min(all[a], m.box[a]);
      all[a + 3] = std::max(all[a + 3], m.box[a + 3]);
    }
  }
  for (std::size_t m = 0; m < made.size(); ++m) {
    for (std::size_t n = m + 1; n < made.size(); ++n) {
      if (facesMeet(made[m].corners, made[m].points, made[n].corners, made[n].points)) return false;
    }
  }
  const CellRange r = cellsOf(all);
  if (r[scratch.axis] < scratch.lowCell || r[scratch.axis + 3] > scratch.highCell) {
    scratch.leftZone = true;
    return false;
  }
  if (scratch.stamp.size() < faces_.size()) scratch.stamp.resize(faces_.size(), 0);
  const std::uint32_t query = ++scratch.query;
  for (const std::int32_t f : removed) scratch.stamp[f] = query;
  for (int k = r[2]; k <= r[5]; ++k) {
    for (int j = r[1]; j <= r[4]; ++j) {
      for (int i = r[0]; i <= r[3]; ++i) {
        for (const std::int32_t g :
             cells_[i + static_cast<std::size_t>(cellSize_[0]) *
                            (j + static_cast<std::size_t>(cellSize_[1]) * k)]) {
          if (scratch.stamp[g] == query) continue;
          scratch.stamp[g] = query;
          if (!overlap(all, boxes_[g])) continue;
          for (const Placed& m : made) {
            if (!overlap(m.box, boxes_[g])) continue;
            const Corners& c = faces_[g];
            if (facesMeet(m.corners, m.points, c,
                          {positions_[c[0]], positions_[c[1]], positions_[c[2]]})) {
              return false;
            }
          }
        }
      }
    }
  }
  return true;
}

bool GuardedMesh::move(std::int32_t v, const Point& to) {
  return move(v, to, scratch_);
}

bool GuardedMesh::move(std::int32_t v, const Point& wanted, Scratch& scratch) {
  const Point to = asStored(wanted);
  const auto& ring = vertexFaces_[v];
  if (ring.size() > kMostFaces) return false;
  std::array<Placed, kMostFaces> made;
  for (std::size_t k = 0; k < ring.size(); ++k) made[k] = place(faces_[ring[k]], v, to);
  if (!admissible({made.data(), ring.size()}, ring, scratch)) return false;
  positions_[v] = to;
  for (std::size_t k = 0; k < ring.size(); ++k) {
    if (cellsOf(made[k].box) == cellsOf(boxes_[ring[k]])) {
      boxes_[ring[k]] = made[k].box;
    } else {
      leave(ring[k]);
      boxes_[ring[k]] = made[k].box;
      enter(ring[k]);
    }
  }
  return true;
}

bool GuardedMesh::collapse(std::int32_t u, std::int32_t v, const Point& wanted,
                           const CollapseLimits& limits) {
  const Point to = asStored(wanted);
  std::array<std::int32_t, 2 * kMostFaces> removed;
  std::array<Placed, kMostFaces> made;
  std::size_t removedCount = 0, madeCount = 0;
  if (vertexFaces_[u].size() + vertexFaces_[v].size() > kMostFaces) return false;
  // Link condition: the ends have exactly two neighbours in common.
  std::array<std::int32_t, kMostFaces> around;
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
  for (std::size_t n = 0; n < aroundCount; ++n) common += areJoined(v, around[n]);
  if (common != 2 || vertexFaces_[u].size() + vertexFaces_[v].size() < 8) return false;

  const auto take = [&](std::int32_t f, std::int32_t from) {
    Corners c = faces_[f];
    removed[removedCount++] = f;
    bool both = false;
    for (std::int32_t& w : c) {
      if (w == (from == u ? v : u)) both = true;
      if (w == u) w = v;
    }
    if (both) return true;
    const Placed placed = place(c, v, to);
    const auto& p = placed.points;
    const Vector before = normalOf(f), after = (p[1] - p[0]).cross(p[2] - p[0]);
    if (before.dot(after) < limits.leastCosine * before.norm() * after.norm()) return false;
    if (qualityOf(p) < limits.leastQuality) return false;
    const double most = limits.longestEdge * limits.longestEdge;
    for (int k = 0; k < 3; ++k) {
      if (c[k] != v && c[(k + 1) % 3] != v) continue;
      if ((p[k] - p[(k + 1) % 3]).squaredNorm() > most) return false;
    }
    made[madeCount++] = placed;
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
  if (!admissible({made.data(), madeCount}, {removed.data(), removedCount}, scratch_)) return false;
  for (std::size_t k = 0; k < removedCount; ++k) removeFace(removed[k]);
  positions_[v] = to;
  for (std::size_t k = 0; k < madeCount; ++k) addFace(made[k].corners);
  freeVertices_.push_back(u);
  return true;
}

bool GuardedMesh::flip(std::int32_t a, std::int32_t b) {
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
  if (!admissible(made, removed, scratch_)) return false;
  for (const std::int32_t f : removed) removeFace(f);
  for (const Placed& m : made) addFace(m.corners);
  return true;
}

std::int32_t GuardedMesh::split(std::int32_t a, std::int32_t b) {
  const std::int32_t c = opposite(a, b), d = opposite(b, a);
  if (c < 0 || d < 0) return -1;
  std::int32_t m;
  if (freeVertices_.empty()) {
    m = vertexSlots();
    positions_.emplace_back();
    vertexFaces_.emplace_back();
  } else {
    m = freeVertices_.back();
    freeVertices_.pop_back();
  }
  positions_[m] = asStored(0.5 * (positions_[a] + positions_[b]));
  std::array<std::int32_t, 2> removed = {-1, -1};
  int found = 0;
  for (const std::int32_t f : vertexFaces_[a]) {
    const Corners& corners = faces_[f];
    if (corners[0] == b || corners[1] == b || corners[2] == b) removed[found++] = f;
  }
  const std::array<Placed, 4> made = {place({a, m, c}, -1, {}), place({m, b, c}, -1, {}),
                                      place({b, m, d}, -1, {}), place({m, a, d}, -1, {})};
  if (!admissible(made, removed, scratch_)) {
    freeVertices_.push_back(m);
    return -1;
  }
  for (const std::int32_t f : removed) removeFace(f);
  for (const Placed& p : made) addFace(p.corners);
  return m;
}

bool GuardedMesh::inZone(std::int32_t v, const Scratch& scratch) const {
  for (const std::int32_t f : vertexFaces_[v]) {
    const CellRange r = cellsOf(boxes_[f]);
    if (r[scratch.axis] < scratch.lowCell || r[scratch.axis + 3] > scratch.highCell) return false;
  }
  return true;
}

std::int64_t GuardedMesh::sweep(const std::function<bool(std::int32_t, Scratch&)>& step) {
  constexpr double kSlab = 8;  // mm: several faces, so that few vertices must wait for the end
  const int axis =
      static_cast<int>(std::max_element(cellSize_.begin(), cellSize_.end()) - cellSize_.begin());
  const int half = std::max(4, static_cast<int>(std::ceil(0.5 * kSlab * cellsPerMm_)));
  const int width = 2 * half;
  const int slabs = (cellSize_[axis] + width - 1) / width;
  std::vector<std::vector<std::int32_t>> members(slabs), late(slabs);
  for (std::int32_t v = 0; v < vertexSlots(); ++v) {
    if (!hasVertex(v)) continue;
    const double cell = std::floor((positions_[v][axis] - cellOrigin_[axis]) * cellsPerMm_);
    members[static_cast<int>(std::clamp(cell, 0.0, cellSize_[axis] - 1.0)) / width].push_back(v);
  }
  std::vector<std::int64_t> refused(slabs, 0);
  slabScratch_.resize(slabs);
  for (const int parity : {0, 1}) {
    parallelFor((slabs + 1 - parity) / 2, 1, [&](std::size_t pair) {
      const int slab = static_cast<int>(2 * pair) + parity;
      Scratch& scratch = slabScratch_[slab];
      scratch.axis = axis;
      // Zones of slabs worked on together touch, but do not overlap.
      scratch.lowCell = slab * width - half;
      scratch.highCell = (slab + 1) * width + half - 1;
      for (const std::int32_t v : members[slab]) {
        scratch.leftZone = !inZone(v, scratch);
        if (!scratch.leftZone && step(v, scratch)) continue;
        if (scratch.leftZone) {
          late[slab].push_back(v);
        } else {
          ++refused[slab];
        }
      }
    });
  }
  std::int64_t sum = 0;
  for (int slab = 0; slab < slabs; ++slab) {
    for (const std::int32_t v : late[slab]) sum += !step(v, scratch_);
    sum += refused[slab];
  }
  return sum;
}

TriangleMesh GuardedMesh::toMesh() const {
  TriangleMesh mesh;
  std::vector<std::int32_t> number(positions_.size(), -1);
  std::int32_t vertices = 0;
  for (std::int32_t v = 0; v < vertexSlots(); ++v) {
    if (hasVertex(v)) number[v] = vertices++;
  }
  mesh.positions.resize(vertices, 3);
  for (std::int32_t v = 0; v < vertexSlots(); ++v) {
    if (number[v] >= 0) mesh.positions.row(number[v]) = positions_[v];
  }
  mesh.faces.resize(faceCount_, 3);
  Eigen::Index row = 0;
  for (const Corners& c : faces_) {
    if (c[0] < 0) continue;
    for (int k = 0; k < 3; ++k) mesh.faces(row, k) = number[c[k]];
    ++row;
  }
  return mesh;
}

}  // namespace explica::surface
