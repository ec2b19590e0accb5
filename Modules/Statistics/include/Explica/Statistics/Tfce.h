// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Geometry/MeshTopology.h"

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace explica::statistics {

/// Threshold-free cluster enhancement of a map on a surface [SmithNichols2009, Eq. 1]:
/// T(v) = integral over h from 0 to |s(v)| of e(v, h)^E h^H dh, with e(v, h) the area of the
/// cluster of v at the threshold h, E = 1 as on surfaces and H = 2; negative values likewise, with
/// a negative T.
///
/// The integral is exact: between two neighbouring values of the map no cluster changes, so that
/// each piece has a closed form.  Clusters are followed by union and find from the highest vertex
/// down; what a cluster has gathered is kept at its root.  Time O(V log V); the object keeps memory
/// between maps.
class Tfce {
 public:
  /// Both are kept by reference.
  Tfce(const geometry::IndexLists& neighbours, const std::vector<float>& areas);

  /// @param values    V; NaN is outside
  /// @param enhanced  V, set
  void enhance(std::span<const float> values, std::span<float> enhanced);

 private:
  void enhanceSide(std::span<const float> values, float sign, std::span<float> enhanced);
  void add(std::int32_t v, double integral);
  void gather(std::int32_t root, double integral);
  std::int32_t rootOf(std::int32_t v);
  void join(std::int32_t a, std::int32_t b, double integral);

  const geometry::IndexLists& neighbours_;
  const std::vector<float>& areas_;
  std::vector<std::pair<float, std::int32_t>> order_;
  std::vector<std::int32_t> parent_;  // -1: not above the threshold yet
  std::vector<double> gathered_;      // of a root: T so far; of others: T less the parent's
  std::vector<double> since_;         // of a root: integral of h^H up to where it last changed
  std::vector<double> extent_;        // of a root
};

}  // namespace explica::statistics
