// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Flattening/Disc.h"

#include "Explica/Core/Errors.h"
#include "Explica/Core/IndicesWhere.h"
#include "Explica/Geometry/FacePieces.h"
#include "Explica/Geometry/MeshMeasures.h"
#include "Explica/Geometry/MeshTopology.h"

#include <algorithm>
#include <numeric>
#include <string>

namespace explica::flattening {
namespace {

/// One pass of trimming: faces to keep, without those of all but the largest fan at each vertex
/// where several meet, and without the smaller parts that hang on by vertices alone.
std::vector<std::int32_t> withoutPinches(const TriangleMesh& mesh) {
  const auto topology = geometry::buildTopology(mesh.faces, mesh.vertexCount());
  std::vector<bool> drop(static_cast<std::size_t>(mesh.faceCount()), false);
  const auto part = geometry::facePieces(topology, std::vector<bool>(drop.size(), true));
  std::vector<std::size_t> sizes(part.size());
  for (const std::int32_t p : part) ++sizes[p];
  for (std::int32_t v = 0; v < mesh.vertexCount(); ++v) {
    auto fans = geometry::fansAt(mesh.faces, v, topology.vertexFaces[v]);
    if (fans.size() < 2) continue;
    // The fan on the larger part stays, then the larger fan, then the one of the first face.
    std::ranges::stable_sort(fans, [&](const auto& a, const auto& b) {
      const std::size_t sa = sizes[part[a.front()]], sb = sizes[part[b.front()]];
      return sa != sb ? sa > sb : a.size() > b.size();
    });
    for (std::size_t n = 1; n < fans.size(); ++n) {
      const bool apart = part[fans[n].front()] != part[fans.front().front()];
      for (const std::int32_t f : fans[n]) drop[f] = true;
      if (!apart) continue;
      for (Eigen::Index f = 0; f < mesh.faceCount(); ++f) {
        if (part[f] == part[fans[n].front()]) drop[f] = true;
      }
    }
  }
  return indicesWhere(drop.size(), [&](std::size_t f) { return !drop[f]; });
}

double lengthOf(const Loop& loop, const Positions& positions) {
  double length = 0;
  for (std::size_t n = 0; n < loop.size(); ++n) {
    length += (positions.row(loop[(n + 1) % loop.size()]) - positions.row(loop[n])).norm();
  }
  return length;
}

/// Demands what no trimming can mend; vertices where several fans meet are mended.
void requireOriented(const TriangleMesh& mesh) {
  geometry::MeshCondition condition = geometry::inspectMesh(mesh);
  condition.nonManifoldVertices = 0;
  if (!condition.manifold() || condition.nonFiniteVertices > 0) {
    geometry::requireManifold(mesh, "surface");
  }
}

/// Leaves the piece that has more than half of the area.
void keepLargest(Disc& disc) {
  const auto parts = geometry::faceComponents(disc.mesh.faces, disc.mesh.vertexCount());
  const std::vector<double> areas = geometry::pieceAreas(disc.mesh, parts);
  if (areas.size() == 1) return;
  const auto largest = std::ranges::max_element(areas) - areas.begin();
  const double all = std::accumulate(areas.begin(), areas.end(), 0.0);
  if (!(areas[largest] > all / 2)) {
    throw InvalidInput(
        "surface: the part to be laid flat has " + std::to_string(areas.size()) +
        " pieces, none with more than half of the area; give one of them, by --label or --cuts");
  }
  const auto kept = indicesWhere(parts.size(), [&](std::size_t f) { return parts[f] == largest; });
  geometry::SubMesh part = geometry::extractFaces(disc.mesh, kept);
  for (std::int32_t& v : part.vertexOrigin) v = disc.vertexOrigin[v];
  for (std::int32_t& f : part.faceOrigin) f = disc.faceOrigin[f];
  disc.mesh = std::move(part.mesh);
  disc.vertexOrigin = std::move(part.vertexOrigin);
  disc.faceOrigin = std::move(part.faceOrigin);
  disc.otherPieces = areas.size() - 1;
  disc.areaOfOthers = 1 - areas[largest] / all;
}

void requireDiscWithHoles(const Disc& disc) {
  const auto parts = geometry::faceComponents(disc.mesh.faces, disc.mesh.vertexCount());
  if (*std::ranges::max_element(parts) > 0) {
    throw InvalidInput("surface: the cuts take it apart");
  }
  const auto topology = geometry::buildTopology(disc.mesh.faces, disc.mesh.vertexCount());
  const auto euler = disc.mesh.vertexCount() - topology.edges.rows() + disc.mesh.faceCount();
  const auto handles = (2 - static_cast<std::int64_t>(disc.holes.size()) - 1 - euler) / 2;
  if (handles > 0) {
    throw InvalidInput("surface: it has " + std::to_string(handles) +
                       " handles, which no plane can hold; mend its topology, or cut them");
  }
}

}  // namespace

void findLoops(Disc& disc) {
  auto loops = geometry::boundaryLoops(disc.mesh.faces, disc.mesh.vertexCount());
  if (loops.empty()) {
    throw InvalidInput(
        "surface: it is closed, so that no plane can hold it; cut it (--cuts), or give a part of "
        "it (--label)");
  }
  std::ranges::stable_sort(loops, [&](const Loop& a, const Loop& b) {
    return lengthOf(a, disc.mesh.positions) > lengthOf(b, disc.mesh.positions);
  });
  disc.rim = std::move(loops.front());
  disc.holes.assign(std::make_move_iterator(loops.begin() + 1),
                    std::make_move_iterator(loops.end()));
  requireDiscWithHoles(disc);
}

Disc discOf(const TriangleMesh& mesh, std::span<const std::int32_t> faces) {
  if (faces.empty()) throw InvalidInput("surface: no face to lay flat");
  requireOriented(geometry::extractFaces(mesh, faces).mesh);
  std::vector<std::int32_t> kept(faces.begin(), faces.end());
  geometry::SubMesh part;
  for (;;) {
    part = geometry::extractFaces(mesh, kept);
    const auto good = withoutPinches(part.mesh);
    if (good.size() == kept.size()) break;
    std::vector<std::int32_t> fewer;
    for (const std::int32_t f : good) fewer.push_back(part.faceOrigin[f]);
    kept = std::move(fewer);
  }
  Disc disc;
  disc.trimmedFaces = faces.size() - kept.size();
  disc.mesh = std::move(part.mesh);
  disc.vertexOrigin = std::move(part.vertexOrigin);
  disc.faceOrigin = std::move(part.faceOrigin);
  keepLargest(disc);
  findLoops(disc);
  return disc;
}

}  // namespace explica::flattening
