// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/IO/VolumeSeries.h"

#include "Explica/Core/Errors.h"
#include "Explica/IO/VertexDataFile.h"
#include "RawFiles.h"
#include "TemporaryFolder.h"

#include <gtest/gtest.h>

#include <cmath>

namespace {

using namespace explica;

Grid smallGrid() {
  Grid grid;
  grid.size = {7, 5, 3};
  return grid;
}

/// Seven frames; voxel 4 of frame 2 is not a number.
std::vector<float> writeSeries(const std::filesystem::path& path) {
  const Grid grid = smallGrid();
  std::vector<float> all;
  std::vector<VolumeOnDemand<float>> frames;
  for (int frame = 0; frame < 7; ++frame) {
    const auto value = [frame](std::size_t v) {
      return frame == 2 && v == 4 ? std::nanf("")
                                  : static_cast<float>(frame) + 0.001F * static_cast<float>(v);
    };
    for (std::size_t v = 0; v < grid.voxelCount(); ++v) all.push_back(value(v));
    frames.push_back(
        {grid, 0, 0, grid.voxelCount(), [value](std::size_t first, std::size_t count, float* to) {
           for (std::size_t v = 0; v < count; ++v) to[v] = value(first + v);
         }});
  }
  io::writeFrames(path, frames);
  return all;
}

bool sameBits(const std::vector<float>& a, const std::vector<float>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), 4 * a.size()) == 0;
}

TEST(VolumeSeries, ComesInPiecesOfAnySize) {
  const TemporaryFolder folder;
  for (const char* name : {"a.nii", "a.nii.gz", "a.mgh", "a.mgz"}) {
    const std::vector<float> written = writeSeries(folder / name);
    for (const int piece : {1, 3, 7, 100}) {
      io::VolumeSeries series(folder / name);
      EXPECT_EQ(series.frames(), 7);
      EXPECT_EQ(series.grid().size, smallGrid().size);
      std::vector<float> read;
      for (auto part = series.next(piece); !part.empty(); part = series.next(piece)) {
        EXPECT_LE(part.size(), piece * smallGrid().voxelCount());
        read.insert(read.end(), part.begin(), part.end());
      }
      EXPECT_TRUE(sameBits(read, written)) << name << " in pieces of " << piece;
    }
    io::VolumeSeries third(folder / name, {.frame = 3});
    EXPECT_EQ(third.frames(), 1);
    EXPECT_EQ(third.next(9)[0], 3.0F) << name;
    EXPECT_TRUE(third.next(9).empty());
    EXPECT_THROW(io::VolumeSeries(folder / name, {.frame = 7}), InvalidInput);
  }
}

TEST(VolumeSeries, ThatEndsTooEarlyIsRefused) {
  const TemporaryFolder folder;
  for (const char* name : {"a.nii", "a.nii.gz", "a.mgz"}) {
    writeSeries(folder / name);
    const std::string content = contentOf(folder / name);
    putContent(folder / name, content.substr(0, content.size() - content.size() / 4));
    EXPECT_THROW(
        {
          io::VolumeSeries series(folder / name);
          while (!series.next(2).empty()) {
          }
        },
        IOError)
        << name;
  }
}

TEST(VolumeSeries, OfOtherFormatsIsHeldWhole) {
  const TemporaryFolder folder;
  std::vector<float> values;
  for (std::size_t v = 0; v < smallGrid().voxelCount(); ++v) {
    values.insert(values.end(), {1, 2, 3});
  }
  for (const bool nrrd : {true, false}) {
    putContent(folder / "a", itkImage(nrrd, smallGrid().size, values));
    io::VolumeSeries series(folder / "a");
    ASSERT_EQ(series.frames(), 3);
    EXPECT_EQ(series.next(1)[0], 1.0F);
    EXPECT_EQ(series.next(2).back(), 3.0F);
  }
}

TEST(GiftiMaps, AreWrittenOneByOneAndKeepNaN) {
  const TemporaryFolder folder;
  const std::vector<float> first = {1, 2, std::nanf("")}, second = {4, 5, 6};
  {
    io::GiftiMapsWriter writer(folder / "a.func.gii", "CortexLeft", 2, 1.5);
    writer.add("frame 0", "", first);
    EXPECT_THROW(writer.finish(), InvalidInput);
    writer.add("frame 1", "mm", second);
    EXPECT_FALSE(std::filesystem::exists(folder / "a.func.gii"));
    writer.finish();
  }
  const std::vector<io::VertexMap> maps = io::readVertexMaps(folder / "a.func.gii", 3);
  ASSERT_EQ(maps.size(), 2U);
  EXPECT_EQ(maps[0].name, "frame 0");
  EXPECT_TRUE(std::isnan(maps[0].values[2]));
  EXPECT_EQ(maps[1].values[2], 6);
  EXPECT_NE(contentOf(folder / "a.func.gii").find("<Value>1500</Value>"), std::string::npos);
}

}  // namespace
