// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/IO/VertexDataFile.h"

#include <filesystem>
#include <limits>
#include <string_view>
#include <vector>

namespace explica::io {

/// Key of a vertex that lies in no region.
inline constexpr Label kNoRegion = std::numeric_limits<Label>::lowest();

/// True for what programs call the rest of a surface: "unknown", "???", "Medial_wall", "outside".
[[nodiscard]] bool meansNoRegion(std::string_view name);

/// Reads the regions of one surface from one or several label files (all that readVertexLabels
/// knows), one LabelMap a file, named after it.
///
/// Vertices off all regions have the key kNoRegion, the table holds the regions that have vertices
/// and no others, and no name occurs twice: of names that several files share, each is preceded by
/// its file's.  Regions of different files may overlap.
/// @throws as readVertexLabels; InvalidInput also for a file without a region
[[nodiscard]] std::vector<LabelMap> readRegions(const std::vector<std::filesystem::path>& files,
                                                Eigen::Index vertexCount);

/// Numbers labels by their names as the first map does, so that files with other tables agree;
/// names that it lacks are added to its table.
void numberAlike(std::vector<LabelMap>& files);

/// Vertices that have one of the keys in any of the label files; without keys, any key but 0.
/// @return V marks, at least one of them true
/// @throws as readVertexLabels; InvalidInput also if no vertex is marked
[[nodiscard]] std::vector<bool> markedByLabels(const std::vector<std::filesystem::path>& files,
                                               const std::vector<int>& keys,
                                               Eigen::Index vertexCount);

/// Vertices in the regions of these names.
/// @return V marks, at least one of them true
/// @throws as readRegions; InvalidInput also for a name that no region has
[[nodiscard]] std::vector<bool> markedByNames(const std::filesystem::path& file,
                                              const std::vector<std::string>& names,
                                              Eigen::Index vertexCount);

}  // namespace explica::io
