// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace explica {

/// Frames of a run at most: each holds a whole surface.
inline constexpr int kMostFrames = 1000;

}  // namespace explica
