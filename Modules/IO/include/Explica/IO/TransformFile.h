// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Volume.h"

#include <Eigen/Geometry>

#include <filesystem>

namespace explica::io {

/// T(x) = A (x + u(x)).
struct StoredTransform {
  Eigen::Affine3d affine = Eigen::Affine3d::Identity();  ///< A, RAS mm
  Volume<Eigen::Vector3f> displacement;                  ///< u, RAS mm; may be empty
};

/// Writes T(x) = A (x + u(x)) as an ITK composite transform in HDF5: an affine transform and a
/// displacement field, in ITK's frame (LPS).  ITK, ANTs and 3D Slicer resample a template onto the
/// image with it.
/// @param affine        A, RAS mm
/// @param displacement  u, RAS mm; may be empty
/// @throws EnvironmentError  the file cannot be written
void writeTransform(const std::filesystem::path& path, const Eigen::Affine3d& affine,
                    const Volume<Eigen::Vector3f>& displacement);

/// Reads what `writeTransform` writes, number for number, and the like of ANTs: an affine transform
/// after at most one displacement field.
/// @throws IOError       missing, damaged or no transform of ITK's
/// @throws InvalidInput  any other transform, or an affine part that cannot be inverted
[[nodiscard]] StoredTransform readTransform(const std::filesystem::path& path);

}  // namespace explica::io
