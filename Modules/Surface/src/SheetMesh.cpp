// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "SheetMesh.h"

#include "Explica/Core/IndicesWhere.h"
#include "Explica/Geometry/FacePieces.h"
#include "Explica/Geometry/MeshMeasures.h"
#include "Explica/Geometry/MeshTopology.h"
#include "Explica/Geometry/SelfIntersection.h"

#include <algorithm>

namespace explica::surface {
namespace {

using geometry::MeshTopology;

/// Marks all fans at a vertex but the largest one.
bool markSmallFans(const Faces& faces, const MeshTopology& topology, std::int32_t v,
                   std::vector<std::uint8_t>& marked) {
  auto fans = geometry::fansAt(faces, v, topology.vertexFaces[v]);
  const auto largest = std::ranges::max_element(fans, {}, &std::vector<std::int32_t>::size);
  if (largest != fans.end()) fans.erase(largest);
  for (const auto& fan : fans) {
    for (const std::int32_t f : fan) marked[f] = 1;
  }
  return !fans.empty();
}

}  // namespace

TriangleMesh withoutFaces(const TriangleMesh& mesh, const std::vector<std::uint8_t>& marked) {
  const auto kept = indicesWhere(marked.size(), [&](auto f) { return marked[f] == 0; });
  return geometry::extractFaces(mesh, kept).mesh;
}

TriangleMesh withoutPinches(const TriangleMesh& given) {
  constexpr int kMostPasses = 50;
  TriangleMesh mesh = given;
  for (int pass = 0; pass < kMostPasses; ++pass) {
    const MeshTopology topology = geometry::buildTopology(mesh.faces, mesh.vertexCount());
    std::vector<std::uint8_t> onRim(mesh.vertexCount(), 0), marked(mesh.faceCount(), 0);
    bool any = false;
    for (Eigen::Index f = 0; f < mesh.faceCount(); ++f) {
      int rimEdges = 0;
      for (int k = 0; k < 3; ++k) {
        if (topology.edgeFaces(topology.faceEdges(f, k), 1) >= 0) continue;
        ++rimEdges;
        onRim[mesh.faces(f, k)] = onRim[mesh.faces(f, (k + 1) % 3)] = 1;
      }
      if (rimEdges < 2) continue;
      marked[f] = 1;
      any = true;
    }
    for (std::int32_t v = 0; v < mesh.vertexCount(); ++v) {
      if (onRim[v] && markSmallFans(mesh.faces, topology, v, marked)) any = true;
    }
    if (!any) break;
    mesh = withoutFaces(mesh, marked);
  }
  return mesh;
}

Pieces largePieces(const TriangleMesh& mesh, double least) {
  const MeshTopology topology = geometry::buildTopology(mesh.faces, mesh.vertexCount());
  const auto piece = geometry::facePieces(topology, std::vector<bool>(mesh.faceCount(), true));
  const std::vector<double> areas = geometry::pieceAreas(mesh, piece);
  if (!areas.empty()) least = std::min(least, *std::max_element(areas.begin(), areas.end()));
  std::vector<std::uint8_t> marked(mesh.faceCount());
  for (std::size_t f = 0; f < marked.size(); ++f) marked[f] = areas[piece[f]] < least;
  return {withoutFaces(mesh, marked),
          std::count_if(areas.begin(), areas.end(), [&](double area) { return area < least; })};
}

std::vector<std::uint8_t> largePatches(const TriangleMesh& mesh, std::vector<std::uint8_t> marked,
                                       double least) {
  const MeshTopology topology = geometry::buildTopology(mesh.faces, mesh.vertexCount());
  const auto piece = geometry::facePieces(topology, {marked.begin(), marked.end()});
  const std::vector<double> areas = geometry::pieceAreas(mesh, piece);
  for (std::size_t f = 0; f < marked.size(); ++f) {
    if (marked[f]) marked[f] = areas[piece[f]] >= least;
  }
  return marked;
}

Closed withHolesClosed(const TriangleMesh& mesh, double longest,
                       const std::function<bool(const std::vector<std::int32_t>&)>& keep) {
  std::vector<std::vector<std::int32_t>> holes;
  for (auto& rim : geometry::boundaryLoops(mesh.faces, mesh.vertexCount())) {
    double length = 0;
    for (std::size_t k = 0; k < rim.size(); ++k) {
      length += (mesh.positions.row(rim[k]) - mesh.positions.row(rim[(k + 1) % rim.size()])).norm();
    }
    if (length < longest && !keep(rim)) holes.push_back(std::move(rim));
  }
  Eigen::Index vertices = mesh.vertexCount(), faces = mesh.faceCount();
  Closed closed{mesh, static_cast<std::int64_t>(holes.size())};
  if (holes.empty()) return closed;
  for (const auto& hole : holes) faces += static_cast<Eigen::Index>(hole.size());
  closed.mesh.positions.conservativeResize(vertices + closed.holes, 3);
  closed.mesh.faces.conservativeResize(faces, 3);
  std::vector<std::int32_t> holeOf(faces, -1);
  Eigen::Index f = mesh.faceCount();
  for (std::size_t h = 0; h < holes.size(); ++h, ++vertices) {
    const auto& hole = holes[h];
    Eigen::RowVector3d middle = Eigen::RowVector3d::Zero();
    for (const std::int32_t v : hole) middle += mesh.positions.row(v);
    closed.mesh.positions.row(vertices) = middle / static_cast<double>(hole.size());
    for (std::size_t k = 0; k < hole.size(); ++k, ++f) {
      closed.mesh.faces.row(f) << hole[(k + 1) % hole.size()], hole[k],
          static_cast<std::int32_t>(vertices);
      holeOf[f] = static_cast<std::int32_t>(h);
    }
  }
  std::vector<bool> added(faces);
  for (Eigen::Index g = 0; g < faces; ++g) added[g] = holeOf[g] >= 0;
  std::vector<std::uint8_t> meets(holes.size(), 0), marked(faces, 0);
  for (const auto& pair : geometry::findSelfIntersections(closed.mesh, added)) {
    for (const std::int32_t g : pair) {
      if (holeOf[g] >= 0) meets[holeOf[g]] = 1;
    }
  }
  for (Eigen::Index g = 0; g < faces; ++g) marked[g] = holeOf[g] >= 0 && meets[holeOf[g]];
  closed.holes -= std::count(meets.begin(), meets.end(), std::uint8_t{1});
  closed.mesh = withoutFaces(closed.mesh, marked);
  return closed;
}

}  // namespace explica::surface
