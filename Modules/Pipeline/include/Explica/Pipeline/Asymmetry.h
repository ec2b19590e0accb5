// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

namespace explica::pipeline {

/// A table of the regions that both hemispheres have, from their regions.tsv: name without side;
/// mean thickness (mm) and white area (mm^2) left and right; asymmetry of each, (L - R) divided by
/// the mean of both, so -2 to 2 and 0 where the sides are equal.  "n/a" where a side has no number.
/// Names agree up to _L, _R at their end or lh_, rh_, ctx-lh-, ctx-rh- at their beginning.
/// @throws IOError  a table that is absent or not as `explica surface` writes it
[[nodiscard]] std::string asymmetryTable(const std::filesystem::path& left,
                                         const std::filesystem::path& right);

}  // namespace explica::pipeline
