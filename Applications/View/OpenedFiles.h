// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/TriangleMesh.h"
#include "Explica/Viewer/Window.h"

#include <filesystem>
#include <optional>
#include <string>

namespace explica::app {

/// True if the name is that of a volume's file.
[[nodiscard]] bool isVolume(const std::filesystem::path& path);

/// True if the folder holds what `explica unfold` writes.
[[nodiscard]] bool isUnfolding(const std::filesystem::path& folder);

/// The surface that an unfolding began with: its input if that is still there, else its first
/// frame.
/// @throws InvalidInput, IOError  neither can be read
struct StartingSurface {
  TriangleMesh mesh;
  std::string file;
};
[[nodiscard]] StartingSurface startOfUnfolding(const std::filesystem::path& folder);

/// What the window shows of a file or folder on a surface: maps, labels, slices of a volume, the
/// states of a finished unfolding.
/// @throws InvalidInput, IOError  nothing that fits the surface
[[nodiscard]] viewer::Opened openForWindow(const std::filesystem::path& path,
                                           const TriangleMesh& surface);

/// Colours as in the pictures of `explica view --screenshot`.
[[nodiscard]] viewer::Scale scaleOf(const Eigen::VectorXd& values);

}  // namespace explica::app
