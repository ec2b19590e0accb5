// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Application/Context.h"
#include "Explica/Shapes/HarmonicAnnulus.h"

namespace explica::app {

/// Writes the convex combinations (1 - w) a + w b for w = 0, ..., 1: each as a file, side by side
/// in series.svg (figure 3.7 of [Thesis]) and one after the other in series.gif.
/// @param count  shapes, both ends among them, >= 2
/// @param grid   voxels per side
void writeSeries(Context& context, const shapes::HarmonicShape& a, const shapes::HarmonicShape& b,
                 int count, int grid);

}  // namespace explica::app
