// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/TriangleMesh.h"
#include "Explica/IO/VertexDataFile.h"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace explica::app {

/// The surface in the window, on which everything else is opened.
struct ShownSurface {
  TriangleMesh mesh;
  std::string file;
  std::optional<Vector> direction = {};  ///< from which it is best seen: surface to eye
  /// Of a patch: its vertices in the whole surface, whose maps and labels fit, too.
  std::vector<std::int32_t> origin = {};
  Eigen::Index wholeCount = 0;  ///< vertices of that whole
};

/// Maps of a file on the surface's vertices.  Where nothing was measured, a map holds NaN and not
/// the 0 that files have there: off the `valid.shape.gii` beside the file, and where a thickness is
/// 0 (FreeSurfer's medial wall).
/// @throws InvalidInput, IOError  no maps, or of another surface
[[nodiscard]] std::vector<io::VertexMap> readMapsOn(const ShownSurface& surface,
                                                    const std::filesystem::path& file);

/// Labels of a file on the surface's vertices.
/// @throws InvalidInput, IOError  no labels, or of another surface
[[nodiscard]] io::LabelMap readLabelsOn(const ShownSurface& surface,
                                        const std::filesystem::path& file);

}  // namespace explica::app
