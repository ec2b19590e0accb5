// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Bytes.h"
#include "PackedFile.h"

#include "Explica/IO/VolumeFile.h"

#include <array>
#include <cstdint>

namespace explica::io {

enum class StoredType {
  Int8,
  UInt8,
  Int16,
  UInt16,
  Int32,
  UInt32,
  Int64,
  UInt64,
  Float32,
  Float64
};

[[nodiscard]] std::size_t widthOf(StoredType type);
[[nodiscard]] const char* nameOf(StoredType type);

/// A volume as its file has it, native byte order, before values are scaled and converted.
struct StoredVolume {
  VolumeOrigin origin;
  Grid grid;
  std::int64_t valuesPerVoxel = 1;  ///< frames or components
  bool interleaved = false;         ///< components of a voxel stand together; else frame by frame
  StoredType type = StoredType::Float32;
  double slope = 1;
  double intercept = 0;
  Bytes values;  ///< empty if only the header was asked for
};

/// What a reader of one format is asked for.
enum class Extent { Header, Everything };

/// Tells the format by content and reads it.
[[nodiscard]] StoredVolume readStored(const std::filesystem::path& path,
                                      const VolumeReadOptions& options, Extent extent);

/// Grid of an index-to-RAS affine, its axes made exactly orthonormal; errors name the path.
[[nodiscard]] Grid gridOf(const std::filesystem::path& path, const std::array<int, 3>& size,
                          const Eigen::Matrix4d& affine);

/// Checked product of sizes as a header announces them.
/// @throws IOError  a size below 1 or a product beyond 2^40 values
[[nodiscard]] std::int64_t checkedProduct(const std::filesystem::path& path,
                                          const std::vector<std::int64_t>& sizes);

/// Values to be written: planar (frame by frame) or interleaved, as `body` produces them.
struct VolumeToWrite {
  Grid grid;
  StoredType type = StoredType::Float32;
  int valuesPerVoxel = 1;
  /// Puts native values [begin, begin + count) of the sequence, frame by frame or interleaved.
  std::function<void(std::size_t begin, std::size_t count, bool interleaved, std::uint8_t* to)>
      fill;
};

}  // namespace explica::io
