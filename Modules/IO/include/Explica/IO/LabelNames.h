// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Types.h"

#include <filesystem>
#include <map>
#include <optional>
#include <string>

namespace explica::io {

/// What labels are called, by their number.
using LabelNames = std::map<Label, std::string>;

/// The file that names a label volume's labels, if one lies beside it: BIDS's
/// `sub-01_atlas-AAL_dseg.tsv`, or MRIcron's `aal.nii.txt`.
[[nodiscard]] std::optional<std::filesystem::path> findLegend(const std::filesystem::path& volume);

/// Reads a legend: a table with the columns `index` and `name` (BIDS), or lines of a number and a
/// name, anything after them ignored; empty lines and lines that start with '#' are skipped.
/// @throws IOError       absent or unreadable
/// @throws InvalidInput  a line without number and name: names file and line
[[nodiscard]] LabelNames readLabelNames(const std::filesystem::path& legend);

/// FreeSurfer's name of a cortical region in aparc+aseg (1001 to 1035 left, 2001 to 2035 right),
/// without side: "bankssts"; empty for any other label.
[[nodiscard]] std::string freeSurferRegion(Label label);

}  // namespace explica::io
