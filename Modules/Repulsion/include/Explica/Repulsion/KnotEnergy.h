// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Describe.h"
#include "Explica/Core/TriangleMesh.h"

#include <array>
#include <memory>
#include <vector>

namespace explica::repulsion {

/// Knot energy and how it changes with the vertices.
struct KnotValue {
  double value = 0;    ///< mm^2
  Positions gradient;  ///< V x 3, mm; zero rows at vertices that do not move
};

/// Self-repulsion of a triangulated surface, [Thesis, Eq. 5.39 and 5.40]:
///   E = sum over ordered pairs of faces i != j of the integral of 1/|x - y|^2 over S_i x S_j,
/// of which the pairs count that have at least one face with a moving vertex: what the rest adds is
/// constant.  Pairs are ordered, so that each unordered pair counts twice.
///
/// To be minimised: motion descends the gradient ([Thesis, Eq. 5.46] lacks this sign).
class KnotEnergy {
 public:
  virtual ~KnotEnergy() = default;

  /// @param positions  V x 3; vertices that do not move must be where they were at construction
  [[nodiscard]] virtual KnotValue evaluate(const Positions& positions) const = 0;

  /// The same value, for searches along a line; may cost as much as evaluate().
  [[nodiscard]] virtual double value(const Positions& positions) const {
    return evaluate(positions).value;
  }
};

/// How the repulsive (knot) energy is evaluated.
enum class KnotMethod {
  Tree,        ///< multipole tree: fast, relative error about 1e-3
  ThesisTree,  ///< merging tree with recursion, [Thesis, section 5.4]
  AllPairs,    ///< every pair of faces: slow, exact to about 1e-6
  Off          ///< no knot energy
};
constexpr auto enumWords(KnotMethod) {
  using enum KnotMethod;
  return std::to_array<EnumWord<KnotMethod>>(
      {{Tree, "tree"}, {ThesisTree, "thesis-tree"}, {AllPairs, "all-pairs"}, {Off, "off"}});
}

/// The evaluator of this name with its default options; null for Off.
/// @param mesh         positions of the fixed vertices count; those of moving ones may change later
/// @param vertexMoves  V flags
/// @throws InvalidInput  flags of another size, a face index out of range or repeated in a face,
/// two
///                       faces on the same three vertices (their energy is infinite)
[[nodiscard]] std::unique_ptr<KnotEnergy> makeKnotEnergy(KnotMethod method,
                                                         const TriangleMesh& mesh,
                                                         const std::vector<bool>& vertexMoves);

}  // namespace explica::repulsion
