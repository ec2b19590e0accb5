// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Patch.h"

namespace explica::unfolding {

/// Takes from a velocity field the part that changes the areas of the region's faces to first
/// order: V - J^T l with J J^T l = J V, by conjugate gradients [Thesis, Eq. 5.48 and 5.49].
///
/// J holds the derivatives of the areas; those of the squared areas of [Thesis, Eq. 5.47] are
/// multiples of them, row by row, and span the same space.
/// @param velocity  V x 3; only rows of moving vertices may differ from zero, and stay the others
/// @return iterations of the solver
int keepAreas(const Patch& patch, const Positions& x, const std::vector<std::int32_t>& unknown,
              Positions& velocity);

}  // namespace explica::unfolding
