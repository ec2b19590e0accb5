// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Repulsion/KnotEnergy.h"

#include "Explica/Repulsion/AllPairs.h"
#include "Explica/Repulsion/MultipoleTree.h"
#include "Explica/Repulsion/ThesisTree.h"

namespace explica::repulsion {

std::unique_ptr<KnotEnergy> makeKnotEnergy(KnotMethod method, const TriangleMesh& mesh,
                                           const std::vector<bool>& vertexMoves) {
  switch (method) {
    case KnotMethod::Tree:
      return std::make_unique<MultipoleTree>(mesh, vertexMoves);
    case KnotMethod::ThesisTree:
      return std::make_unique<ThesisTree>(mesh, vertexMoves);
    case KnotMethod::AllPairs:
      return std::make_unique<AllPairs>(mesh, vertexMoves);
    case KnotMethod::Off:
      break;
  }
  return nullptr;
}

}  // namespace explica::repulsion
