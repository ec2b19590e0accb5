// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Describe.h"
#include "Explica/Core/Types.h"
#include "Explica/Sampling/Sampler.h"

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace explica::sampling {

/// What becomes of the values at several depths of a vertex.
enum class Across {
  None,  ///< one map a depth
  Mean,  ///< of the depths at which it is known; of labels the most frequent one
  Max,
  Ribbon  ///< over the volume of the faces about a vertex, see RibbonSampler
};
constexpr auto enumWords(Across) {
  using enum Across;
  return std::to_array<EnumWord<Across>>(
      {{None, "none"}, {Mean, "mean"}, {Max, "max"}, {Ribbon, "ribbon"}});
}

/// One value a vertex from those at several depths.
/// @param values  depths x V, depth after depth; NaN: not known
/// @return V; NaN where no depth is known
[[nodiscard]] std::vector<float> acrossDepths(std::span<const float> values, std::size_t depths,
                                              Across across);

/// The most frequent label of each vertex, of equally frequent ones the one that comes first from
/// the middle depth outward; kNoLabel where none is known.
[[nodiscard]] std::vector<Label> majorityAcross(std::span<const Label> labels, std::size_t depths);

/// Mean and standard deviation of what is known.
struct Moments {
  double mean = kNaN;
  double deviation = kNaN;  ///< with n - 1; NaN for fewer than two values
  std::size_t count = 0;
};

/// A region of the cortex: vertices of one key.
struct RegionName {
  Label key = 0;
  std::string name;
};

/// One parcellation of a surface's vertices; keys that the table lacks are no region.
struct RegionTable {
  std::span<const Label> keys;  ///< V
  std::vector<RegionName> table;
};

/// Regions of vertices, in the order of their tables.  Those of one parcellation are disjoint,
/// those of different ones may overlap.
class Regions {
 public:
  /// One region of all vertices, named "all".
  explicit Regions(Eigen::Index vertexCount);
  /// The regions that have vertices, parcellation after parcellation, and last "all" vertices with
  /// a region.
  /// @throws InvalidInput  none, or parcellations of different length
  explicit Regions(const std::vector<RegionTable>& parcellations);

  [[nodiscard]] const std::vector<std::string>& names() const { return names_; }
  /// Names of a vertex's regions, separated by "; "; empty if it has none.
  [[nodiscard]] std::string nameAt(std::size_t vertex) const;
  /// Moments of one value a vertex by region.
  [[nodiscard]] std::vector<Moments> momentsOf(std::span<const float> values) const;

 private:
  std::vector<std::string> names_;
  std::vector<std::vector<std::int32_t>> regionOf_;  ///< a parcellation, per vertex; -1: none
  std::vector<std::uint8_t> inAny_;                  ///< per vertex
};

}  // namespace explica::sampling
