// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "VolumeFormats.h"

#include <algorithm>
#include <array>
#include <optional>

namespace explica::io {
namespace {

// Everything is big-endian.  Bytes: 0 version, 4 width, height, depth, frames, type, dof (int32),
// 28 goodRASFlag (int16), 30 spacing[3], 42 Mdc by columns [9], 78 centre c_r, c_a, c_s (float32).
constexpr std::size_t kHeader = 284;
constexpr std::size_t kSpacing = 30;
constexpr std::size_t kAxes = 42;
constexpr std::size_t kCentre = 78;

struct MghType {
  int code;
  StoredType type;
};
// Codes of MGH headers.
constexpr MghType kMghTypes[] = {{0, StoredType::UInt8},
                                 {1, StoredType::Int32},
                                 {3, StoredType::Float32},
                                 {4, StoredType::Int16},
                                 {10, StoredType::UInt16}};

std::optional<StoredType> typeOf(int code) {
  for (const MghType& row : kMghTypes) {
    if (row.code == code) return row.type;
  }
  return {};
}

/// The number at the start of one of FreeSurfer's tags (its `tags.h`).
bool isTag(std::int32_t number) {
  constexpr std::array<std::array<std::int32_t, 2>, 5> kRanges = {
      {{1, 7}, {10, 14}, {20, 24}, {30, 33}, {40, 45}}};
  return std::ranges::any_of(
      kRanges, [number](const auto& range) { return number >= range[0] && number <= range[1]; });
}

/// Tags of old, whose length is not written, or not in one way: what follows cannot be told apart.
bool hasNoLength(std::int32_t tag) {
  // Colour table, which RAS, geometry of a surface, name of a transform.
  return tag == 1 || tag == 2 || tag == 20 || tag == 30;
}

/// How many of these bytes were read.
std::uint64_t skipped(ByteSource& source, std::uint64_t count) {
  std::array<std::uint8_t, 1 << 12> scratch;
  std::uint64_t gone = 0;
  while (gone < count) {
    const std::size_t got =
        source.read(scratch.data(), std::min<std::uint64_t>(scratch.size(), count - gone));
    if (got == 0) break;
    gone += got;
  }
  return gone;
}

/// Reads on to the end: scan parameters, then tags, each a number, the length of what follows and
/// that.
/// @return how many bytes at the end are neither
std::uint64_t bytesAfterTags(ByteSource& source) {
  constexpr std::size_t kParameters = 5 * sizeof(float);
  constexpr std::int64_t kLongest = std::int64_t{16} << 20;  // bytes of a tag
  if (skipped(source, kParameters) < kParameters) return 0;
  std::array<std::uint8_t, 12> head;
  while (true) {
    std::size_t read = source.read(head.data(), 4);
    if (read == 0) return 0;
    const std::int32_t tag = read == 4 ? load<std::int32_t>(head.data(), true) : 0;
    if (!isTag(tag)) return read + source.finish();
    if (hasNoLength(tag)) {
      source.finish();
      return 0;
    }
    read += source.read(head.data() + 4, 8);
    if (read < head.size()) return read;
    const auto length = load<std::int64_t>(head.data() + 4, true);
    if (length < 0 || length > kLongest) return read + source.finish();
    const std::uint64_t gone = skipped(source, static_cast<std::uint64_t>(length));
    if (gone < static_cast<std::uint64_t>(length)) return read + gone;
  }
}

}  // namespace

bool looksLikeMgh(ByteView firstBytes) {
  if (firstBytes.size() < 24 || load<std::int32_t>(firstBytes.data(), true) != 1) return false;
  for (std::size_t i = 1; i <= 4; ++i) {
    if (load<std::int32_t>(firstBytes.data() + 4 * i, true) < 1) return false;
  }
  return true;
}

StoredVolume readMgh(ByteSource& source, const std::filesystem::path&, const VolumeReadOptions&,
                     Extent extent) {
  const std::filesystem::path& path = source.path();
  const Bytes header = source.take(kHeader);
  if (!looksLikeMgh(header)) failToRead(path, "is not an MGH file");
  const auto integer = [&](std::size_t i) {
    return load<std::int32_t>(header.data() + 4 * i, true);
  };
  const auto real = [&](std::size_t at) {
    return static_cast<double>(load<float>(header.data() + at, true));
  };
  StoredVolume volume;
  volume.origin.path = path;
  volume.origin.format = "MGH";
  volume.origin.placement = "header";
  const std::int64_t valueCount =
      checkedProduct(path, {integer(1), integer(2), integer(3), integer(4)});
  const std::array<int, 3> size = {integer(1), integer(2), integer(3)};
  volume.valuesPerVoxel = integer(4);
  volume.origin.storedSize = {size[0], size[1], size[2]};
  if (volume.valuesPerVoxel > 1) volume.origin.storedSize.push_back(integer(4));
  const std::optional<StoredType> type = typeOf(integer(5));
  if (!type) {
    failToRead(path, "has MGH type " + std::to_string(integer(5)) +
                         "; known are 0 uchar, 1 int, 3 float, 4 short, 10 ushort");
  }
  volume.type = *type;
  volume.origin.storedType = nameOf(volume.type);

  Vector spacing = Vector::Ones();
  Eigen::Matrix3d axes;  // FreeSurfer's default: coronal slices
  axes << -1, 0, 0, 0, 0, 1, 0, -1, 0;
  Vector centre = Vector::Zero();
  if (load<std::int16_t>(header.data() + 28, true) > 0) {
    for (int i = 0; i < 3; ++i) {
      spacing[i] = real(kSpacing + 4 * i);
      centre[i] = real(kCentre + 4 * i);
      for (int row = 0; row < 3; ++row) axes(row, i) = real(kAxes + 12 * i + 4 * row);
      if (!(spacing[i] > 0)) {
        refuse(path, "its header gives a voxel size of " + std::to_string(spacing[i]) +
                         " along axis " + std::to_string(i) + "; correct the header");
      }
    }
  } else {
    volume.origin.placement = kNotPlaced;
    volume.origin.notes.push_back(
        "no geometry in the header (goodRASFlag 0): coronal slices of 1 mm assumed, as FreeSurfer "
        "does");
  }
  Eigen::Matrix4d affine = Eigen::Matrix4d::Identity();
  affine.topLeftCorner<3, 3>() = axes * spacing.asDiagonal();
  const Vector middle(0.5 * size[0], 0.5 * size[1],
                      0.5 * size[2]);  // of index space, as FreeSurfer
  affine.topRightCorner<3, 1>() = centre - affine.topLeftCorner<3, 3>() * middle;
  volume.origin.affine = affine;
  volume.grid = gridOf(path, size, affine);
  volume.bigEndian = true;
  if (extent != Extent::Everything) return volume;

  const std::size_t width = widthOf(volume.type);
  volume.values = source.take(static_cast<std::uint64_t>(valueCount) * width);
  if (const std::uint64_t left = bytesAfterTags(source); left > 0) {
    volume.origin.notes.push_back(std::to_string(left) +
                                  " bytes after the last value are not used");
  }
  swapBytes(volume.values.data(), valueCount, width);
  return volume;
}

Bytes mghHeader(const VolumeToWrite& volume) {
  Bytes header(kHeader);
  const auto integer = [&](std::size_t i, std::int32_t value) {
    store(header.data() + 4 * i, value, true);
  };
  const auto real = [&](std::size_t at, double value) {
    store(header.data() + at, static_cast<float>(value), true);
  };
  const Grid& grid = volume.grid;
  integer(0, 1);
  for (int i = 0; i < 3; ++i) integer(i + 1, grid.size[i]);
  integer(4, volume.valuesPerVoxel);
  for (const MghType& row : kMghTypes) {
    if (row.type == volume.type) integer(5, row.code);
  }
  store(header.data() + 28, std::int16_t{1}, true);
  const Point centre = grid.toWorld(0.5 * Vector(grid.size[0], grid.size[1], grid.size[2]));
  for (int i = 0; i < 3; ++i) {
    real(kSpacing + 4 * i, grid.spacing[i]);
    real(kCentre + 4 * i, centre[i]);
    for (int row = 0; row < 3; ++row) real(kAxes + 12 * i + 4 * row, grid.direction(row, i));
  }
  return header;
}

Bytes mghFooter() {
  return Bytes(5 * sizeof(float));
}  // TR, flip angle, TE, TI, field of view

}  // namespace explica::io
