// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace explica::io {

/// One transform as ITK stores it.
struct TransformEntry {
  std::string type;  ///< ITK's name: "AffineTransform_double_3_3"
  std::vector<double> parameters, fixed;
};

/// Writes transforms into an HDF5 file of the layout of itk::HDF5TransformIO: a group a transform
/// under /TransformGroup, parameters packed by deflate.  Equal transforms give equal bytes: the
/// file holds neither times nor the host.
///
/// @throws EnvironmentError  the file cannot be written
void writeHdf5Transform(const std::filesystem::path& path,
                        const std::vector<TransformEntry>& transforms);

}  // namespace explica::io
