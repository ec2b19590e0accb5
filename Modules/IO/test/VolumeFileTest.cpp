// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Core/Errors.h"
#include "Explica/Core/Parallel.h"
#include "Explica/IO/VolumeFile.h"
#include "TemporaryFolder.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include <cmath>
#include <cstring>
#include <random>
#include <string>

namespace {

using namespace explica;
namespace fs = std::filesystem;

/// Oblique, anisotropic, of odd sizes, left-handed if asked.
Grid obliqueGrid(bool leftHanded = false) {
  Grid grid;
  grid.size = {7, 5, 4};
  grid.spacing = {0.7, 1.3, 2.5};
  grid.direction = (Eigen::AngleAxisd(0.4, Vector(1, 2, 3).normalized()) *
                    Eigen::AngleAxisd(-0.9, Vector::UnitX()))
                       .toRotationMatrix();
  if (leftHanded) grid.direction.col(0) *= -1;
  grid.origin = {-31.25, 17.5, 8.75};
  return grid;
}

/// Largest distance between the places of equal voxels, mm.
double placementError(const Grid& a, const Grid& b) {
  double worst = 0;
  for (int corner = 0; corner < 8; ++corner) {
    const Vector index((corner & 1) ? a.size[0] : 0, (corner & 2) ? a.size[1] : 0,
                       (corner & 4) ? a.size[2] : 0);
    worst = std::max(worst, (a.toWorld(index) - b.toWorld(index)).norm());
  }
  return worst;
}

Volume<float> numbered(const Grid& grid) {
  Volume<float> volume(grid);
  for (std::size_t v = 0; v < volume.size(); ++v) {
    volume[v] = static_cast<float>(std::sin(static_cast<double>(v)) * std::exp2(v % 17));
  }
  return volume;
}

TEST(VolumeFile, APlaceThatNoScannerGivesIsRefused) {
  TemporaryFolder folder;
  struct Case {
    double spacing, offset;
    const char* words;  ///< of the sentence; empty: read
  };
  for (const Case& c : {Case{2e-6, 9e6, ""}, Case{9e5, 0, ""}, Case{5e-7, 0, "voxel size"},
                        Case{2e6, 0, "voxel size"}, Case{1, 2e7, "from the origin"}}) {
    Volume<float> volume = numbered(obliqueGrid());
    volume.grid.spacing.setConstant(c.spacing);
    volume.grid.origin = Point(0, -c.offset, 0);
    const fs::path path = folder / "far.nii.gz";
    io::writeVolume(path, volume);
    std::string said;
    try {
      static_cast<void>(io::readScalars(path));
    } catch (const Error& error) {
      said = error.what();
    }
    EXPECT_EQ(said.empty(), c.words[0] == 0) << said;
    EXPECT_NE(said.find(c.words), std::string::npos) << said;
  }
}

// One contract for every format.
class VolumeContract : public testing::TestWithParam<std::tuple<std::string, bool>> {
 protected:
  [[nodiscard]] fs::path file(const std::string& stem) const {
    return folder_ / (stem + std::get<0>(GetParam()));
  }
  [[nodiscard]] static Grid grid() { return obliqueGrid(std::get<1>(GetParam())); }
  TemporaryFolder folder_;
};

TEST_P(VolumeContract, WriteThenReadIsIdentityOnAnObliqueAnisotropicGrid) {
  const Volume<float> written = numbered(grid());
  io::writeVolume(file("a"), written);
  const io::LoadedVolume<float> read = io::readScalars(file("a"));
  EXPECT_EQ(read.volume.grid.size, written.grid.size);
  // Headers keep float32: 40 mm * 2^-24 for each of about 10 operations.
  EXPECT_LT(placementError(read.volume.grid, written.grid), 40 * 10 * std::exp2(-24));
  EXPECT_EQ(read.volume.data, written.data);
  EXPECT_EQ(read.origin.storedType, "float32");
  EXPECT_TRUE(sameGrid(io::readGrid(file("a")), written.grid));
}

TEST_P(VolumeContract, GoingRoundAndRoundDoesNotDrift) {
  Volume<float> volume = numbered(grid());
  for (int round = 0; round < 20; ++round) {
    io::writeVolume(file("a"), volume);
    volume = io::readScalars(file("a")).volume;
  }
  EXPECT_LT(placementError(volume.grid, grid()), 40 * 20 * std::exp2(-24));
}

TEST_P(VolumeContract, LabelsTakeTheSmallestIntegerThatHoldsThem) {
  struct Row {
    Label lowest, highest;
    const char* type;
  };
  for (const Row& row : {Row{0, 255, "uint8"}, Row{0, 256, "int16"}, Row{-1, 3, "int16"},
                         Row{0, 32768, "int32"}, Row{-32769, 0, "int32"}}) {
    Volume<Label> written(grid());
    written(1, 2, 3) = row.lowest;
    written(6, 4, 0) = row.highest;
    io::writeVolume(file("labels"), written);
    const io::LoadedVolume<Label> read = io::readLabels(file("labels"));
    EXPECT_EQ(read.volume.data, written.data);
    EXPECT_EQ(read.origin.storedType, row.type);
  }
}

TEST_P(VolumeContract, VectorsKeepTheirComponents) {
  Volume<Eigen::Vector3f> written(grid(), Eigen::Vector3f::Zero());
  for (std::size_t v = 0; v < written.size(); ++v) {
    written[v] = Eigen::Vector3f(static_cast<float>(v), -2.5F * static_cast<float>(v), 1.0F / 3);
  }
  io::writeVolume(file("vectors"), written);
  EXPECT_EQ(io::readVectors(file("vectors")).volume.data, written.data);
  EXPECT_THROW(static_cast<void>(io::readScalars(file("vectors"))), InvalidInput);
  const Volume<float> y = io::readScalars(file("vectors"), {.frame = 1}).volume;
  EXPECT_EQ(y[10], -25.0F);
}

TEST_P(VolumeContract, EveryTruncationIsRefused) {
  io::writeVolume(file("a"), numbered(grid()));
  const std::string whole = contentOf(file("a"));
  // MGH's scan parameters after the data may be missing: 20 bytes, as in FreeSurfer's own readers.
  const std::size_t optional = std::get<0>(GetParam()) == ".mgh" ? 20 : 0;
  for (std::size_t kept = 0; kept < whole.size() - optional; kept += 1 + kept / 16) {
    putContent(file("cut"), whole.substr(0, kept));
    const std::string complaint =
        complaintOf<Error>([&] { static_cast<void>(io::readScalars(file("cut"))); });
    EXPECT_NE(complaint.find("cut"), std::string::npos) << kept << " bytes: " << complaint;
  }
}

TEST_P(VolumeContract, NanAndAllZeroAreRefusedUnlessAllowed) {
  Volume<float> volume(grid());
  io::writeVolume(file("zero"), volume);
  EXPECT_NE(complaintOf<InvalidInput>([&] {
              static_cast<void>(io::readScalars(file("zero")));
            }).find("every voxel is 0"),
            std::string::npos);
  EXPECT_NO_THROW(static_cast<void>(io::readScalars(file("zero"), {.allowAllZero = true})));
  volume(3, 4, 2) = std::nanf("");
  io::writeVolume(file("nan"), volume);
  const std::string complaint =
      complaintOf<InvalidInput>([&] { static_cast<void>(io::readScalars(file("nan"))); });
  EXPECT_NE(complaint.find("(3, 4, 2)"), std::string::npos) << complaint;
  EXPECT_TRUE(
      std::isnan(io::readScalars(file("nan"), {.allowNonFinite = true, .allowAllZero = true})
                     .volume(3, 4, 2)));
}

TEST_P(VolumeContract, BytesDoNotDependOnTheNumberOfThreads) {
  Grid large = grid();
  large.size = {61, 53, 47};  // several blocks of the compressor
  const Volume<float> volume = numbered(large);
  std::string first;
  for (const int threads : {1, 2, 4}) {
    setThreadCount(threads);
    io::writeVolume(file("threads"), volume);
    if (first.empty()) first = contentOf(file("threads"));
    EXPECT_TRUE(contentOf(file("threads")) == first) << threads << " threads";
  }
  setThreadCount(0);
  EXPECT_EQ(io::readScalars(file("threads")).volume.data, volume.data);
}

TEST_P(VolumeContract, ValuesMadeOnDemandGiveTheSameFile) {
  Grid large = grid();
  large.size = {64, 64, 100};  // whole blocks of the compressor before, between and after
  const std::size_t slice = 64 * 64;
  Volume<float> scalars(large, -1.5F);
  Volume<Label> labels(large, 7);
  Volume<Eigen::Vector3f> vectors(large, Eigen::Vector3f::Zero());
  for (std::size_t v = 40 * slice + 5; v < 60 * slice - 7; ++v) {
    scalars[v] = static_cast<float>(std::sin(static_cast<double>(v)));
    labels[v] = static_cast<Label>(v % 5) - 2;
    vectors[v] = Eigen::Vector3f(scalars[v], static_cast<float>(labels[v]), 2);
  }
  const auto onDemand = [&]<class T>(T elsewhere, const auto& valueOf) {
    VolumeOnDemand<T> made{large, elsewhere, 40 * slice, 60 * slice, {}};
    made.fill = [valueOf](std::size_t first, std::size_t count, T* to) {
      for (std::size_t v = 0; v < count; ++v) to[v] = valueOf(first + v);
    };
    return made;
  };
  const auto same = [&](const auto& held, const auto& made) {
    io::writeVolume(file("same"), held);  // a header may name its file
    const auto content = contentOf(file("same"));
    io::writeVolume(file("same"), made);
    EXPECT_EQ(volumeOf(made).data, held.data);
    return contentOf(file("same")) == content;
  };
  EXPECT_TRUE(same(scalars, onDemand(-1.5F, [&](std::size_t v) { return scalars[v]; })));
  EXPECT_TRUE(same(labels, onDemand(Label{7}, [&](std::size_t v) { return labels[v]; })));
  VectorsOnDemand components;
  for (int c = 0; c < 3; ++c) {
    components[c] = onDemand(0.0F, [&vectors, c](std::size_t v) { return vectors[v][c]; });
  }
  EXPECT_TRUE(same(vectors, components));
}

TEST_P(VolumeContract, ASliceIsTwoDimensional) {
  Grid flat = grid();
  flat.size = {6, 9, 1};
  io::writeVolume(file("slice"), numbered(flat));
  EXPECT_EQ(io::readScalars(file("slice"), {.dimension = 2}).volume.grid.dimension(), 2);
  const std::string complaint = complaintOf<InvalidInput>(
      [&] { static_cast<void>(io::readScalars(file("slice"), {.dimension = 3})); });
  EXPECT_NE(complaint.find("two-dimensional"), std::string::npos) << complaint;
}

INSTANTIATE_TEST_SUITE_P(Formats, VolumeContract,
                         testing::Combine(testing::Values(".nii", ".nii.gz", ".mgh", ".mgz"),
                                          testing::Bool()),
                         [](const auto& instance) {
                           std::string name = std::get<0>(instance.param).substr(1);
                           if (name == "nii.gz") name = "niigz";
                           return name +
                                  (std::get<1>(instance.param) ? "LeftHanded" : "RightHanded");
                         });

// A NIfTI-1 header to bend: 2 x 2 x 2 bytes, 1..8.
class NiftiHeader : public testing::Test {
 protected:
  NiftiHeader() {
    Grid grid;
    grid.size = {2, 2, 2};
    grid.spacing = {1, 2, 3};
    grid.origin = {10, 20, 30};
    Volume<std::uint8_t> volume(grid);
    for (std::size_t v = 0; v < 8; ++v) volume[v] = static_cast<std::uint8_t>(v + 1);
    io::writeVolume(path_, volume);
    bytes_ = contentOf(path_);
  }
  template <class T>
  void set(std::size_t at, T value) {
    std::memcpy(bytes_.data() + at, &value, sizeof(T));
  }
  void setCodes(short qform, short sform) {
    set<short>(252, qform);
    set<short>(254, sform);
  }
  void moveSform(float millimetres) { set<float>(280 + 12, 10 + millimetres); }
  void shearSform() { set<float>(280 + 4, 0.5F); }
  io::LoadedVolume<float> read(io::PlacementChoice choice = io::PlacementChoice::Agreed) {
    putContent(path_, bytes_);
    return io::readScalars(path_, {.placement = choice});
  }
  std::string complaint(io::PlacementChoice choice = io::PlacementChoice::Agreed) {
    return complaintOf<InvalidInput>([&] { static_cast<void>(read(choice)); });
  }
  TemporaryFolder folder_;
  fs::path path_ = folder_ / "a.nii";
  std::string bytes_;
};

TEST_F(NiftiHeader, EqualPlacementsAreUsedAndRecorded) {
  const io::VolumeOrigin origin = read().origin;
  EXPECT_EQ(origin.placement, "sform and qform agree");
  EXPECT_EQ(origin.qformCode, 1);
  EXPECT_EQ(origin.sformCode, 1);
  EXPECT_EQ(origin.affine(2, 3), 30);
}

TEST_F(NiftiHeader, TheOnlyPlacementIsUsed) {
  moveSform(5);
  setCodes(1, 0);
  EXPECT_EQ(read().origin.placement, "qform");
  EXPECT_EQ(read().volume.grid.origin[0], 10);
  setCodes(0, 4);
  EXPECT_EQ(read().origin.placement, "sform");
  EXPECT_EQ(read().volume.grid.origin[0], 15);
}

TEST_F(NiftiHeader, DifferentPlacementsAreRefusedWithBothRemedies) {
  moveSform(5);
  for (const auto& [qform, sform] : {std::pair{1, 2}, {1, 4}, {1, 1}, {2, 1}}) {
    setCodes(static_cast<short>(qform), static_cast<short>(sform));
    const std::string sentence = complaint();
    EXPECT_NE(sentence.find("--xform qform"), std::string::npos) << sentence;
    EXPECT_NE(sentence.find("--xform sform"), std::string::npos) << sentence;
    EXPECT_EQ(read(io::PlacementChoice::Qform).volume.grid.origin[0], 10);
    EXPECT_EQ(read(io::PlacementChoice::Sform).volume.grid.origin[0], 15);
    EXPECT_EQ(read(io::PlacementChoice::Sform).origin.placement, "sform");
  }
}

TEST_F(NiftiHeader, RoundingIsNoDifference) {
  moveSform(0.001F);
  EXPECT_EQ(read().origin.placement, "sform and qform agree");
}

TEST_F(NiftiHeader, NoPlacementIsRefusedUnlessNoneIsChosen) {
  setCodes(0, 0);
  EXPECT_NE(complaint().find("--xform none"), std::string::npos) << complaint();
  const io::LoadedVolume<float> loaded = read(io::PlacementChoice::None);
  EXPECT_EQ(loaded.volume.grid.origin, Point(0, 0, 0));
  EXPECT_EQ(loaded.volume.grid.spacing, Vector(1, 2, 3));
  EXPECT_EQ(loaded.origin.placement, "none");
}

TEST_F(NiftiHeader, AShearedSformIsRefusedAndNeverSilentlyReplaced) {
  shearSform();
  setCodes(0, 1);
  EXPECT_NE(complaint().find("sheared"), std::string::npos) << complaint();
  setCodes(1, 1);
  EXPECT_NE(complaint().find("--xform qform"), std::string::npos) << complaint();
  EXPECT_NE(complaint(io::PlacementChoice::Sform).find("sheared"), std::string::npos);
  EXPECT_EQ(read(io::PlacementChoice::Qform).volume.grid.origin, Point(10, 20, 30));
}

TEST_F(NiftiHeader, AVoxelSizeOfZeroIsRefused) {
  set<float>(76 + 8, 0.0F);
  setCodes(1, 0);
  EXPECT_NE(complaint().find("voxel size"), std::string::npos) << complaint();
  for (const std::size_t row : {280U, 296U, 312U}) set<float>(row + 4, 0.0F);
  setCodes(0, 1);
  EXPECT_NE(complaint().find("length 0"), std::string::npos) << complaint();
}

TEST_F(NiftiHeader, AQuaternionThatIsNoRotationIsRefused) {
  set<float>(256, 3.0F);
  EXPECT_NE(complaint(io::PlacementChoice::Qform).find("quaternion"), std::string::npos);
}

TEST_F(NiftiHeader, MicrometresBecomeMillimetres) {
  bytes_[123] = 3;
  const io::LoadedVolume<float> loaded = read();
  EXPECT_NEAR(loaded.volume.grid.spacing[2], 0.003, 1e-9);
  EXPECT_NEAR(loaded.volume.grid.origin[2], 0.03, 1e-8);
  EXPECT_EQ(loaded.origin.notes.size(), 1U);
}

TEST_F(NiftiHeader, SlopeAndInterceptScale) {
  set<float>(112, 0.5F);
  set<float>(116, -3.0F);
  EXPECT_EQ(read().volume[7], 1.0F);
  const std::string sentence =
      complaintOf<InvalidInput>([&] { static_cast<void>(io::readLabels(path_)); });
  EXPECT_NE(sentence.find("whole number"), std::string::npos) << sentence;
}

TEST_F(NiftiHeader, BigEndianIsUnderstood) {
  std::string swapped = bytes_;
  const auto swap = [&](std::size_t at, std::size_t width, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) {
      std::reverse(swapped.begin() + at + i * width, swapped.begin() + at + (i + 1) * width);
    }
  };
  swap(0, 4, 1);
  swap(40, 2, 8);
  swap(68, 2, 4);
  swap(76, 4, 8);
  swap(108, 4, 3);
  swap(252, 2, 2);
  swap(256, 4, 18);
  const Volume<float> little = read().volume;
  putContent(path_, swapped);
  const Volume<float> big = io::readScalars(path_).volume;
  EXPECT_EQ(big.data, little.data);
  EXPECT_TRUE(sameGrid(big.grid, little.grid, 0));
}

