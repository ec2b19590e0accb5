// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/TriangleMesh.h"

namespace explica::flattening {

/// Share of a surface's area that can be seen from without, by ray casting.
///
/// A flat map is looked at from straight above; any other surface from `viewpoints` points spread
/// evenly over a sphere about it, three times its size: a face counts with the largest share that
/// is seen from any of them.  A convex surface is seen wholly, the bottom of a closed fold not at
/// all.
[[nodiscard]] double seenShare(const TriangleMesh& mesh, int viewpoints = 64);

}  // namespace explica::flattening
