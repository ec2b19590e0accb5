// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace explica::sampling {

/// Share of the weights, or of the volume, about a place that must be known: with less, most of a
/// value would be made up.
inline constexpr double kEnough = 0.5;

}  // namespace explica::sampling
