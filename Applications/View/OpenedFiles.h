// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Viewer/Window.h"
#include "ShownSurface.h"

#include <filesystem>

namespace explica::app {

/// True if the name is that of a volume's file.
[[nodiscard]] bool isVolume(const std::filesystem::path& path);

/// A number of things in words: "1 map", "2 maps".
[[nodiscard]] std::string counted(std::size_t count, const char* what);

/// What the window shows of a file or folder on a surface: maps, labels, the
/// states of a finished unfolding.
/// @throws InvalidInput, IOError  nothing that fits the surface
[[nodiscard]] viewer::Opened openForWindow(const std::filesystem::path& path,
                                           const ShownSurface& surface);

/// A file's labels in the colours of its own table.
/// @throws as readLabelsOn
[[nodiscard]] viewer::WindowLabels windowLabels(const ShownSurface& surface,
                                                const std::filesystem::path& path);

}  // namespace explica::app
