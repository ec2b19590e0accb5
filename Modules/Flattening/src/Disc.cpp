// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Flattening/Disc.h"

#include "Explica/Core/DisjointSets.h"
#include "Explica/Core/Errors.h"
#include "Explica/Geometry/MeshMeasures.h"
#include "Explica/Geometry/MeshTopology.h"

#include <algorithm>
#include <numeric>
#include <string>

namespace explica::flattening {
namespace {

/// Number of the edge-connected part of each face, and the size of each part.
std::vector<std::int32_t> edgeParts(const geometry::MeshTopology& topology, Eigen::Index faceCount,
                                    std::vector<std::size_t>& sizes) {
  DisjointSets sets(static_cast<std::size_t>(faceCount));
  for (Eigen::Index e = 0; e < topology.edgeFaces.rows(); ++e) {
    if (topology.edgeFaces(e, 1) < 0) continue;
    sets.join(topology.edgeFaces(e, 0), topology.edgeFaces(e, 1));
  }
  std::vector<std::int32_t> part(static_cast<std::size_t>(faceCount));
  sizes.assign(part.size(), 0);
  for (std::size_t f = 0; f < part.size(); ++f) {
    part[f] = sets.root(static_cast<std::int32_t>(f));
    ++sizes[part[f]];
  }
  return part;
}

/// Fans of faces about a vertex: groups joined by edges at it.
std::vector<std::vector<std::int32_t>> fansAt(const geometry::MeshTopology& topology,
                                              const Faces& faces, std::int32_t v) {
  const auto around = topology.vertexFaces[v];
  std::vector<std::vector<std::int32_t>> fans;
  std::vector<bool> taken(around.size(), false);
  const auto shareEdge = [&](std::int32_t f, std::int32_t g) {
    int common = 0;
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) common += faces(f, i) == faces(g, j);
    }
    return common == 2;
  };
  for (std::size_t first = 0; first < around.size(); ++first) {
    if (taken[first]) continue;
    taken[first] = true;
    std::vector<std::int32_t> fan = {around[first]};
    for (std::size_t at = 0; at < fan.size(); ++at) {
      for (std::size_t other = 0; other < around.size(); ++other) {
        if (taken[other] || !shareEdge(fan[at], around[other])) continue;
        taken[other] = true;
        fan.push_back(around[other]);
      }
    }
    fans.push_back(std::move(fan));
  }
  return fans;
}

/// One pass of trimming: faces to keep, without those of all but the largest fan at each vertex
/// where several meet, and without the smaller parts that hang on by vertices alone.
std::vector<std::int32_t> withoutPinches(const TriangleMesh& mesh) {
  const auto topology = geometry::buildTopology(mesh.faces, mesh.vertexCount());
  std::vector<std::size_t> sizes;
  const auto part = edgeParts(topology, mesh.faceCount(), sizes);
  std::vector<bool> drop(static_cast<std::size_t>(mesh.faceCount()), false);
  for (std::int32_t v = 0; v < mesh.vertexCount(); ++v) {
    auto fans = fansAt(topology, mesh.faces, v);
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
  std::vector<std::int32_t> kept;
  for (Eigen::Index f = 0; f < mesh.faceCount(); ++f) {
    if (!drop[f]) kept.push_back(static_cast<std::int32_t>(f));
  }
  return kept;
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
  const auto pieces = static_cast<std::size_t>(*std::ranges::max_element(parts)) + 1;
  if (pieces == 1) return;
  const Eigen::VectorXd faceAreas = geometry::faceAreas(disc.mesh);
  std::vector<double> areas(pieces, 0.0);
  for (std::size_t f = 0; f < parts.size(); ++f) {
    areas[parts[f]] += faceAreas[f];
  }
  const auto largest = std::ranges::max_element(areas) - areas.begin();
  const double all = std::accumulate(areas.begin(), areas.end(), 0.0);
  if (!(areas[largest] > all / 2)) {
    throw InvalidInput(
        "surface: the part to be laid flat has " + std::to_string(pieces) +
        " pieces, none with more than half of the area; give one of them, by --label or --cuts");
  }
  std::vector<std::int32_t> kept;
  for (std::size_t f = 0; f < parts.size(); ++f) {
    if (parts[f] == largest) kept.push_back(static_cast<std::int32_t>(f));
  }
  geometry::SubMesh part = geometry::extractFaces(disc.mesh, kept);
  for (std::int32_t& v : part.vertexOrigin) v = disc.vertexOrigin[v];
  for (std::int32_t& f : part.faceOrigin) f = disc.faceOrigin[f];
  disc.mesh = std::move(part.mesh);
  disc.vertexOrigin = std::move(part.vertexOrigin);
  disc.faceOrigin = std::move(part.faceOrigin);
  disc.otherPieces = pieces - 1;
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
