// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Inflation/Inflate.h"

#include <vector>

namespace explica::inflation {

/// What the enclosing sphere saw at an iteration.
struct Look {
  int iteration = 0;
  double visibility = kNaN;  ///< global
  double seen = kNaN;
};

/// As numbers of a checkpoint, and back.
[[nodiscard]] std::vector<double> notesOf(const std::vector<Look>& looks);
/// @throws InvalidInput  no notes of looks
[[nodiscard]] std::vector<Look> looksFrom(const std::vector<double>& notes);

/// Each iteration with what was seen last.
[[nodiscard]] std::vector<InflateRecord> withLooks(
    const std::vector<unfolding::IterationRecord>& steps, const std::vector<Look>& looks);

/// States on the straight pieces between iterations, which collision detection has cleared, evenly
/// spaced in the visibility between the looks.
/// @param path  V x 3 after each iteration, from the start on
[[nodiscard]] std::vector<InflateFrame> framesAlong(const std::vector<Positions>& path,
                                                    const std::vector<Look>& looks, int count);

}  // namespace explica::inflation
