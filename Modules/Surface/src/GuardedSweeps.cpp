// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

// A GuardedMesh worked on by several threads, slab by slab.

#include "GuardedMesh.h"

#include "Explica/Core/IndicesWhere.h"
#include "Explica/Core/Parallel.h"
#include "MoveTogether.h"

#include <algorithm>
#include <iterator>
#include <utility>

namespace explica::surface {

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

template <class Item, class PlaceOf, class Work>
void GuardedMesh::overSlabs(const std::vector<Item>& items, const PlaceOf& placeOf,
                            const Work& work) {
  const int axis = static_cast<int>(std::ranges::max_element(cellSize_) - cellSize_.begin());
  std::vector<std::vector<Item>> members((cellSize_[axis] + kSlab - 1) / kSlab);
  for (const Item& item : items) members[cellAt(placeOf(item, axis), axis) / kSlab].push_back(item);
  const std::size_t slabs = members.size();
  std::vector<std::vector<Item>> late(slabs);
  slabScratch_.resize(slabs);
  for (const std::size_t parity : {0, 1}) {
    parallelFor((slabs + 1 - parity) / 2, 1, [&](std::size_t pair) {
      const std::size_t slab = 2 * pair + parity;
      Scratch& scratch = slabScratch_[slab];
      scratch.axis = axis;
      scratch.lowCell = static_cast<int>(slab) * kSlab - kHalfSlab;
      scratch.highCell = static_cast<int>(slab + 1) * kSlab + kHalfSlab - 1;
      std::ranges::copy_if(members[slab], std::back_inserter(late[slab]),
                           [&](const Item& item) { return !work(item, scratch); });
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
  for (const std::vector<Item>& ofSlab : late) {
    for (const Item& item : ofSlab) work(item, scratch_);
  }
}

std::vector<std::int32_t> GuardedMesh::allVertices() const {
  return indicesWhere(positions_.size(),
                      [&](std::size_t v) { return hasVertex(static_cast<std::int32_t>(v)); });
}

void GuardedMesh::sweep(const std::function<bool(std::int32_t, Scratch&)>& step) {
  sweep(allVertices(), step);
}

void GuardedMesh::sweep(const std::vector<std::int32_t>& vertices,
                        const std::function<bool(std::int32_t, Scratch&)>& step) {
  if (vertices.empty()) return;
  bringUpToDate();
  overSlabs(
      vertices, [&](std::int32_t v, int axis) { return positions_[v][axis]; },
      [&](std::int32_t v, Scratch& scratch) {
        scratch.leftZone = !inZone(v, scratch);
        const bool isDone = !scratch.leftZone && step(v, scratch);
        return isDone || !scratch.leftZone;
      });
}

void GuardedMesh::sweepEdges(const std::vector<Edge>& edges,
                             const std::function<void(const Edge&, Scratch&)>& step) {
  bringUpToDate();
  overSlabs(
      edges, [&](const Edge& edge, int axis) { return positions_[edge[0]][axis]; },
      [&](const Edge& edge, Scratch& scratch) {
        scratch.leftZone = !inZone(edge[0], scratch) || !inZone(edge[1], scratch);
        if (!scratch.leftZone) step(edge, scratch);
        return !scratch.leftZone;
      });
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

void GuardedMesh::moveTogether(const std::vector<std::int32_t>& vertices, int attempts,
                               const Attempts& to) {
  TriangleMesh mesh = withAllSlots();
  geometry::SelfIntersectionSearch search;
  surface::moveTogether(mesh, search, vertices, attempts, to);
  for (const std::int32_t v : vertices) positions_[v] = mesh.positions.row(v);
  stale_ = true;
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
  const auto faces = indicesWhere(
      faces_.size(), [&](std::size_t f) { return hasFace(static_cast<std::int32_t>(f)); });
  overSlabs(
      faces, [&](std::int32_t f, int axis) { return boxes_[f][axis]; },
      [&](std::int32_t f, Scratch& scratch) {
        const Corners& c = faces_[f];
        const Box box = boxOf({positions_[c[0]], positions_[c[1]], positions_[c[2]]});
        if (contains(boxes_[f], box)) return true;
        const int axis = scratch.axis;
        const CellRange range = cellsOf(roomy(box));
        if (range[axis] < scratch.lowCell || range[axis + 3] > scratch.highCell ||
            cellAt(boxes_[f][axis + 3], axis) > scratch.highCell) {
          return false;
        }
        rebox(f, box);
        return true;
      });
}

}  // namespace explica::surface
