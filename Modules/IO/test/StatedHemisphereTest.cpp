// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Geometry/Fixtures.h"
#include "Explica/IO/StatedHemisphere.h"
#include "Explica/IO/SurfaceFile.h"
#include "Explica/IO/VertexDataFile.h"
#include "TemporaryFolder.h"

#include <gtest/gtest.h>

#include <array>
#include <string>

namespace {

using namespace explica;

std::optional<Hemisphere> ofText(const TemporaryFolder& folder, const std::string& text) {
  putContent(folder / "stated.gii", "<?xml version=\"1.0\"?>\n<GIFTI>" + text + "</GIFTI>");
  return io::statedHemisphere(folder / "stated.gii");
}

TEST(StatedHemisphere, GiftiSaysItOfFileOrArrayAndWinsOverTheName) {
  const TemporaryFolder folder;
  EXPECT_EQ(
      ofText(folder, "<MD><Name>AnatomicalStructurePrimary</Name><Value>CortexRight</Value></MD>"),
      Hemisphere::Right);
  EXPECT_EQ(ofText(folder,
                   "<DataArray><MD><Name><![CDATA[AnatomicalStructurePrimary]]></Name>\n"
                   "<Value><![CDATA[CortexLeft]]></Value></MD></DataArray>"),
            Hemisphere::Left);
  EXPECT_EQ(ofText(folder,
                   "<MD><Name>AnatomicalStructurePrimary</Name><Value>Other</Value></MD>"
                   "<MD><Name>Comment</Name><Value>CortexLeft</Value></MD>"),
            std::nullopt);
  EXPECT_EQ(ofText(folder, "<MD><Name>AnatomicalStructurePrimary"), std::nullopt);
  io::writeGiftiShape(folder / "lh.a.shape.gii", {{"a", "", Eigen::Vector2d(1, 2)}}, "CortexRight");
  EXPECT_EQ(io::statedHemisphere(folder / "lh.a.shape.gii"), Hemisphere::Right);
}

TEST(StatedHemisphere, NamesSayItWhereTheContentDoesNot) {
  const TemporaryFolder folder;
  const TriangleMesh mesh = geometry::makeIcosphere(1, 10.0);
  struct Row {
    const char* name;
    std::optional<Hemisphere> stated;
  };
  for (const Row& row :
       {Row{"lh.white", Hemisphere::Left}, Row{"rh.pial", Hemisphere::Right},
        Row{"sub-01_hemi-L_pial.off", Hemisphere::Left},
        Row{"100307.R.white.ply", Hemisphere::Right},
        Row{"x_gray_surface_left_81920.obj", Hemisphere::Left},
        Row{"wm_rh.surf.gii", Hemisphere::Right}, Row{"white.off", std::nullopt}}) {
    io::writeSurface(folder / row.name, mesh);
    EXPECT_EQ(io::statedHemisphere(folder / row.name), row.stated) << row.name;
  }
  io::writeGiftiShape(folder / "rh.a.shape.gii", {{"a", "", Eigen::Vector2d(1, 2)}}, "Other");
  EXPECT_EQ(io::statedHemisphere(folder / "rh.a.shape.gii"), Hemisphere::Right);
  EXPECT_EQ(io::statedHemisphere(folder / "lh.absent"), Hemisphere::Left);
}

TEST(WithoutSide, NamesOfBothSidesAreTheSame) {
  using Names = std::array<std::string, 3>;
  for (const auto& [left, right, both] :
       {Names{"lh.thickness", "rh.thickness", "thickness"},
        Names{"ctx-lh-insula", "ctx-rh-insula", "insula"}, Names{"Insula_L", "Insula_R", "Insula"},
        Names{"thick_left", "thick_right", "thick"}}) {
    EXPECT_EQ(io::withoutSide(left), both);
    EXPECT_EQ(io::withoutSide(right), both);
  }
  EXPECT_EQ(io::withoutSide("curv"), "curv");
}

}  // namespace
