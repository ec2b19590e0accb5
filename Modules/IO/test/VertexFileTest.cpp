// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/IO/VertexFile.h"

#include "Explica/Core/Errors.h"

#include <gtest/gtest.h>

#include <cmath>

namespace explica::io {
namespace {

TEST(VertexFile, NamesKeepTheirFormsAndKinds) {
  EXPECT_EQ(nameWithEntity("a/lh.thickness", "fwhm-5"), "lh.thickness_fwhm-5");
  EXPECT_EQ(nameWithEntity("thickness.shape.gii", "fwhm-5"), "thickness_fwhm-5.shape.gii");
  EXPECT_EQ(nameWithEntity("sub-01_hemi-L_thickness.shape.gii", "space-fsaverage_den-10k"),
            "sub-01_hemi-L_space-fsaverage_den-10k_thickness.shape.gii");
  EXPECT_EQ(nameWithEntity("lh.aparc.annot", "x-1"), "lh.aparc_x-1.annot");
  EXPECT_EQ(nameWithEntity("bold.func.gii.gz", "x-1"), "bold_x-1.func.gii");
  EXPECT_EQ(nameWithEntity("lh.area.mgh", "x-1"), "lh.area_x-1.shape.gii");
}

TEST(VertexFile, WritesWhatItReads) {
  const auto folder = std::filesystem::path(::testing::TempDir());
  Eigen::VectorXd values(4);
  values << 1, 2, kNaN, 4;
  const VertexMap map{"thickness", "mm", values};
  writeVertexMaps(folder / "vf.func.gii", {map, map}, "CortexLeft", 2);
  const auto back = readVertexMaps(folder / "vf.func.gii", 4);
  ASSERT_EQ(back.size(), 2U);
  EXPECT_TRUE(std::isnan(back[1].values[2]));
  EXPECT_EQ(back[0].values[3], 4);
  EXPECT_EQ(vertexFileKind(folder / "vf.func.gii"), VertexFileKind::Maps);
  writeVertexMaps(folder / "lh.vf", {map}, "", 2);
  EXPECT_EQ(readVertexMaps(folder / "lh.vf", 4).front().values[0], 1);
  EXPECT_THROW(writeVertexMaps(folder / "lh.vf", {map, map}, "", 2), InvalidInput);
}

TEST(VertexFile, NumbersAreKeysOfLabelsOrTheFirstMap) {
  const auto folder = std::filesystem::path(::testing::TempDir());
  LabelMap labels;
  labels.keys.resize(3);
  labels.keys << 0, 7, 0;
  labels.table = {{0, "none", {}}, {7, "cortex", {}}};
  writeGiftiLabel(folder / "lh.inside.label.gii", labels, "CortexLeft");
  EXPECT_EQ(readVertexNumbers(folder / "lh.inside.label.gii", 3), Eigen::Vector3d(0, 7, 0));
  const VertexMap map{"inside", "", Eigen::Vector3d(0, 1, 0.5)};
  writeVertexMaps(folder / "lh.inside.shape.gii", {map, map}, "CortexLeft", 1);
  EXPECT_EQ(readVertexNumbers(folder / "lh.inside.shape.gii", 3), Eigen::Vector3d(0, 1, 0.5));
  EXPECT_THROW((void)readVertexNumbers(folder / "lh.inside.shape.gii", 4), InvalidInput);
  EXPECT_TRUE(namesLabels("a/lh.aparc.annot"));
  EXPECT_TRUE(namesLabels("lh.cortex.label"));
  EXPECT_TRUE(namesLabels("parcels.label.gii.gz"));
  EXPECT_FALSE(namesLabels("lh.label.shape.gii"));
}

}  // namespace
}  // namespace explica::io
