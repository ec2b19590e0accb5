// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/TriangleMesh.h"
#include "MovingSet.h"

#include <vector>

namespace explica::repulsion {

/// Pairs of faces with common corners, in chunks of neighbours that are summed side by side:
/// vectorised by rules that fit the pair's shape, by integrateEdgeSharing() and
/// integrateVertexSharing() at needles and folds that are too sharp for them.
class AdjacentChunks {
 public:
  AdjacentChunks() = default;
  /// @param rank  of each face: pairs are sorted by that of their first face
  AdjacentChunks(const MovingSet& set, const std::vector<std::int32_t>& rank);

  /// What a chunk contributes; kept between calls for its memory.
  struct Sum {
    double value = 0;
    std::vector<Vector> gradient;  // by the chunk's vertices
    std::vector<double> byArea;    // derivative by each face's area
    std::vector<Point> positions;
  };

  /// Adds the energy of both orders of every pair to `value`, its derivatives to `gradient` (V x
  /// 3).
  /// @param areas  of the set's involved faces
  /// @param sums   scratch
  void add(const Positions& positions, const std::vector<FaceArea>& areas, double unit,
           std::vector<Sum>& sums, double& value, Positions& gradient) const;

 private:
  /// A pair within its chunk: the common corners come first, then those of S, then those of T.
  struct Pair {
    std::array<std::int32_t, 5> vertex;  // the last is unused if there is a common edge
    std::int32_t s;
    std::int32_t t;
  };
  struct Chunk {
    std::vector<std::int32_t> vertices;              // of the mesh
    std::vector<std::array<std::int32_t, 3>> faces;  // on the chunk's vertices
    std::vector<std::int32_t> areas;                 // of the faces, among the involved ones
    std::vector<Pair> pairs;
  };
  struct EdgeKind;
  struct VertexKind;

  static std::vector<Chunk> cut(const MovingSet& set, const std::vector<AdjacentPair>& pairs,
                                const std::vector<std::int32_t>& rank,
                                const std::vector<std::int32_t>& involved, bool edges);
  template <class Kind>
  class Adder;

  /// A vertex of a chunk: edge chunks count first.
  struct Place {
    std::int32_t chunk;
    std::int32_t vertex;
  };

  std::vector<Chunk> edgeChunks_;
  std::vector<Chunk> vertexChunks_;
  std::vector<std::size_t> placesBegin_;  // by vertex of the mesh
  std::vector<Place> places_;
};

}  // namespace explica::repulsion
