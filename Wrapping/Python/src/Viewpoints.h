// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Visibility/Viewpoints.h"

namespace explica::python {

/// Viewpoints (N, 3), RAS mm, of equal weight.
[[nodiscard]] visibility::Viewpoints viewpointsOf(const Eigen::Ref<const Positions>& points);

}  // namespace explica::python
