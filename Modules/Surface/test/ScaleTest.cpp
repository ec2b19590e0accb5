// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Core/Errors.h"
#include "Explica/Geometry/MeshMeasures.h"
#include "Explica/Surface/CorticalSurface.h"
#include "Explica/Testing/Grids.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

namespace explica::surface {
namespace {

CorticalSurfaces surfacesAt(double unit) {
  TissueOptions labels;
  labels.preset = LabelPreset::ThreeClass;
  labels.white = {3};
  labels.grey = {2};
  SurfaceOptions options;
  options.faces = 6000;
  return buildSurfaces(tissueFromLabels(testing::wavyBall(unit), labels), options);
}

const CorticalSurfaces& inMillimetres() {
  static const CorticalSurfaces made = surfacesAt(1);
  return made;
}

class Scale : public ::testing::TestWithParam<int> {};

TEST_P(Scale, ByAPowerOfTwoChangesNoBitOfTheResult) {
  const double unit = std::ldexp(1.0, GetParam());
  const CorticalSurfaces& here = inMillimetres();
  const CorticalSurfaces there = surfacesAt(unit);
  EXPECT_EQ(there.white.mesh.faces, here.white.mesh.faces);
  EXPECT_EQ(there.white.mesh.positions, unit * here.white.mesh.positions);
  EXPECT_EQ(there.mid.positions, unit * here.mid.positions);
  EXPECT_EQ(there.pial.positions, unit * here.pial.positions);
  EXPECT_EQ(there.thickness, unit * here.thickness);
  EXPECT_EQ(there.sulcalDepth, unit * here.sulcalDepth);
  EXPECT_EQ(unit * there.curvature, here.curvature);
  EXPECT_GT(here.endedAtBank, 0);
  EXPECT_EQ(there.endedAtBank, here.endedAtBank);
  EXPECT_EQ(there.heldBackPial, here.heldBackPial);
}

INSTANTIATE_TEST_SUITE_P(VoxelSizes, Scale, ::testing::Values(-20, 20));

TEST(Scale, ByAThousandChangesTheResultByRounding) {
  const CorticalSurfaces& here = inMillimetres();
  const double thickness = meanThickness(here.columns.area, here.columns.thickness),
               white = geometry::totalArea(here.white.mesh), pial = geometry::totalArea(here.pial);
  // Rounding makes another mesh of the same surface.  Its vertices start elsewhere beside the
  // buried sulci: meshes at eight units have means of thickness with a deviation of 0.5 per cent.
  constexpr double kSurface = 1e-3, kMeshes = 0.02;
  for (const double unit : {1e-3, 1e3}) {
    const CorticalSurfaces there = surfacesAt(unit);
    EXPECT_NEAR(geometry::totalArea(there.white.mesh) / (unit * unit), white, kSurface * white);
    EXPECT_NEAR(meanThickness(there.columns.area, there.columns.thickness) / unit, thickness,
                kMeshes * thickness);
    EXPECT_NEAR(geometry::totalArea(there.pial) / (unit * unit), pial, kMeshes * pial);
  }
}

TEST(Scale, TooFarFromTheOriginForTheFilesNumbersIsRefused) {
  Volume<Label> labels = testing::wavyBall(1);
  labels.grid.origin += Vector(1e6, 0, 0);
  TissueOptions tissue;
  tissue.white = {3};
  tissue.grey = {2};
  SurfaceOptions options;
  options.faces = 2000;
  try {
    static_cast<void>(buildSurfaces(tissueFromLabels(labels, tissue), options));
    FAIL() << "accepted";
  } catch (const InvalidInput& refused) {
    EXPECT_NE(std::string(refused.what()).find("from the origin"), std::string::npos);
  }
}

}  // namespace
}  // namespace explica::surface
