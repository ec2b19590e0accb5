// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/TriangleMesh.h"

#include <span>
#include <string_view>
#include <vector>

namespace explica::geometry {

/// Lists of varying length stored one after another: list i is values[begin[i] .. begin[i + 1]).
struct IndexLists {
  std::vector<std::int32_t> begin;   ///< one more than there are lists
  std::vector<std::int32_t> values;  ///< ascending within a list

  [[nodiscard]] std::span<const std::int32_t> operator[](std::size_t list) const {
    return {values.data() + begin[list], values.data() + begin[list + 1]};
  }
  [[nodiscard]] std::size_t size() const { return begin.empty() ? 0 : begin.size() - 1; }
};

/// Who is next to whom in a triangulated surface whose edges have one or two faces.
struct MeshTopology {
  Edges edges;                ///< E x 2, smaller vertex first, in lexicographic order
  Edges edgeFaces;            ///< E x 2, the faces at each edge; second is -1 on the boundary
  Faces faceEdges;            ///< F x 3, edge k joins corners k and (k + 1) % 3
  IndexLists vertexFaces;     ///< faces at each vertex
  IndexLists vertexVertices;  ///< neighbours of each vertex
};

/// Adjacency of a face list.
/// @throws InvalidInput  an index out of range, a face with a repeated vertex, or an edge of more
///                       than two faces
[[nodiscard]] MeshTopology buildTopology(const Faces& faces, Eigen::Index vertexCount);

/// What a surface is, counted: the facts that decide whether it can be used.
struct MeshCondition {
  std::int64_t vertices = 0;
  std::int64_t faces = 0;
  std::int64_t edges = 0;
  std::int64_t components = 0;           ///< of faces, joined by shared vertices
  std::int64_t eulerCharacteristic = 0;  ///< used vertices - edges + faces
  std::int64_t boundaryEdges = 0;        ///< edges of one face
  std::int64_t nonManifoldEdges = 0;     ///< edges of three or more faces
  std::int64_t nonManifoldVertices = 0;  ///< vertices whose faces form more than one fan
  std::int64_t inconsistentEdges = 0;    ///< two faces run through it in the same direction
  std::int64_t repeatedVertexFaces = 0;  ///< faces that name a vertex twice
  std::int64_t zeroAreaFaces = 0;        ///< three different but exactly collinear corners
  std::int64_t duplicateFaces = 0;       ///< faces on the same three vertices as an earlier one
  std::int64_t coincidentVertices = 0;   ///< used vertices at exactly an earlier one's position
  std::int64_t unusedVertices = 0;       ///< vertices of no face
  std::int64_t nonFiniteVertices = 0;
  std::int64_t indicesOutOfRange = 0;

  [[nodiscard]] bool manifold() const {
    return nonManifoldEdges == 0 && nonManifoldVertices == 0 && inconsistentEdges == 0 &&
           repeatedVertexFaces == 0 && duplicateFaces == 0 && indicesOutOfRange == 0;
  }
  [[nodiscard]] bool closedManifold() const { return manifold() && boundaryEdges == 0; }
};

[[nodiscard]] MeshCondition inspectMesh(const TriangleMesh& mesh);

/// Demands an oriented manifold with finite positions; `name` (a file, an argument) starts the
/// message.
/// @return what inspectMesh() says of it
/// @throws InvalidInput  says every count that is wrong and how to mend it
MeshCondition requireManifold(const TriangleMesh& mesh, std::string_view name);

/// As requireManifold, and without boundary.
MeshCondition requireClosedManifold(const TriangleMesh& mesh, std::string_view name);

/// Component of each face, numbered from 0 in the order of their first faces; faces belong together
/// if they share a vertex.
[[nodiscard]] std::vector<std::int32_t> faceComponents(const Faces& faces,
                                                       Eigen::Index vertexCount);

/// Piece of each chosen face, numbered from 0 in the order of their first faces; chosen faces
/// belong together if they share an edge.  -1 for the others.
[[nodiscard]] std::vector<std::int32_t> facePieces(const MeshTopology& topology,
                                                   const std::vector<bool>& chosen);

/// Boundary loops of an oriented manifold, each in the direction of its faces; the one of the
/// smallest vertex first.
[[nodiscard]] std::vector<std::vector<std::int32_t>> boundaryLoops(const Faces& faces,
                                                                   Eigen::Index vertexCount);

/// The faces listed, on their own vertices only.
struct SubMesh {
  TriangleMesh mesh;
  std::vector<std::int32_t> vertexOrigin;  ///< vertex of the whole for each vertex of the part
  std::vector<std::int32_t> faceOrigin;    ///< face of the whole for each face of the part
};
[[nodiscard]] SubMesh extractFaces(const TriangleMesh& mesh, std::span<const std::int32_t> faces);

}  // namespace explica::geometry
