// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "LayFlat.h"

namespace explica::flattening {

/// u of the conformal map into the plane, V, whose lengths are exp(u) times those of the surface
/// and that keeps the lengths of the rim: Laplace(u) = K with u = 0 on the rim, where the curvature
/// K is the angle that is missing about a vertex [BenChen2008].
[[nodiscard]] Eigen::VectorXd scaleFactor(const IntrinsicDisc& disc);

}  // namespace explica::flattening
