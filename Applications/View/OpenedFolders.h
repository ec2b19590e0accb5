// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Provenance/Json.h"
#include "Explica/Viewer/Window.h"
#include "ShownSurface.h"

#include <filesystem>
#include <optional>

namespace explica::app {

/// A folder's summary.json; empty where there is none.
[[nodiscard]] provenance::Json summaryOf(const std::filesystem::path& folder);
/// True if the folder holds what `explica unfold` writes.
[[nodiscard]] bool isUnfolding(const std::filesystem::path& folder);
/// True if the folder holds what `explica flatten` writes.
[[nodiscard]] bool isFlattening(const std::filesystem::path& folder);
/// True if the folder holds what `explica sample` writes.
[[nodiscard]] bool isSampling(const std::filesystem::path& folder);

/// The surface that a folder is about: of an unfolding the one that it began with (its input if
/// that is still there, else its first frame), of a flattening the patch, of a sampling the middle
/// between white and pial surface; none for other folders.
/// @throws InvalidInput, IOError  it cannot be read
[[nodiscard]] std::optional<ShownSurface> surfaceOfFolder(const std::filesystem::path& folder);

/// What the window shows of a folder on a surface: the states of an unfolding, the flat map and
/// its stacks of depths, sampled maps and their profiles.
/// @throws InvalidInput, IOError  nothing that fits the surface
[[nodiscard]] viewer::Opened openFolder(const std::filesystem::path& folder,
                                        const ShownSurface& surface);

}  // namespace explica::app
