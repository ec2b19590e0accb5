// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "GuardedMesh.h"

#include "Explica/Geometry/MeshTopology.h"
#include "Explica/Geometry/Predicates.h"
#include "Explica/Geometry/TriangleIntersection.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

namespace explica::surface {
namespace {

/// Rounding of a projection, relative to the sizes of what is multiplied; with room to spare.
constexpr double kClear = 1e-12;

/// True if the plane across the line between their centroids parts two triangles beyond doubt.
bool clearlyApart(const std::array<Point, 3>& f, const std::array<Point, 3>& g) {
  const Vector axis = (g[0] - f[0]) + (g[1] - f[1]) + (g[2] - f[2]);
  double highest = 0, lowest = kInfinity, size = 0;
  for (int k = 0; k < 3; ++k) {
    const Vector ofF = f[k] - f[0], ofG = g[k] - f[0];
    highest = std::max(highest, axis.dot(ofF));
    lowest = std::min(lowest, axis.dot(ofG));
    size = std::max({size, ofF.lpNorm<1>(), ofG.lpNorm<1>()});
  }
  return lowest - highest > kClear * axis.lpNorm<1>() * size;
}

/// True if a plane through p parts the triangles (p, a, b) and (p, c, d) beyond doubt.
bool clearlyParted(const Point& p, const Point& a, const Point& b, const Point& c, const Point& d) {
  const Vector pa = a - p, pb = b - p, pc = c - p, pd = d - p;
  const Vector axis = (pc + pd).normalized() - (pa + pb).normalized();
  const auto clear = [&](const Vector& way) {
    return axis.dot(way) > kClear * axis.lpNorm<1>() * way.lpNorm<1>();
  };
  return clear(pc) && clear(pd) && clear(-pa) && clear(-pb);
}

}  // namespace

void FaceRing::add(std::int32_t face) {
  if (many_.empty() && count_ < few_.size()) {
    few_[count_++] = face;
    return;
  }
  if (many_.empty()) many_.assign(few_.begin(), few_.end());
  many_.push_back(face);
  ++count_;
}

void FaceRing::remove(std::int32_t face) {
  std::int32_t* const faces = many_.empty() ? few_.data() : many_.data();
  std::int32_t* const at = std::find(faces, faces + count_, face);
  if (at == faces + count_) return;
  *at = faces[--count_];
  if (many_.empty()) return;
  many_.pop_back();
  if (count_ > few_.size()) return;
  std::copy(many_.begin(), many_.end(), few_.begin());
  many_.clear();
}

GuardedMesh::GuardedMesh(const TriangleMesh& mesh, double cell)
    : positions_(mesh.vertexCount()), vertexFaces_(mesh.vertexCount()) {
  Point low = Point::Constant(kInfinity), high = Point::Constant(-kInfinity);
  for (Eigen::Index v = 0; v < mesh.vertexCount(); ++v) {
    positions_[v] = asStored(mesh.positions.row(v));
    low = low.cwiseMin(positions_[v]);
    high = high.cwiseMax(positions_[v]);
  }
  placeCells(low, high, cell, mesh.faceCount());
  faces_.resize(mesh.faceCount());
  scratch_.stamp.resize(mesh.faceCount(), 0);
  for (Eigen::Index f = 0; f < mesh.faceCount(); ++f) {
    faces_[f] = {mesh.faces(f, 0), mesh.faces(f, 1), mesh.faces(f, 2)};
    for (const std::int32_t v : faces_[f]) vertexFaces_[v].add(static_cast<std::int32_t>(f));
  }
  faceCount_ = mesh.faceCount();
  for (std::int32_t v = 0; v < vertexSlots() && !open_; ++v) open_ = endsAt(v);
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

bool GuardedMesh::endsAt(std::int32_t v) const {
  std::int32_t odd = 0;
  for (const std::int32_t f : vertexFaces_[v]) {
    const Corners& c = faces_[f];
    const int k = c[0] == v ? 0 : (c[1] == v ? 1 : 2);
    odd ^= c[(k + 1) % 3] ^ c[(k + 2) % 3];
  }
  return odd != 0;
}

std::array<std::int32_t, 2> GuardedMesh::rimNeighbours(std::int32_t v) const {
  std::array<std::int32_t, 2> found = {-1, -1};
  for (const std::int32_t f : vertexFaces_[v]) {
    const Corners& c = faces_[f];
    const int k = c[0] == v ? 0 : (c[1] == v ? 1 : 2);
    const std::int32_t next = c[(k + 1) % 3], before = c[(k + 2) % 3];
    if (opposite(next, v) < 0) found[1] = next;
    if (opposite(v, before) < 0) found[0] = before;
  }
  return found;
}

GuardedMesh::Ring GuardedMesh::ringOf(std::int32_t v) const {
  Ring ring;
  double weight = 0;
  for (const std::int32_t f : vertexFaces_[v]) {
    const Corners& c = faces_[f];
    const Vector normal = normalOf(f);
    const double area = normal.norm();
    const Point sum = positions_[c[0]] + positions_[c[1]] + positions_[c[2]];
    ring.centre += area / 3 * sum;
    ring.mean += sum - positions_[v];
    ring.normal += normal;
    weight += area;
  }
  // Each neighbour is a corner of two faces.
  ring.mean /= 2 * static_cast<double>(valence(v));
  ring.centre = weight > 0 ? Point(ring.centre / weight) : positions_[v];
  const double length = ring.normal.norm();
  ring.normal = length > 0 ? Vector(ring.normal / length) : Vector(Vector::Zero());
  return ring;
}

Point GuardedMesh::alongRim(std::int32_t v) const {
  const auto [before, after] = rimNeighbours(v);
  return 0.5 * positions_[v] + 0.25 * (positions_[before] + positions_[after]);
}

GuardedMesh::Placed GuardedMesh::place(const Corners& corners, std::int32_t moved,
                                       const Point& to) const {
  Placed placed;
  placed.corners = corners;
  for (int k = 0; k < 3; ++k) placed.points[k] = corners[k] == moved ? to : positions_[corners[k]];
  placed.box = boxOf(placed.points);
  const Vector u = placed.points[1] - placed.points[0], v = placed.points[2] - placed.points[0];
  placed.normal = u.cross(v);
  placed.magnitude = u.lpNorm<1>() * v.lpNorm<1>();
  return placed;
}

int GuardedMesh::Placed::sideOf(const Point& p) const {
  const Vector way = p - points[0];
  const double height = normal.dot(way);
  if (std::abs(height) <= geometry::kBesideRounding * magnitude * way.lpNorm<1>()) return 0;
  return height > 0 ? 1 : -1;
}

bool GuardedMesh::facesMeet(const Placed& made, const Corners& gc, const std::array<Point, 3>& gp) {
  const Corners& fc = made.corners;
  const std::array<Point, 3>& fp = made.points;
  // Clearly beside the face's plane but for what is common: nothing else meets.
  int side = 0, beside = 0, own = 0;
  for (int j = 0; j < 3; ++j) {
    if (gc[j] == fc[0] || gc[j] == fc[1] || gc[j] == fc[2]) continue;
    ++own;
    const int here = made.sideOf(gp[j]);
    if (here == 0 || (side != 0 && here != side)) break;
    side = here;
    ++beside;
  }
  if (own > 0 && beside == own) return false;

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
      return !clearlyApart(fp, gp) && trianglesIntersect(fp, gp);
    case 1:
      if (clearlyParted(fp[ofF[0]], fp[ofF[1]], fp[ofF[2]], gp[ofG[1]], gp[ofG[2]])) return false;
      return trianglesSharingVertexIntersect(fp[ofF[0]], fp[ofF[1]], fp[ofF[2]], gp[ofG[1]],
                                             gp[ofG[2]]);
    case 2:
      return trianglesSharingEdgeIntersect(fp[ofF[0]], fp[ofF[1]], fp[ofF[2]], gp[ofG[2]]);
    default:
      return true;
  }
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
      if (facesMeet(made[m], made[n].corners, made[n].points)) return false;
    }
  }
  const CellRange r = cellsOf(all), touched = cellsOf(roomy(all));
  if (touched[scratch.axis] < scratch.lowCell || touched[scratch.axis + 3] > scratch.highCell) {
    scratch.leftZone = true;
    return false;
  }
  if (scratch.stamp.size() < faces_.size()) scratch.stamp.resize(faces_.size(), 0);
  const std::uint32_t query = ++scratch.query;
  for (const std::int32_t f : removed) scratch.stamp[f] = query;
  std::array<BoxLanes, kMostFaces / BoxLanes::kLanes> boxes;
  for (std::size_t m = 0; m < made.size(); ++m) {
    boxes[m / BoxLanes::kLanes].set(static_cast<int>(m % BoxLanes::kLanes), made[m].box);
  }
  const std::size_t groups = (made.size() + BoxLanes::kLanes - 1) / BoxLanes::kLanes;
  const auto meets = [&](std::int32_t g) {
    const Corners& c = faces_[g];
    const std::array<Point, 3> points = {positions_[c[0]], positions_[c[1]], positions_[c[2]]};
    const Box box = boxOf(points);
    for (std::size_t group = 0; group < groups; ++group) {
      for (unsigned hits = boxes[group].meeting(box); hits != 0; hits &= hits - 1) {
        const std::size_t m = group * BoxLanes::kLanes + std::countr_zero(hits);
        if (facesMeet(made[m], c, points)) return true;
      }
    }
    return false;
  };
  facesNear(r, all, scratch);
  return std::none_of(scratch.near.begin(), scratch.near.end(), meets);
}

TriangleMesh GuardedMesh::toMesh() const {
  const TriangleMesh mesh = withAllSlots();
  return geometry::extractFaces(mesh, mesh.allFaces()).mesh;
}

}  // namespace explica::surface