TEST_F(NiftiHeader, SeveralVolumesNeedAChoice) {
  set<short>(40, 4);
  set<short>(46, 1);
  set<short>(48, 2);
  EXPECT_NE(complaint().find("--frame"), std::string::npos) << complaint();
  EXPECT_EQ(io::readScalars(path_, {.frame = 1}).volume[0], 5.0F);
  EXPECT_THROW(static_cast<void>(io::readScalars(path_, {.frame = 2})), InvalidInput);
  EXPECT_THROW(static_cast<void>(io::readVectors(path_)), InvalidInput);
}

TEST_F(NiftiHeader, HeaderAndImageInTwoFilesAreUnderstood) {
  set<float>(108, 0.0F);
  std::memcpy(bytes_.data() + 344, "ni1", 4);
  putContent(folder_ / "pair.hdr", bytes_.substr(0, 348));
  putContent(folder_ / "pair.img", bytes_.substr(352));
  EXPECT_EQ(io::readScalars(folder_ / "pair.hdr").volume[7], 8.0F);
  EXPECT_EQ(io::readScalars(folder_ / "pair.img").volume[7], 8.0F);
  fs::remove(folder_ / "pair.img");
  EXPECT_THROW(static_cast<void>(io::readScalars(folder_ / "pair.hdr")), IOError);
}

