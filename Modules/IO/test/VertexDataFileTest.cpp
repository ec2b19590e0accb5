// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Core/Errors.h"
#include "Explica/IO/VertexDataFile.h"
#include "Explica/IO/VolumeFile.h"
#include "Explica/Testing/FreeSurferLabel.h"
#include "TemporaryFolder.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

namespace {

using namespace explica;

Eigen::VectorXd someValues() {
  Eigen::VectorXd values(7);
  values << 0, -1.5, 1.0 / 3, 2.25, 1e-20, 1e20, 4;
  return values;
}

Eigen::VectorXd rounded(const Eigen::VectorXd& values) {
  return values.cast<float>().cast<double>();
}

TEST(VertexMaps, GiftiKeepsNamesUnitsAndFloats) {
  const TemporaryFolder folder;
  const auto file = folder / "a.shape.gii";
  io::writeGiftiShape(file, {{"thickness", "mm", someValues()}, {"sulc", "", -someValues()}},
                      "CortexLeft");
  const std::vector<io::VertexMap> maps = io::readVertexMaps(file, 7);
  ASSERT_EQ(maps.size(), 2U);
  EXPECT_EQ(maps[0].name, "thickness");
  EXPECT_EQ(maps[0].unit, "mm");
  EXPECT_EQ(maps[0].values, rounded(someValues()));
  EXPECT_EQ(maps[1].name, "sulc");
  EXPECT_EQ(maps[1].values, rounded(-someValues()));
}

TEST(VertexMaps, NotANumberBecomesZeroAndIsCounted) {
  const TemporaryFolder folder;
  Eigen::VectorXd values = someValues();
  values[2] = std::nan("");
  EXPECT_EQ(io::writeGiftiShape(folder / "a.shape.gii", {{"a", "", values}}, "Other"), 1);
  EXPECT_EQ(io::readVertexMaps(folder / "a.shape.gii")[0].values[2], 0);
}

TEST(VertexMaps, CurvNewAndOldAndMghOverlaysAreRead) {
  const TemporaryFolder folder;
  io::writeFreeSurferCurv(folder / "lh.thickness", someValues(), 10);
  const std::vector<io::VertexMap> curv = io::readVertexMaps(folder / "lh.thickness");
  EXPECT_EQ(curv.at(0).name, "thickness");
  EXPECT_EQ(curv.at(0).values, rounded(someValues()));
  EXPECT_EQ(curv.at(0).unit, "mm");
  io::writeFreeSurferCurv(folder / "lh.thickness_t", someValues(), 10);
  EXPECT_EQ(io::readVertexMaps(folder / "lh.thickness_t").at(0).unit, "");

  putContent(folder / "lh.old", std::string("\0\0\2\0\0\1\0\x7b\xff\x85", 10));
  EXPECT_EQ(io::readVertexMaps(folder / "lh.old").at(0).values, Eigen::Vector2d(1.23, -1.23));

  Grid grid;
  grid.size = {7, 1, 1};
  Volume<float> overlay(grid);
  for (int v = 0; v < 7; ++v) overlay[v] = static_cast<float>(someValues()[v]);
  io::writeVolume(folder / "lh.area.mgz", overlay);
  const io::VertexMap area = io::readVertexMaps(folder / "lh.area.mgz").at(0);
  EXPECT_EQ(area.values, rounded(someValues()));
  EXPECT_EQ(area.unit, "mm^2");
}

TEST(VertexMaps, TheWrongNumberOfValuesIsRefusedWithBothNumbers) {
  const TemporaryFolder folder;
  io::writeFreeSurferCurv(folder / "lh.curv", someValues(), 10);
  const std::string complaint = complaintOf<InvalidInput>(
      [&] { static_cast<void>(io::readVertexMaps(folder / "lh.curv", 8)); });
  EXPECT_NE(complaint.find("7 values"), std::string::npos) << complaint;
  EXPECT_NE(complaint.find("8 vertices"), std::string::npos) << complaint;
  EXPECT_THROW(
      io::writeGiftiShape(folder / "b.shape.gii",
                          {{"a", "", someValues()}, {"b", "", Eigen::VectorXd::Ones(3)}}, "Other"),
      InvalidInput);
}

io::LabelMap someLabels() {
  io::LabelMap labels;
  labels.name = "parts";
  labels.keys.resize(5);
  labels.keys << 0, 7, 7, 2, 0;
  labels.table = {{0, "unknown", {0, 0, 0, 0}},
                  {2, "in & out", {1, 0.2F, 0, 1}},
                  {7, "insula", {0, 0.4F, 0.8F, 1}}};
  return labels;
}

void expectSameLabels(const io::LabelMap& read, const io::LabelMap& written) {
  EXPECT_EQ(read.keys, written.keys);
  ASSERT_EQ(read.table.size(), written.table.size());
  for (std::size_t e = 0; e < read.table.size(); ++e) {
    EXPECT_EQ(read.table[e].key, written.table[e].key);
    EXPECT_EQ(read.table[e].name, written.table[e].name);
    for (std::size_t c = 0; c < 4; ++c) {
      EXPECT_NEAR(read.table[e].colour[c], written.table[e].colour[c], 1e-6);
    }
  }
}

TEST(VertexLabels, GiftiKeepsKeysNamesAndColours) {
  const TemporaryFolder folder;
  io::writeGiftiLabel(folder / "a.label.gii", someLabels(), "CortexLeft");
  expectSameLabels(io::readVertexLabels(folder / "a.label.gii", 5), someLabels());
}

TEST(VertexLabels, AnnotNumbersTheNamesFromZeroOnAndWritesNoVertexWithoutOne) {
  const TemporaryFolder folder;
  io::LabelMap labels = someLabels();
  labels.table.front() = {-1, "none", {0, 0, 0, 0}};
  labels.keys << -1, 7, 7, 2, -1;
  io::writeFreeSurferAnnot(folder / "lh.parts.annot", labels);
  labels.keys << -1, 1, 1, 0, -1;  // nibabel takes keys for places in the list of names
  labels.table[1].key = 0;
  labels.table[2].key = 1;
  expectSameLabels(io::readVertexLabels(folder / "lh.parts.annot", 5), labels);
}

TEST(VertexLabels, AListOfVerticesNeedsTheirNumber) {
  const TemporaryFolder folder;
  Positions positions = Positions::Constant(5, 3, 1.0 / 3);
  explica::test::writeFreeSurferLabel(folder / "lh.part.label", someLabels(), positions);
  const io::LabelMap read = io::readVertexLabels(folder / "lh.part.label", 5);
  Eigen::Matrix<Label, 5, 1> expected;
  expected << 0, 1, 1, 1, 0;
  EXPECT_EQ(read.keys, expected);
  EXPECT_THROW(static_cast<void>(io::readVertexLabels(folder / "lh.part.label")), InvalidInput);
  const std::string complaint = complaintOf<InvalidInput>(
      [&] { static_cast<void>(io::readVertexLabels(folder / "lh.part.label", 3)); });
  EXPECT_NE(complaint.find("vertex 3"), std::string::npos) << complaint;
}

TEST(VertexLabels, KeysWithoutANameAndColoursThatMeetAreRefused) {
  const TemporaryFolder folder;
  io::LabelMap labels = someLabels();
  labels.keys[4] = 3;
  EXPECT_THROW(io::writeGiftiLabel(folder / "a.label.gii", labels, "Other"), InvalidInput);
  labels = someLabels();
  labels.table[1].colour = labels.table[2].colour;
  EXPECT_THROW(io::writeFreeSurferAnnot(folder / "a.annot", labels), InvalidInput);
  EXPECT_EQ(folder.entryCount(), 0);
}

}  // namespace
