// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Report/Mosaic.h"
#include "ResultFolder.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace explica::pipeline {

/// Where the most was corrected on a surface's way to a sphere's topology; the largest first.
[[nodiscard]] std::vector<report::CloseUp> correctedPlaces(const StepFolder& surface,
                                                           std::size_t most);

/// Where most of the tissue has no thickness, since no trajectory through it reaches both sides.
[[nodiscard]] std::vector<report::CloseUp> unknownPlaces(const StepFolder& thickness,
                                                         std::size_t most);

/// Two faces that cross at the start of a step, as intersections.tsv lists them.
struct CrossingPair {
  Point place = Point::Zero();  ///< RAS mm
  std::array<std::int32_t, 2> faces{};
  bool inRegion = false;  ///< one of them, at least
  bool parted = false;
};
[[nodiscard]] std::vector<CrossingPair> crossingPairs(const StepFolder& step);

/// Where faces cross each other: pairs within 3 mm are one place; those of the region first, then
/// those with the most pairs.
[[nodiscard]] std::vector<report::CloseUp> crossingPlaces(const std::vector<CrossingPair>& pairs,
                                                          std::size_t most);

}  // namespace explica::pipeline
