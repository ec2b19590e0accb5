// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Assembly.h"

#include "Explica/Core/Parallel.h"

namespace explica::repulsion {

std::vector<PairIntegral> adjacentPairs(const MovingSet& set, const Positions& positions,
                                        PairAccuracy accuracy) {
  const std::size_t edges = set.edgePairs.size();
  std::vector<PairIntegral> result(edges + set.vertexPairs.size());
  parallelFor(result.size(), 64, [&](std::size_t i) {
    const AdjacentPair& pair = i < edges ? set.edgePairs[i] : set.vertexPairs[i - edges];
    const Corners s = cornersOf(positions, pair.cornersS);
    const Corners t = cornersOf(positions, pair.cornersT);
    result[i] =
        i < edges ? integrateEdgeSharing(s, t, accuracy) : integrateVertexSharing(s, t, accuracy);
  });
  return result;
}

KnotValue assemble(const MovingSet& set, const Positions& positions,
                   const std::vector<FaceForce>& forces,
                   const std::vector<PairIntegral>& adjacent) {
  KnotValue result;
  result.gradient.setZero(positions.rows(), 3);
  for (std::size_t k = 0; k < forces.size(); ++k) {
    result.value += forces[k].value;
    for (int c = 0; c < 3; ++c) {
      result.gradient.row(set.faces(set.moving[k], c)) += forces[k].byCorner[c].transpose();
    }
  }
  for (std::size_t i = 0; i < adjacent.size(); ++i) {
    const std::size_t edges = set.edgePairs.size();
    const AdjacentPair& pair = i < edges ? set.edgePairs[i] : set.vertexPairs[i - edges];
    result.value += 2 * adjacent[i].value;
    for (int c = 0; c < 3; ++c) {
      result.gradient.row(pair.cornersS[c]) += 2 * adjacent[i].byS[c].transpose();
      result.gradient.row(pair.cornersT[c]) += 2 * adjacent[i].byT[c].transpose();
    }
  }
  for (Eigen::Index v = 0; v < positions.rows(); ++v) {
    if (!set.vertexMoves[v]) result.gradient.row(v).setZero();
  }
  return result;
}

}  // namespace explica::repulsion
