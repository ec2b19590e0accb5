// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Unfolding/Unfold.h"

namespace explica::unfolding {

/// States on the path whose visibilities are evenly spaced, first and last included.
/// @param path  of the moving vertices, one state per iteration
[[nodiscard]] std::vector<UnfoldFrame> framesAlong(const Unfolder& unfolder,
                                                   const visibility::Viewpoints& viewpoints,
                                                   const std::vector<Positions>& path, int count);

}  // namespace explica::unfolding
