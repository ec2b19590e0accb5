// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Results.h"
#include "Explica/Core/TriangleMesh.h"

#include <span>
#include <vector>

namespace explica::flattening {

/// Which distances are compared.
struct DistanceOptions {
  int pairs = 20000;       ///< pairs of vertices in each of the two groups, at most; 0: none
  int sources = 100;       ///< vertices from which they are counted
  int farSources = 100;    ///< those of them, the first, that have pairs anywhere: these cost most
  double localLimit = 30;  ///< mm along the reference: the first group
  unsigned seed = 1;       ///< of their choice
};

/// Distances along a surface between vertices drawn at random, by area: from each source the same
/// number to vertices anywhere and to vertices within the limit.
struct DistancePairs {
  struct Pair {
    std::int32_t from, to;
    double distance;  ///< along the reference, mm
  };
  std::vector<Pair> local, all;
};

/// Distances by Geometry/Geodesic.h, along the listed faces only.
[[nodiscard]] DistancePairs drawPairs(const TriangleMesh& reference,
                                      std::span<const std::int32_t> faces,
                                      const DistanceOptions& options = {});

/// Relative error of distances, mean |s d' / d - 1|, at the scale s that makes it least.
struct DistanceError {
  double error = kNaN;
  double scale = kNaN;
  std::size_t pairs = 0;
};

/// Errors of near and of all distances.
struct DistanceErrors {
  DistanceError local, all;
};

inline void describe(Results& t, const DistanceErrors& d) {
  t.share("geodesic_error_local", "Error of near distances",
          "Mean relative error up to the local limit, at the scale that makes it least.",
          d.local.error)
      .inHead();
  t.share("geodesic_error_all", "Error of all distances", "The same between vertices anywhere.",
          d.all.error)
      .inHead();
}

/// How distances are measured on the surface that is compared.
enum class DistanceKind {
  Straight,  ///< through space: for flat maps
  Surface    ///< along the surface
};

/// @param deformed  V x 3
[[nodiscard]] DistanceError distanceError(const std::vector<DistancePairs::Pair>& pairs,
                                          const TriangleMesh& deformed,
                                          std::span<const std::int32_t> faces, DistanceKind kind);

/// True if every listed face has the same z: a flat map.
[[nodiscard]] bool isFlatMap(const TriangleMesh& mesh, std::span<const std::int32_t> faces);

/// Faces turned over.  In a flat map: those that run against the majority, exact; on a surface:
/// those whose normal is a right angle or more from the mean normal at their corners.
[[nodiscard]] std::int64_t turnedOver(const TriangleMesh& mesh,
                                      std::span<const std::int32_t> faces);

}  // namespace explica::flattening
