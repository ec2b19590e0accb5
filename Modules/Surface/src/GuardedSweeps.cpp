// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

// A GuardedMesh worked on by several threads, slab by slab.

#include "GuardedMesh.h"

#include "Explica/Core/Parallel.h"
#include "MoveTogether.h"

#include <algorithm>
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

void GuardedMesh::sweep(const std::function<bool(std::int32_t, Scratch&)>& step) {
  sweep(allVertices(), step);
}

void GuardedMesh::sweep(const std::vector<std::int32_t>& vertices,
                        const std::function<bool(std::int32_t, Scratch&)>& step) {
  if (vertices.empty()) return;
  bringUpToDate();
  const int axis = slabAxis();
  const int slabs = (cellSize_[axis] + kSlab - 1) / kSlab;
  std::vector<std::vector<std::int32_t>> members(slabs), late(slabs);
  for (const std::int32_t v : vertices) {
    members[cellAt(positions_[v][axis], axis) / kSlab].push_back(v);
  }
  overSlabs(members, [&](std::size_t slab, Scratch& scratch) {
    for (const std::int32_t v : members[slab]) {
      scratch.leftZone = !inZone(v, scratch);
      const bool isDone = !scratch.leftZone && step(v, scratch);
      if (!isDone && scratch.leftZone) late[slab].push_back(v);
    }
  });
  for (const std::vector<std::int32_t>& ofSlab : late) {
    for (const std::int32_t v : ofSlab) step(v, scratch_);
  }
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

}  // namespace explica::surface
