// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Volume.h"

#include <Eigen/Geometry>

#include <filesystem>

namespace explica::io {

/// Writes T(x) = A (x + u(x)) as an ITK composite transform in HDF5: an affine transform and a
/// displacement field, in ITK's frame (LPS).  ITK, ANTs and 3D Slicer resample a template onto the
/// image with it.
/// @param affine        A, RAS mm
/// @param displacement  u, RAS mm; may be empty
/// @throws EnvironmentError  the file cannot be written
void writeTransform(const std::filesystem::path& path, const Eigen::Affine3d& affine,
                    const Volume<Eigen::Vector3f>& displacement);

}  // namespace explica::io
