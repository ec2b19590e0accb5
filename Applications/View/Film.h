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

/// Whether writeFilm() will be able to.
/// @throws UsageError        neither .gif nor .mp4 nor .webm
/// @throws EnvironmentError  ffmpeg is needed and not installed
void requireFilmFormat(const std::filesystem::path& path);

/// Writes .gif; .mp4 and .webm by ffmpeg.  Whole or not at all.
/// @throws EnvironmentError  ffmpeg failed
void writeFilm(const std::filesystem::path& path, const std::vector<report::Picture>& frames,
               double framesPerSecond);

}  // namespace explica::app
