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
#include <utility>
#include <vector>

namespace explica::sampling {

/// What becomes of the values at several depths of a vertex.
enum class Across {
  None,  ///< one map a depth
  Mean,  ///< of the depths at which it is known; of labels the most frequent one
  Max
};

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

/// Regions of vertices, in the order of a table.
class Regions {
 public:
  /// One region of all vertices, named "all".
  explicit Regions(Eigen::Index vertexCount);
  /// The regions of the table that have vertices, and last "all" vertices with a region.
  Regions(std::span<const Label> keys, const std::vector<RegionName>& table);

  [[nodiscard]] const std::vector<std::string>& names() const { return names_; }
  /// Name of a vertex's region; empty if it has none.
  [[nodiscard]] const std::string& nameAt(std::size_t vertex) const;
  /// Moments of one value a vertex by region.
  [[nodiscard]] std::vector<Moments> momentsOf(std::span<const float> values) const;

 private:
  std::vector<std::string> names_;
  std::vector<std::int32_t> regionOf_;  ///< per vertex; -1: none
};

}  // namespace explica::sampling

template <>
struct explica::EnumNames<explica::sampling::Across> {
  using Way = explica::sampling::Across;
  static constexpr std::array table = {std::pair{Way::None, "none"}, std::pair{Way::Mean, "mean"},
                                       std::pair{Way::Max, "max"}};
};
