// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Types.h"
#include "Explica/IO/VertexDataFile.h"

#include <array>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

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

/// What labels look like, by their number: red, green, blue, opacity in [0, 1].
using LabelColours = std::map<Label, std::array<float, 4>>;

/// The file that colours a label volume's labels, if one lies beside it: MRIcron's `aal.nii.lut`.
[[nodiscard]] std::optional<std::filesystem::path> findColours(const std::filesystem::path& volume);

/// Reads it: 256 bytes each of red, green and blue; the first, of label 0, is left out.
/// @throws IOError  absent or of another form
[[nodiscard]] LabelColours readLabelColours(const std::filesystem::path& file);

/// FreeSurfer's name of a cortical region in aparc+aseg (1001 to 1035 left, 2001 to 2035 right),
/// without side: "bankssts"; empty for any other label.
[[nodiscard]] std::string freeSurferRegion(Label label);

/// Name and colour of a label of aseg or aparc+aseg in FreeSurfer's table; nothing for a label that
/// is not among the cortical regions and the usual structures.
[[nodiscard]] std::optional<LabelEntry> freeSurferEntry(Label label);

/// A colour for a label of no known table; labels near each other differ well.
[[nodiscard]] std::array<float, 4> distinctColour(Label label);

/// Table of the labels that occur: FreeSurfer's names and colours if `freeSurfer`, else distinct
/// colours; `names` win.  Ascending keys.
[[nodiscard]] std::vector<LabelEntry> tableFor(const std::vector<Label>& keys,
                                               const LabelNames& names, bool freeSurfer);

}  // namespace explica::io