TEST(VolumeFile, ChecksumsHoldWhereverABlockCeasesToBeBlank) {
  const TemporaryFolder folder;
  Grid grid;
  grid.size = {64, 64, 129};  // two blocks of the compressor and a part of one
  constexpr std::size_t kBlock = std::size_t{1} << 18;
  for (const std::size_t first : {std::size_t{0}, std::size_t{1}, kBlock / 2, kBlock - 1, kBlock,
                                  2 * kBlock - 4000, 2 * kBlock, 2 * kBlock + 4095}) {
    for (const std::size_t count : {std::size_t{1}, std::size_t{2048}, std::size_t{5000}}) {
      Volume<Label> labels(grid, 0);
      const std::size_t end = std::min(first + count, labels.size());
      for (std::size_t v = first; v < end; ++v) labels[v] = static_cast<Label>(1 + v % 3);
      io::writeVolume(folder / "labels.nii.gz", labels);
      EXPECT_EQ(io::readLabels(folder / "labels.nii.gz").volume.data, labels.data)
          << count << " voxels from " << first << " on";
    }
  }
}

TEST(VolumeFile, SeveralGzipMembersInARowAreOneFile) {
  const TemporaryFolder folder;
  const Volume<float> written = numbered(obliqueGrid());
  io::writeVolume(folder / "plain.nii", written);
  const std::string whole = contentOf(folder / "plain.nii");
  std::string members;
  for (const auto& [begin, count] : {std::pair<std::size_t, std::size_t>{0, 100},
                                     {100, 0},
                                     {100, 300},
                                     {400, whole.size() - 400}}) {
    putContent(folder / "part", whole.substr(begin, count));
    ASSERT_EQ(std::system(("gzip -9 -c '" + (folder / "part").string() + "' > '" +
                           (folder / "part.gz").string() + "'")
                              .c_str()),
              0);
    members += contentOf(folder / "part.gz");
  }
  putContent(folder / "members.nii.gz", members + std::string(12, '\0'));  // and padding
  EXPECT_EQ(io::readScalars(folder / "members.nii.gz").volume.data, written.data);
  members[members.size() - 6] ^= 1;  // the last member's checksum
  putContent(folder / "damaged.nii.gz", members);
  EXPECT_THROW(static_cast<void>(io::readScalars(folder / "damaged.nii.gz")), IOError);
}

