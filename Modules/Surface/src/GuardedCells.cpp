// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

// The cells in space through which a GuardedMesh finds its faces.

#include "GuardedMesh.h"

#include "Explica/Core/Parallel.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>

namespace explica::surface {
namespace {

/// How much wider than its face an entry's box is, in cells: small steps then leave it as it is.
constexpr double kSlack = 0.08;
/// Entries that a cell has room for beyond those it starts with.
constexpr std::uint32_t kSpare = 1;

}  // namespace

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

}  // namespace explica::surface
