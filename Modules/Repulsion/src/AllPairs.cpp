// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Repulsion/AllPairs.h"

#include "Assembly.h"
#include "Explica/Core/Parallel.h"
#include "MovingSet.h"

namespace explica::repulsion {

AllPairs::AllPairs(const TriangleMesh& mesh, const std::vector<bool>& vertexMoves,
                   PairAccuracy accuracy)
    : set_(std::make_unique<MovingSet>(mesh, vertexMoves)), accuracy_(accuracy) {}

AllPairs::~AllPairs() = default;

KnotValue AllPairs::evaluate(const Positions& positions) const {
  set_->requireVertexCount(positions);
  std::vector<FaceForce> forces(set_->moving.size());
  parallelFor(forces.size(), 4, [&](std::size_t k) {
    const std::int32_t s = set_->moving[k];
    const Corners corners = cornersOf(positions, set_->faces, s);
    const auto touching = set_->touching(k);
    auto skip = touching.begin();
    FaceForce& force = forces[k];
    for (std::int32_t t = 0; t < static_cast<std::int32_t>(set_->faces.rows()); ++t) {
      if (skip != touching.end() && *skip == t) {
        ++skip;
        continue;
      }
      const PairIntegral pair =
          integrateApart(corners, cornersOf(positions, set_->faces, t), accuracy_);
      force.value += (set_->faceMoves[t] ? 1 : 2) * pair.value;
      for (int c = 0; c < 3; ++c) force.byCorner[c] += 2 * pair.byS[c];
    }
  });
  return assemble(*set_, positions, forces, accuracy_);
}

}  // namespace explica::repulsion
