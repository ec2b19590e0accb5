// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Geometry/MeshTopology.h"

#include <Eigen/Core>

#include <cstdint>
#include <span>
#include <vector>

namespace explica::statistics {

/// A connected set of vertices above a threshold.
struct Cluster {
  std::vector<std::int32_t> vertices;  ///< ascending
  std::int32_t peak = -1;              ///< vertex of the largest value
  double extent = 0;                   ///< sum of the vertices' areas
  double mass = 0;    ///< sum of area times the value's height above the threshold [Bullmore1999]
  double weight = 0;  ///< sum of other weights, such as resels
};

/// Clusters of values >= threshold, the largest extent first (equal ones by their first vertex).
/// @param neighbours  of each vertex
/// @param values      V; NaN is outside
/// @param areas       V
/// @param weights     V, or empty
[[nodiscard]] std::vector<Cluster> findClusters(const geometry::IndexLists& neighbours,
                                                const Eigen::VectorXd& values, double threshold,
                                                const Eigen::VectorXd& areas,
                                                const Eigen::VectorXd& weights = {});

/// Largest extent and mass of one map's clusters.
struct LargestCluster {
  float extent = 0;
  float mass = 0;
};

/// Finds them over and over, with memory of its own: for permutations.  Values at or above the
/// threshold and those at or below its negative make clusters of their own.
class LargestClusterFinder {
 public:
  /// Both are kept by reference.
  LargestClusterFinder(const geometry::IndexLists& neighbours, const std::vector<float>& areas);
  [[nodiscard]] LargestCluster find(std::span<const float> values, float threshold);

 private:
  const geometry::IndexLists& neighbours_;
  const std::vector<float>& areas_;
  std::vector<signed char> side_;
  std::vector<std::int32_t> stack_;
};

}  // namespace explica::statistics
