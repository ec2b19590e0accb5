// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/TriangleMesh.h"
#include "Explica/Report/Figure.h"
#include "Explica/Report/Picture.h"

#include <filesystem>
#include <optional>
#include <vector>

namespace explica::app {

/// The surface that an unfolding began with, as its first frame shows it.
/// @throws InvalidInput  no frames
[[nodiscard]] TriangleMesh firstFrame(const std::filesystem::path& folder);

/// The frames of an unfolding: its region in colour, how far it is seen below.
/// @param paint  in place of the region's colour
/// @param views  side by side; empty: from the viewpoint of the unfolding
/// @param focus  the region fills the picture; else all of the surface is seen
/// @throws InvalidInput  no frames, or a map that does not fit
[[nodiscard]] std::vector<report::Picture> drawFilm(
    const std::filesystem::path& folder, const std::optional<report::SurfacePaint>& paint,
    std::vector<report::FigureView> views, int columns, bool focus,
    const report::SurfacePictureOptions& options);

}  // namespace explica::app