TEST(VolumeFile, WhatIsNoImageIsNamed) {
  const TemporaryFolder folder;
  putContent(folder / "text.nii.gz", "this is no image, only a line of text");
  putContent(folder / "empty.nii", "");
  struct Row {
    fs::path path;
    const char* words;
  };
  for (const Row& row :
       {Row{folder / "missing.nii.gz", "no such file"}, Row{folder / "text.nii.gz", "not an image"},
        Row{folder / "empty.nii", "is empty"}, Row{folder.path(), "is a folder"}}) {
    const std::string complaint =
        complaintOf<IOError>([&] { static_cast<void>(io::readLabels(row.path)); });
    EXPECT_NE(complaint.find(row.words), std::string::npos) << complaint;
    EXPECT_NE(complaint.find(row.path.string()), std::string::npos) << complaint;
  }
}

TEST(VolumeFile, AnUnknownEndingIsRefusedAndNothingIsWritten) {
  const TemporaryFolder folder;
  Grid grid;
  grid.size = {1, 1, 1};
  EXPECT_THROW(io::writeVolume(folder / "a.xyz", Volume<float>(grid)), InvalidInput);
  EXPECT_THROW(io::writeVolume(folder / "a.nii", Volume<float>()), InvalidInput);
  EXPECT_EQ(folder.entryCount(), 0);
}

