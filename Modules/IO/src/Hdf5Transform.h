// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Bytes.h"

#include <filesystem>
#include <string>
#include <vector>

namespace explica::io {

/// One transform as ITK stores it.
struct TransformEntry {
  std::string type;  ///< ITK's name: "AffineTransform_double_3_3"
  std::vector<double> parameters, fixed;
};

constexpr std::size_t kMostTransforms = 1000;  ///< in a file; a pipeline's have a dozen

[[nodiscard]] bool looksLikeHdf5(ByteView bytes);

/// Transforms of an HDF5 file of the layout of itk::HDF5TransformIO, in their order.
///
/// HDF5's library (1.10) checks few of the addresses in a file and crashes on some hundredth of
/// damaged ones, so that it reads in a process of its own.
///
/// @param bytes  the whole file
/// @throws IOError           damaged, or not of that layout
/// @throws EnvironmentError  no process could be made
[[nodiscard]] std::vector<TransformEntry> readHdf5Transform(const std::filesystem::path& path,
                                                            ByteView bytes);

/// Writes transforms into such a file: a group a transform under /TransformGroup, parameters packed
/// by deflate.  Equal transforms give equal bytes: the file holds neither times nor the host.
///
/// @throws EnvironmentError  the file cannot be written
void writeHdf5Transform(const std::filesystem::path& path,
                        const std::vector<TransformEntry>& transforms);

}  // namespace explica::io
