// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ByteSource.h"
#include "Bytes.h"
#include "PackedFile.h"

#include "Explica/Core/Describe.h"
#include "Explica/IO/VolumeFile.h"

#include <array>
#include <cstdint>
#include <optional>
#include <tuple>

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

constexpr auto enumWords(StoredType) {
  using enum StoredType;
  return std::to_array<EnumWord<StoredType>>({{Int8, "int8"},
                                              {UInt8, "uint8"},
                                              {Int16, "int16"},
                                              {UInt16, "uint16"},
                                              {Int32, "int32"},
                                              {UInt32, "uint32"},
                                              {Int64, "int64"},
                                              {UInt64, "uint64"},
                                              {Float32, "float32"},
                                              {Float64, "float64"}});
}

/// Calls action with a null pointer of the stored type.
template <class Action>
void withType(StoredType type, const Action& action) {
  // In the order of StoredType.
  using Types = std::tuple<std::int8_t, std::uint8_t, std::int16_t, std::uint16_t, std::int32_t,
                           std::uint32_t, std::int64_t, std::uint64_t, float, double>;
  const auto tryOne = [&]<std::size_t n>() {
    if (static_cast<std::size_t>(type) != n) return false;
    action(static_cast<const std::tuple_element_t<n, Types>*>(nullptr));
    return true;
  };
  [&]<std::size_t... n>(std::index_sequence<n...>) {
    static_cast<void>((tryOne.template operator()<n>() || ...));
  }
  (std::make_index_sequence<std::tuple_size_v<Types>>{});
}

[[nodiscard]] std::size_t widthOf(StoredType type);

/// The type of this name in small or capital letters, as XML formats have it.
[[nodiscard]] std::optional<StoredType> typeNamed(std::string_view name);

/// Values of one type as real numbers.
[[nodiscard]] std::vector<double> realsOf(ByteView raw, StoredType type, bool bigEndian);

/// A volume as its file has it, native byte order, before values are scaled and converted.
struct StoredVolume {
  VolumeOrigin origin;
  Grid grid;
  std::int64_t valuesPerVoxel = 1;  ///< frames or components
  bool interleaved = false;         ///< components of a voxel stand together; else frame by frame
  StoredType type = StoredType::Float32;
  double slope = 1;
  double intercept = 0;
  bool bigEndian = false;              ///< of values that are still to be read from the source
  std::optional<double> frameSeconds;  ///< time between frames, if the header says it
  Bytes values;                        ///< empty if only the header was asked for
};

/// What a reader of one format is asked for.
enum class Extent {
  Header,
  Positioned,  ///< the header, and the source stands at the first value; where the values are in
               ///< another file, or are interleaved, everything
  Everything
};

/// Tells the format by content and reads it.
[[nodiscard]] StoredVolume readStored(const std::filesystem::path& path,
                                      const VolumeReadOptions& options, Extent extent);

/// As above, from a source that stands at the file's beginning.
[[nodiscard]] StoredVolume readStored(ByteSource& source, const std::filesystem::path& path,
                                      const VolumeReadOptions& options, Extent extent);

/// The file that is opened for a volume's name: `.hdr` for `.img`.
[[nodiscard]] std::filesystem::path openedFor(const std::filesystem::path& path);

/// Puts scaled values of one frame, as it stands in memory in native byte order.
void scaledFloats(const StoredVolume& stored, const std::uint8_t* from, float* to);

/// Grid of an index-to-RAS affine, its axes made exactly orthonormal; errors name the path.
[[nodiscard]] Grid gridOf(const std::filesystem::path& path, const std::array<int, 3>& size,
                          const Eigen::Matrix4d& affine);

/// Checked product of sizes as a header announces them.
/// @throws IOError  a size below 1 or a product beyond 2^40 values
[[nodiscard]] std::int64_t checkedProduct(const std::filesystem::path& path,
                                          const std::vector<std::int64_t>& sizes);

/// Values to be written, made on demand, component by component.
struct VolumeToWrite {
  std::string name;  ///< what it is: the file's name without its ending
  Grid grid;
  StoredType type = StoredType::Float32;
  int valuesPerVoxel = 1;
  bool vectors = false;            ///< the values are components of a vector, not frames
  Bytes elsewhere;                 ///< value of every voxel before `begin` and from `end` on
  std::size_t begin = 0, end = 0;  ///< places in the storage order
  /// Puts one component of voxels [first, first + count), in native byte order.
  std::function<void(int component, std::size_t first, std::size_t count, std::uint8_t* to)> fill;
};

}  // namespace explica::io
