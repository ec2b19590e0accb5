// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/IO/SurfaceFile.h"

#include <optional>
#include <string>

namespace explica::io {

/// A FreeSurfer volume as files describe it in words.
struct VolumeText {
  Vector size = Vector::Zero();
  Vector spacing = Vector::Zero();
  Eigen::Matrix3d axes = Eigen::Matrix3d::Zero();  ///< columns xras, yras, zras
  Vector centre = Vector::Zero();                  ///< cras
};

/// @throws InvalidInput  no proper volume
[[nodiscard]] Grid gridOfVolumeText(const std::filesystem::path& path, const VolumeText& text);

/// What a file says about the frame of its coordinates.
struct FrameInFile {
  std::string stated;             ///< a frame that is no surface RAS; empty if the file is silent
  std::optional<Grid> tkrVolume;  ///< coordinates are surface RAS of this volume
};

/// Applies the rule of SurfaceSpace to a surface just read; sets origin.space, applied and notes.
void moveToScanner(LoadedSurface& surface, const FrameInFile& frame,
                   const SurfaceReadOptions& options);

/// Geometric type and secondary structure from names such as lh.inflated,
/// sub-01_hemi-L_pial.surf.gii; what the name does not tell stays.
void setTypesFromName(const std::filesystem::path& path, SurfaceMetadata& metadata);

}  // namespace explica::io
