// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Flattening/Disc.h"
#include "Explica/Flattening/MapEnergy.h"

#include <array>
#include <vector>

namespace explica::flattening {

/// Keeps the rim of a flat map from meeting itself.  A map of a disc that turns over no face and
/// whose rim is simple is one-to-one, so that nothing else needs to be kept apart.
///
/// The barrier is that of incremental potential contact [Li2020] in the plane, for every rim vertex
/// and rim edge without it that are nearer than the range r of the vertex:
///
///     b(s) = -(s - 1)^2 ln s,   s = squared distance / r^2 < 1,    else 0.
class RimContact {
 public:
  /// @param lengths  of the rim's edges at rest, edge n from rim[n] to rim[n + 1], mm
  /// @param range    mm; less at vertices whose rim edges are short
  RimContact(Loop rim, const std::vector<double>& lengths, double range);

  /// A vertex and an edge of the rim, by their places in it.
  struct Pair {
    std::int32_t vertex, edge;
  };
  /// Pairs within range.
  [[nodiscard]] std::vector<Pair> near(const FlatPositions& flat) const;

  /// Sum of the barrier over the pairs, each with the weight of its range: mm-free.
  [[nodiscard]] double value(const FlatPositions& flat) const;

  struct PairTerm {
    std::array<std::int32_t, 3> vertices;  ///< the vertex and the edge's two ends
    Eigen::Matrix<double, 6, 1> gradient;
    double bend = 0;                        ///< second derivative along the distance, >= 0
    Eigen::Matrix<double, 6, 1> direction;  ///< gradient of the distance
  };
  [[nodiscard]] PairTerm term(const FlatPositions& flat, const Pair& pair) const;

  /// Largest share in (0, 1] of a step during which no rim vertex meets a rim edge.
  [[nodiscard]] double largestStep(const FlatPositions& flat, const FlatPositions& step) const;

 private:
  Loop rim_;
  std::vector<double> range_;  ///< of each place
};

/// Pairs of rim edges, by their places, that meet though they are not neighbours; exact.
[[nodiscard]] std::vector<std::array<std::int32_t, 2>> rimCrossings(const Loop& rim,
                                                                    const FlatPositions& flat);

}  // namespace explica::flattening