TEST(VolumeFile, OwnFilesAreReadBackForEveryOrderOfAxesAndNearHalfTurns) {
  const TemporaryFolder folder;
  for (const double tiltRad : {0.0, 1e-4, 1e-3, 0.02}) {  // of FreeSurfer's half turns, from exact
    for (int order = 0; order < 48; ++order) {
      constexpr int kOrders[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2},
                                     {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
      Grid grid;
      grid.size = {400, 2, 2};
      Eigen::Matrix3d axes = Eigen::Matrix3d::Zero();
      for (int a = 0; a < 3; ++a) axes(kOrders[order / 8][a], a) = (order >> a) & 1 ? -1 : 1;
      grid.direction =
          Eigen::AngleAxisd(tiltRad, Vector(1, 2, 3).normalized()).toRotationMatrix() * axes;
      io::writeVolume(folder / "a.nii", Volume<std::uint8_t>(grid, 1));
      Grid read;
      ASSERT_NO_THROW(read = io::readGrid(folder / "a.nii")) << order << ", tilt " << tiltRad;
      EXPECT_LT(placementError(read, grid), 1e-3) << order << ", tilt " << tiltRad;
    }
  }
}

TEST(VolumeFile, MghWithoutGeometryIsCoronalAsInFreeSurfer) {
  const TemporaryFolder folder;
  Grid grid;
  grid.size = {4, 6, 8};
  io::writeVolume(folder / "a.mgh", Volume<std::uint8_t>(grid, 1));
  std::string bytes = contentOf(folder / "a.mgh");
  bytes[29] = 0;  // goodRASFlag
  putContent(folder / "a.mgh", bytes);
  const io::LoadedVolume<float> read = io::readScalars(folder / "a.mgh");
  EXPECT_EQ(read.volume.grid.direction.col(0), Vector(-1, 0, 0));
  EXPECT_EQ(read.volume.grid.direction.col(1), Vector(0, 0, -1));
  EXPECT_EQ(read.volume.grid.direction.col(2), Vector(0, 1, 0));
  EXPECT_EQ(read.volume.grid.toWorld(Vector(2, 3, 4)), Point(0, 0, 0));
  EXPECT_EQ(read.origin.notes.size(), 1U);
}

TEST(VolumeFile, MghTagsAreToldFromWhatIsNone) {
  const TemporaryFolder folder;
  Grid grid;
  grid.size = {4, 6, 8};
  io::writeVolume(folder / "a.mgh", Volume<std::uint8_t>(grid, 1));
  const std::string whole = contentOf(folder / "a.mgh");
  const auto notesWith = [&](const std::string& more) {
    putContent(folder / "a.mgh", whole + more);
    return io::readScalars(folder / "a.mgh").origin.notes;
  };
  using Notes = std::vector<std::string>;
  const auto word = [](std::size_t bytes, int value) {
    return std::string(bytes - 1, '\0') + static_cast<char>(value);
  };
  const std::string command = word(4, 3) + word(8, 6) + "mri_a\n";
  const std::string transform = word(4, 31) + word(8, 5) + "a.xfm";
  const std::string oldTable = word(4, 1) + "anything";
  for (const std::string& tags : {std::string(), command, transform, command + transform + command,
                                  command + oldTable, word(4, 30) + word(4, 6) + "a.xfm"}) {
    EXPECT_EQ(notesWith(tags), Notes()) << tags.size();
  }
  const auto unused = [](std::size_t bytes) {
    return Notes{std::to_string(bytes) + " bytes after the last value are not used"};
  };
  EXPECT_EQ(notesWith("Dear reader, this is a letter."), unused(30));
  EXPECT_EQ(notesWith(command + "abc"), unused(3));
  EXPECT_EQ(notesWith(command + word(4, 99) + word(8, 0)), unused(12));
  EXPECT_EQ(notesWith(word(4, 3) + word(8, 7) + "mri_a\n"), unused(18));
  EXPECT_EQ(notesWith(word(4, 3) + std::string(8, '\xFF') + "abcd"), unused(16));
  EXPECT_EQ(notesWith(std::string(40, '\0')), unused(40));
}

TEST(VolumeFile, ManySlicesNeedNiftiTwo) {
  const TemporaryFolder folder;
  Grid grid;
  grid.size = {40000, 1, 2};
  grid.direction = obliqueGrid(true).direction;
  Volume<std::uint8_t> volume(grid, 7);
  io::writeVolume(folder / "long.nii.gz", volume);
  const io::LoadedVolume<Label> read = io::readLabels(folder / "long.nii.gz");
  EXPECT_EQ(read.origin.format, "NIfTI-2");
  EXPECT_LT(placementError(read.volume.grid, grid), 1e-9);
}

TEST(Frames, StandInOneFile) {
  const TemporaryFolder folder;
  Grid grid;
  grid.size = {5, 4, 3};
  std::vector<VolumeOnDemand<float>> frames;
  for (int frame = 0; frame < 4; ++frame) {
    frames.push_back(
        {grid, 0, 0, grid.voxelCount(), [frame](std::size_t first, std::size_t count, float* to) {
           for (std::size_t v = 0; v < count; ++v) {
             to[v] = static_cast<float>(100 * frame + static_cast<int>(first + v));
           }
         }});
  }
  for (const char* name : {"a.nii.gz", "a.mgz"}) {
    io::writeFrames(folder / name, frames);
    const io::LoadedVolume<float> third = io::readScalars(folder / name, {.frame = 2});
    EXPECT_EQ(third.origin.storedSize, (std::vector<int>{5, 4, 3, 4}));
    EXPECT_EQ(third.volume[59], 259.0F);
  }
  EXPECT_THROW(io::writeFrames(folder / "a.nrrd", frames), InvalidInput);
}

}  // namespace
