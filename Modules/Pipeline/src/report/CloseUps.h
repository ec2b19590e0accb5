// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Report/Mosaic.h"
#include "ResultFolder.h"

#include <cstddef>
#include <vector>

namespace explica::pipeline {

/// Where the most was corrected on a surface's way to a sphere's topology; the largest first.
[[nodiscard]] std::vector<report::CloseUp> correctedPlaces(const StepFolder& surface,
                                                           std::size_t most);

/// Where most of the tissue has no thickness, since no trajectory through it reaches both sides.
[[nodiscard]] std::vector<report::CloseUp> unknownPlaces(const StepFolder& thickness,
                                                         std::size_t most);

/// Where faces cross each other.
[[nodiscard]] std::vector<report::CloseUp> crossingPlaces(const StepFolder& step, std::size_t most);

}  // namespace explica::pipeline
