// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Ventricle/LongAxis.h"
#include "Explica/Ventricle/Slices.h"

#include <vector>

namespace explica::ventricle {

/// True beyond the basal end of the cavity and less than a quarter of a slice below it: whole
/// slices of a stack across the axis end half a slice below.
[[nodiscard]] bool atBase(const Point& x, const Grid& grid, const LongAxis& axis);

/// Slices that the base may cut: open ones, and those next to a slice towards the base that holds
/// part of a ring only.  A stack that ends with a closed ring shows no cut.
[[nodiscard]] std::vector<bool> cutSlices(const std::vector<Slice>& slices, const Grid& grid,
                                          const LongAxis& axis);

/// True for slices of which nothing reaches the base: their outlines are boundaries of the wall all
/// around.
/// @param axis  with the ends of this frame's cavity
[[nodiscard]] std::vector<bool> intactSlices(const std::vector<Slice>& slices,
                                             const Volume<Label>& heart, const LongAxis& axis);

}  // namespace explica::ventricle
