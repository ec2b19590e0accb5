// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Flattening/Opening.h"
#include "LayFlat.h"

#include <vector>

namespace explica::flattening {

/// Cheapest ways over the edges of a disc, where a millimetre costs 2^(-depth).
class FoldWays {
 public:
  /// @param depth  one a vertex
  /// @param barred  vertices that no way may touch; empty: none
  FoldWays(const IntrinsicMesh& mesh, Eigen::VectorXd depth, std::vector<bool> barred);

  /// From the nearest of the starts to the end; empty if there is no way.
  [[nodiscard]] CutPath to(std::int32_t end, const std::vector<std::int32_t>& starts) const;

  [[nodiscard]] double lengthOf(const CutPath& path) const;
  /// Mean of the depth along a path.
  [[nodiscard]] double depthOf(const CutPath& path) const;

 private:
  struct Step {
    std::int32_t to;
    double length;
  };
  [[nodiscard]] double stepLength(std::int32_t a, std::int32_t b) const;

  Eigen::VectorXd depth_;
  std::vector<bool> barred_;
  std::vector<std::vector<Step>> steps_;  ///< of each vertex
};

/// Vertices at holes and, after the disc's own, the middles of the fans across: a cut there could
/// take the disc apart.
[[nodiscard]] std::vector<bool> besideHoles(const Disc& disc, Eigen::Index vertexCount);

}  // namespace explica::flattening
