// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "GuardedMesh.h"

#include "Explica/Core/Parallel.h"
#include "Explica/Geometry/Predicates.h"
#include "Explica/Geometry/TriangleIntersection.h"
#include "MoveTogether.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <utility>

namespace explica::surface {
namespace {

bool contains(const std::array<float, 6>& outer, const std::array<float, 6>& inner) {
  return outer[0] <= inner[0] && outer[1] <= inner[1] && outer[2] <= inner[2] &&
         inner[3] <= outer[3] && inner[4] <= outer[4] && inner[5] <= outer[5];
}

/// How much wider than its face an entry's box is, in cells: small steps then leave it as it is.
constexpr double kSlack = 0.08;
/// Entries that a cell has room for beyond those it starts with.
constexpr std::uint32_t kSpare = 1;

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

double qualityOf(const std::array<Point, 3>& p) {
  const double squares =
      (p[1] - p[0]).squaredNorm() + (p[2] - p[1]).squaredNorm() + (p[0] - p[2]).squaredNorm();
  return 2 * std::sqrt(3.0) * (p[1] - p[0]).cross(p[2] - p[0]).norm() / squares;
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

void GuardedMesh::placeCells(const Point& low, const Point& high, double cell, Eigen::Index faces) {
  // Points beyond the cells fall to the outermost ones.
  constexpr double kMargin = 4;             // cells around the mesh
  constexpr double kMostCellsPerFace = 16;  // a folded surface fills one of ten
  constexpr double kFewestCells = 4096;
  const double most = kFewestCells + kMostCellsPerFace * static_cast<double>(faces);
  const auto cellsAlong = [&](int a) {
    return std::floor((high[a] - low[a]) / cell + 2 * kMargin) + 1;
  };
  while (cellsAlong(0) * cellsAlong(1) * cellsAlong(2) > most) cell *= 1.25;
  for (int a = 0; a < 3; ++a) cellSize_[a] = static_cast<int>(cellsAlong(a));
  cellOrigin_ = low - Point::Constant(kMargin * cell);
  cellsPerMm_ = 1 / cell;
  roomOfBoxes_ = 1e-6 * cell;
  slack_ = static_cast<float>(kSlack * cell);
}

Box GuardedMesh::boxOf(const std::array<Point, 3>& p) const {
  constexpr double kRounding = 1e-6;  // more than that of a float
  Box box;
  for (int a = 0; a < 3; ++a) {
    const double low = std::min({p[0][a], p[1][a], p[2][a]});
    const double high = std::max({p[0][a], p[1][a], p[2][a]});
    box[a] = static_cast<float>(low - roomOfBoxes_ - kRounding * std::abs(low));
    box[a + 3] = static_cast<float>(high + roomOfBoxes_ + kRounding * std::abs(high));
  }
  return box;
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

int GuardedMesh::cellAt(double coordinate, int axis) const {
  const double cell = (coordinate - cellOrigin_[axis]) * cellsPerMm_;
  return static_cast<int>(std::clamp(cell, 0.0, cellSize_[axis] - 1.0));
}

GuardedMesh::CellRange GuardedMesh::cellsOf(const Box& box) const {
  CellRange range;
  for (int a = 0; a < 3; ++a) {
    range[a] = cellAt(box[a], a);
    range[a + 3] = cellAt(box[a + 3], a);
  }
  return range;
}

/// Calls visit(cell) until it returns false.
template <class Visit>
void GuardedMesh::forCells(const CellRange& r, const Visit& visit) const {
  for (int k = r[2]; k <= r[5]; ++k) {
    for (int j = r[1]; j <= r[4]; ++j) {
      const std::size_t row =
          static_cast<std::size_t>(cellSize_[0]) * (j + static_cast<std::size_t>(cellSize_[1]) * k);
      for (int i = r[0]; i <= r[3]; ++i) {
        if (!visit(row + i)) return;
      }
    }
  }
}

void GuardedMesh::Cell::add(std::int32_t face, const Box& box) {
  constexpr std::uint32_t kLanes = BoxLanes::kLanes;
  if (count == kLanes * room) {
    room = 2 * room + 1;
    auto wider = std::make_unique<Entries[]>(room);
    std::copy(begin, end(), wider.get());
    own = std::move(wider);
    begin = own.get();
  }
  Entries& last = begin[count / kLanes];
  const auto lane = static_cast<int>(count % kLanes);
  last.boxes.set(lane, box);
  last.face[lane] = face;
  ++count;
}

void GuardedMesh::Cell::remove(std::int32_t face) {
  constexpr std::uint32_t kLanes = BoxLanes::kLanes;
  for (Entries* entries = begin; entries != end(); ++entries) {
    for (int lane = 0; lane < BoxLanes::kLanes; ++lane) {
      if (entries->face[lane] != face) continue;
      --count;
      Entries& last = begin[count / kLanes];
      const auto lastLane = static_cast<int>(count % kLanes);
      entries->boxes.copy(lane, last.boxes, lastLane);
      entries->face[lane] = last.face[lastLane];
      last.boxes.clear(lastLane);
      last.face[lastLane] = -1;
      return;
    }
  }
}

void GuardedMesh::Cell::change(std::int32_t face, const Box& box) {
  for (Entries* entries = begin; entries != end(); ++entries) {
    for (int lane = 0; lane < BoxLanes::kLanes; ++lane) {
      if (entries->face[lane] == face) entries->boxes.set(lane, box);
    }
  }
}

Box GuardedMesh::roomy(const Box& box) const {
  return {box[0] - slack_, box[1] - slack_, box[2] - slack_,
          box[3] + slack_, box[4] + slack_, box[5] + slack_};
}

/// Which faces lie in which slab of cells: threads then fill a slab each, every cell in the order
/// of the faces.
class GuardedMesh::FacesOfSlabs {
 public:
  explicit FacesOfSlabs(const GuardedMesh& mesh)
      : ranges_(mesh.boxes_.size()), slabs_((mesh.cellSize_[2] + kLayers - 1) / kLayers) {
    parallelFor(ranges_.size(), 4096,
                [&](std::size_t f) { ranges_[f] = mesh.cellsOf(mesh.boxes_[f]); });
    for (std::size_t f = 0; f < ranges_.size(); ++f) {
      for (int slab = ranges_[f][2] / kLayers; slab <= ranges_[f][5] / kLayers; ++slab) {
        slabs_[slab].push_back(static_cast<std::int32_t>(f));
      }
    }
  }

  /// Calls visit(cells, face) with the cells of the face that lie in a slab, on several threads.
  template <class Visit>
  void forEach(const Visit& visit) const {
    parallelFor(slabs_.size(), 1, [&](std::size_t slab) {
      const int low = kLayers * static_cast<int>(slab);
      for (const std::int32_t f : slabs_[slab]) {
        CellRange range = ranges_[f];
        range[2] = std::max(range[2], low);
        range[5] = std::min(range[5], low + kLayers - 1);
        visit(range, f);
      }
    });
  }

 private:
  static constexpr int kLayers = 8;  // of cells a slab
  std::vector<CellRange> ranges_;
  std::vector<std::vector<std::int32_t>> slabs_;
};

void GuardedMesh::fillCells() {
  constexpr std::uint32_t kLanes = BoxLanes::kLanes;
  cells_.resize(static_cast<std::size_t>(cellSize_[0]) * cellSize_[1] * cellSize_[2]);
  occupied_.assign(cells_.size() / 64 + 1, 0);
  boxes_.resize(faces_.size());
  parallelFor(faces_.size(), 4096, [&](std::size_t f) {
    const Corners& c = faces_[f];
    boxes_[f] = roomy(boxOf({positions_[c[0]], positions_[c[1]], positions_[c[2]]}));
  });
  const FacesOfSlabs slabs(*this);
  slabs.forEach([&](const CellRange& range, std::int32_t /*face*/) {
    forCells(range, [&](std::size_t cell) {
      ++cells_[cell].room;
      return true;
    });
  });
  std::size_t entries = 0;
  for (Cell& cell : cells_) {
    if (cell.room > 0) cell.room = (cell.room + kSpare + kLanes - 1) / kLanes;
    entries += cell.room;
  }
  store_.resize(entries);
  Entries* next = store_.data();
  for (Cell& cell : cells_) {
    cell.begin = next;
    next += cell.room;
  }
  slabs.forEach([&](const CellRange& range, std::int32_t face) { enter(face, range); });
}

void GuardedMesh::enter(std::int32_t f) {
  enter(f, cellsOf(boxes_[f]));
}

void GuardedMesh::enter(std::int32_t f, const CellRange& range) {
  forCells(range, [&](std::size_t cell) {
    if (cells_[cell].count == 0) {
      // Neighbouring slabs share words.
      std::atomic_ref(occupied_[cell / 64])
          .fetch_or(1ULL << (cell % 64), std::memory_order_relaxed);
    }
    cells_[cell].add(f, boxes_[f]);
    return true;
  });
}

void GuardedMesh::leave(std::int32_t f) {
  forCells(cellsOf(boxes_[f]), [&](std::size_t cell) {
    cells_[cell].remove(f);
    return true;
  });
}

void GuardedMesh::rebox(std::int32_t f, const Box& box) {
  if (contains(boxes_[f], box)) return;
  const Box wider = roomy(box);
  const CellRange range = cellsOf(wider);
  if (range != cellsOf(boxes_[f])) {
    leave(f);
    boxes_[f] = wider;
    enter(f);
    return;
  }
  boxes_[f] = wider;
  forCells(range, [&](std::size_t cell) {
    cells_[cell].change(f, wider);
    return true;
  });
}

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

void GuardedMesh::facesNear(const CellRange& range, const Box& box, Scratch& scratch) const {
  // What each round reads is fetched in the one before: else the processor waits for memory most of
  // the time.
  auto& cells = scratch.cells;
  auto& near = scratch.near;
  cells.clear();
  near.clear();
  forCells(range, [&](std::size_t cell) {
    if (!(occupied_[cell / 64] >> (cell % 64) & 1U)) return true;
    cells.push_back(static_cast<std::uint32_t>(cell));
    __builtin_prefetch(&cells_[cell]);
    return true;
  });
  for (const std::uint32_t cell : cells) __builtin_prefetch(cells_[cell].begin);
  for (const std::uint32_t cell : cells) {
    for (const Entries* at = cells_[cell].begin; at != cells_[cell].end(); ++at) {
      for (unsigned hits = at->boxes.meeting(box); hits != 0; hits &= hits - 1) {
        const std::int32_t g = at->face[std::countr_zero(hits)];
        near.push_back(g);
        __builtin_prefetch(&scratch.stamp[g]);
        __builtin_prefetch(&faces_[g]);
      }
    }
  }
  std::erase_if(near, [&](std::int32_t g) {
    if (scratch.stamp[g] == scratch.query) return true;
    scratch.stamp[g] = scratch.query;
    for (const std::int32_t v : faces_[g]) __builtin_prefetch(&positions_[v]);
    return false;
  });
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

bool GuardedMesh::inZone(std::int32_t v, const Scratch& scratch) const {
  for (const std::int32_t f : vertexFaces_[v]) {
    if (cellAt(boxes_[f][scratch.axis], scratch.axis) < scratch.lowCell ||
        cellAt(boxes_[f][scratch.axis + 3], scratch.axis) > scratch.highCell) {
      return false;
    }
  }
  return true;
}

namespace {

/// Cells in half a slab: several faces, so that few vertices must wait for the end.
constexpr int kHalfSlab = 5;
constexpr int kSlab = 2 * kHalfSlab;

}  // namespace

int GuardedMesh::slabAxis() const {
  return static_cast<int>(std::max_element(cellSize_.begin(), cellSize_.end()) - cellSize_.begin());
}

template <class Item, class Work>
void GuardedMesh::overSlabs(const std::vector<std::vector<Item>>& members, const Work& work) {
  const std::size_t slabs = members.size();
  slabScratch_.resize(slabs);
  for (const std::size_t parity : {0, 1}) {
    parallelFor((slabs + 1 - parity) / 2, 1, [&](std::size_t pair) {
      const std::size_t slab = 2 * pair + parity;
      Scratch& scratch = slabScratch_[slab];
      scratch.axis = slabAxis();
      scratch.lowCell = static_cast<int>(slab) * kSlab - kHalfSlab;
      scratch.highCell = static_cast<int>(slab + 1) * kSlab + kHalfSlab - 1;
      work(slab, scratch);
    });
  }
  // What the slabs freed is free for all, in an order that does not depend on the threads.
  for (Scratch& scratch : slabScratch_) {
    const auto give = [](std::vector<std::int32_t>& from, std::vector<std::int32_t>& to) {
      to.insert(to.end(), from.begin(), from.end());
      from.clear();
    };
    give(scratch.freeFaces, scratch_.freeFaces);
    give(scratch.freeVertices, scratch_.freeVertices);
    scratch_.facesAdded += std::exchange(scratch.facesAdded, 0);
  }
}

std::vector<std::int32_t> GuardedMesh::allVertices() const {
  std::vector<std::int32_t> vertices;
  vertices.reserve(positions_.size());
  for (std::int32_t v = 0; v < vertexSlots(); ++v) {
    if (hasVertex(v)) vertices.push_back(v);
  }
  return vertices;
}

std::int64_t GuardedMesh::sweep(const std::function<bool(std::int32_t, Scratch&)>& step) {
  return sweep(allVertices(), step);
}

std::int64_t GuardedMesh::sweep(const std::vector<std::int32_t>& vertices,
                                const std::function<bool(std::int32_t, Scratch&)>& step) {
  if (vertices.empty()) return 0;
  bringUpToDate();
  const int axis = slabAxis();
  const int slabs = (cellSize_[axis] + kSlab - 1) / kSlab;
  std::vector<std::vector<std::int32_t>> members(slabs), late(slabs);
  for (const std::int32_t v : vertices) {
    members[cellAt(positions_[v][axis], axis) / kSlab].push_back(v);
  }
  std::vector<std::int64_t> refused(slabs, 0);
  overSlabs(members, [&](std::size_t slab, Scratch& scratch) {
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
  std::int64_t sum = 0;
  for (int slab = 0; slab < slabs; ++slab) {
    for (const std::int32_t v : late[slab]) sum += !step(v, scratch_);
    sum += refused[slab];
  }
  return sum;
}

void GuardedMesh::sweepEdges(const std::vector<Edge>& edges,
                             const std::function<void(const Edge&, Scratch&)>& step) {
  bringUpToDate();
  const int axis = slabAxis();
  std::vector<std::vector<Edge>> members((cellSize_[axis] + kSlab - 1) / kSlab);
  for (const Edge& edge : edges) {
    members[cellAt(positions_[edge[0]][axis], axis) / kSlab].push_back(edge);
  }
  std::vector<std::vector<Edge>> late(members.size());
  overSlabs(members, [&](std::size_t slab, Scratch& scratch) {
    for (const Edge& edge : members[slab]) {
      scratch.leftZone = !inZone(edge[0], scratch) || !inZone(edge[1], scratch);
      if (!scratch.leftZone) step(edge, scratch);
      if (scratch.leftZone) late[slab].push_back(edge);
    }
  });
  for (const std::vector<Edge>& ofSlab : late) {
    for (const Edge& edge : ofSlab) step(edge, scratch_);
  }
}

TriangleMesh GuardedMesh::withAllSlots() const {
  TriangleMesh mesh;
  mesh.positions.resize(vertexSlots(), 3);
  for (std::int32_t v = 0; v < vertexSlots(); ++v) mesh.positions.row(v) = positions_[v];
  mesh.faces.resize(faceCount(), 3);
  Eigen::Index row = 0;
  for (const Corners& c : faces_) {
    if (c[0] >= 0) mesh.faces.row(row++) << c[0], c[1], c[2];
  }
  return mesh;
}

std::int64_t GuardedMesh::moveTogether(const std::vector<std::int32_t>& vertices, int attempts,
                                       const Attempts& to) {
  TriangleMesh mesh = withAllSlots();
  geometry::SelfIntersectionSearch search;
  const std::vector<std::uint8_t> stand =
      surface::moveTogether(mesh, search, vertices, attempts, to);
  for (const std::int32_t v : vertices) positions_[v] = mesh.positions.row(v);
  stale_ = true;
  return std::count(stand.begin(), stand.end(), static_cast<std::uint8_t>(attempts));
}

void GuardedMesh::bringUpToDate() {
  if (!filled_) {
    fillCells();
  } else if (stale_) {
    reboxAll();
  }
  filled_ = true;
  stale_ = false;
}

void GuardedMesh::reboxAll() {
  const int axis = slabAxis();
  std::vector<std::vector<std::int32_t>> members((cellSize_[axis] + kSlab - 1) / kSlab);
  for (std::int32_t f = 0; f < faceSlots(); ++f) {
    if (hasFace(f)) members[cellAt(boxes_[f][axis], axis) / kSlab].push_back(f);
  }
  const auto boxNow = [&](std::int32_t f) {
    const Corners& c = faces_[f];
    return boxOf({positions_[c[0]], positions_[c[1]], positions_[c[2]]});
  };
  std::vector<std::vector<std::int32_t>> late(members.size());
  overSlabs(members, [&](std::size_t slab, Scratch& scratch) {
    for (const std::int32_t f : members[slab]) {
      const Box box = boxNow(f);
      if (contains(boxes_[f], box)) continue;
      const CellRange range = cellsOf(roomy(box));
      if (range[axis] < scratch.lowCell || range[axis + 3] > scratch.highCell ||
          cellAt(boxes_[f][axis + 3], axis) > scratch.highCell) {
        late[slab].push_back(f);
      } else {
        rebox(f, box);
      }
    }
  });
  for (const std::vector<std::int32_t>& ofSlab : late) {
    for (const std::int32_t f : ofSlab) rebox(f, boxNow(f));
  }
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
  mesh.faces.resize(faceCount(), 3);
  Eigen::Index row = 0;
  for (const Corners& c : faces_) {
    if (c[0] < 0) continue;
    for (int k = 0; k < 3; ++k) mesh.faces(row, k) = number[c[k]];
    ++row;
  }
  return mesh;
}

}  // namespace explica::surface
