// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Core/Errors.h"
#include "Explica/IO/VolumeFile.h"
#include "MincFiles.h"
#include "TemporaryFolder.h"

#include <gtest/gtest.h>

#include <string>

namespace {

using namespace explica;
namespace fs = std::filesystem;

/// Values and places that MincFiles.h's files stand for.
void expectWhole(const fs::path& path, const std::string& format) {
  const io::LoadedVolume<float> read = io::readScalars(path);
  EXPECT_EQ(read.origin.format, format);
  EXPECT_EQ(read.origin.storedType, "int16");
  const Grid& grid = read.volume.grid;
  ASSERT_EQ(grid.size, (std::array<int, 3>{4, 3, 2}));
  for (int n = 0; n < 24; ++n) {
    const float expected = n < 12 ? 0.5F * static_cast<float>(n) : 10 + static_cast<float>(n);
    EXPECT_EQ(read.volume[static_cast<std::size_t>(n)], expected) << n;
  }
  // World: 30 x + 5 y - 20 z along the cosines, then 1.5, -2 and 3 mm a step.
  const Vector x(0.8, 0.6, 0), y(-0.6, 0.8, 0), z(0, 0, 1);
  for (const Vector& index : {Vector(0, 0, 0), Vector(3, 0, 0), Vector(1, 2, 1)}) {
    const Point world =
        (30 + 1.5 * index[0]) * x + (5 - 2 * index[1]) * y + (3 * index[2] - 20) * z;
    EXPECT_LT((grid.toWorld(index) - world).norm(), 1e-12) << index.transpose();
  }
}

TEST(Minc, Version1IsScaledSliceBySliceAndPlacedByItsCosines) {
  const TemporaryFolder folder;
  putContent(folder / "a.mnc", minc1Bytes());
  expectWhole(folder / "a.mnc", "MINC 1");
}

TEST(Minc, Version2IsReadFromChunksAndInOnePiece) {
  const TemporaryFolder folder;
  writeMinc2(folder / "packed.mnc", true);
  expectWhole(folder / "packed.mnc", "MINC 2");
  writeMinc2(folder / "plain.mnc", false);
  expectWhole(folder / "plain.mnc", "MINC 2");
}

TEST(Minc, WhatCannotBeUsedIsSaid) {
  const TemporaryFolder folder;
  const auto said = [&](const std::string& bytes) {
    putContent(folder / "a.mnc", bytes);
    return complaintOf<Error>([&] { static_cast<void>(io::readScalars(folder / "a.mnc")); });
  };
  EXPECT_NE(said(minc1Bytes("irregular")).find("not evenly spaced"), std::string::npos);
  std::string renamed = minc1Bytes();
  renamed.replace(renamed.find("zspace"), 6, "qspace");
  EXPECT_NE(said(renamed).find("xspace, yspace and zspace are needed"), std::string::npos);
  std::string other = minc1Bytes();
  other.replace(other.rfind("image", other.find("valid_range")), 5, "imago");
  EXPECT_NE(said(other).find("holds no MINC image"), std::string::npos);
  EXPECT_NE(said(minc1Bytes().substr(0, minc1Bytes().size() - 1)).find("ends before the values"),
            std::string::npos);
  EXPECT_NE(said(std::string("\x89HDF\r\n\x1a\n\7", 9)).find("HDF5"), std::string::npos);
}

TEST(Minc, LabelsStayWholeNumbers) {
  const TemporaryFolder folder;
  std::string bytes = minc1Bytes();
  // Real values 0 to 100 of stored ones 0 to 100 are as stored; of 0 to 50 every other is no label.
  putContent(folder / "a.mnc", bytes);
  EXPECT_NE(complaintOf<InvalidInput>([&] {
              static_cast<void>(io::readLabels(folder / "a.mnc"));
            }).find("no whole number"),
            std::string::npos);
  NetcdfBytes same;
  for (const double value : {100.0, 100.0, 0.0, 0.0}) same.real(value);
  bytes.replace(bytes.size() - 48 - 32, 32, same.bytes);
  putContent(folder / "b.mnc", bytes);
  const auto read = io::readLabels(folder / "b.mnc");
  for (int n = 0; n < 24; ++n) EXPECT_EQ(read.volume[static_cast<std::size_t>(n)], n);
}

}  // namespace
