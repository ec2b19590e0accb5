// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "BlockWindow.h"
#include "Explica/Core/Types.h"

#include <array>
#include <cstdint>
#include <vector>

namespace explica::segmentation {

/// The brain's voxels as far as edges are concerned; nothing is owned but what is pure.
struct EdgeSamples {
  const std::vector<std::size_t>* voxel = nullptr;                       ///< linear indices
  const std::vector<std::array<std::int32_t, 6>>* neighbours = nullptr;  ///< packed; -1: none
  const std::vector<std::uint8_t>* rim = nullptr;  ///< 1 where a mask's edge may look like fluid's
  const std::vector<float>* intensity = nullptr;   ///< without bias
  Vector spacing = Vector::Ones();                 ///< mm
  std::vector<std::uint8_t> pure;  ///< 1 in white matter beyond doubt: its slopes are noise
};

/// Brightness at which one tissue ends and the next begins, around each voxel.
struct BorderLevels {
  std::vector<float> outer;  ///< between fluid and grey matter
  std::vector<float> white;  ///< between grey and white matter
};

/// Levels at which brightness changes most steeply from place to place.
///
/// A border seen through a point spread is steepest half way between what lies on its two sides.
/// So a level is the mean brightness of the voxels that straddle this border and no other, weighed
/// by their gradient as far as it exceeds that of noise, under a window.  That asks for no pure
/// voxel of either tissue: the narrow fluid of sulci has none, nor have thin blades of white
/// matter, and the myelin of sensory and motor cortex makes it brighter than the rest.  Which
/// voxels straddle a border follows from the levels of the round before.
class BorderFinder {
 public:
  /// @param mean  of fluid, grey and white matter everywhere, rising
  BorderFinder(const BlockWindow& window, const EdgeSamples& samples,
               const std::array<double, 3>& mean);

  /// One more round.
  void improve();

  [[nodiscard]] const BorderLevels& levels() const { return levels_; }

 private:
  void updateLevel(std::vector<float>& level, const std::vector<float>& weight) const;

  const BlockWindow& window_;
  EdgeSamples samples_;
  std::array<double, 3> mean_;
  std::vector<float> slope_, least_, most_;  ///< of each voxel and its neighbours
  float noise_ = 0;  ///< by which it carries white matter's brightest neighbours away
  BorderLevels levels_;
};

/// The intensities as they would be if both borders lay half way between the means everywhere.
[[nodiscard]] std::vector<float> evened(const std::vector<float>& intensity,
                                        const BorderLevels& levels,
                                        const std::array<double, 3>& mean);

}  // namespace explica::segmentation
