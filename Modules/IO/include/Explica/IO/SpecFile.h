// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace explica::io {

/// A file that Workbench opens with a scene.
struct SpecEntry {
  std::string structure;       ///< as SurfaceMetadata::structure
  std::filesystem::path file;  ///< written relative to the spec's folder; its kind follows the name
};

/// Writes a Workbench `.spec`: the surfaces, metrics, labels and volumes that belong together.
/// @throws InvalidInput      a file whose name Workbench does not know
/// @throws EnvironmentError  the file cannot be written
void writeSpec(const std::filesystem::path& path, const std::vector<SpecEntry>& entries);

}  // namespace explica::io
