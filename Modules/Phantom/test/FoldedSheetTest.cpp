// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Phantom/FoldedSheet.h"

#include "Explica/Core/Errors.h"
#include "Explica/Geometry/MeshMeasures.h"
#include "Explica/Geometry/SelfIntersection.h"

#include <Eigen/Geometry>

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

namespace explica::phantom {
namespace {

/// Mean of the normals' z over the area of faces with all vertices in the region.
double visibilityFromAbove(const FoldedSheet& sheet) {
  std::vector<bool> in(static_cast<std::size_t>(sheet.mesh.vertexCount()), false);
  for (const std::int32_t v : sheet.region) in[v] = true;
  double flux = 0, area = 0;
  for (Eigen::Index f = 0; f < sheet.mesh.faceCount(); ++f) {
    const auto& faces = sheet.mesh.faces;
    if (!in[faces(f, 0)] || !in[faces(f, 1)] || !in[faces(f, 2)]) continue;
    const Vector cross = (sheet.mesh.corner(f, 1) - sheet.mesh.corner(f, 0))
                             .cross(sheet.mesh.corner(f, 2) - sheet.mesh.corner(f, 0));
    flux += cross.z();
    area += cross.norm();
  }
  return flux / area;
}

TEST(FoldedSheet, HasTheThesisSurfacesVisibilityAndNoCrossing) {
  const FoldedSheet sheet = makeFoldedSheet();
  EXPECT_NEAR(visibilityFromAbove(sheet), 0.2, 0.01);
  EXPECT_TRUE(geometry::findSelfIntersections(sheet.mesh).empty());
  EXPECT_GT(sheet.mesh.faceCount(), 6000);
}

TEST(FoldedSheet, WithoutWindingItsVisibilityIsTheBesselFunctionAndItsAreaThatOfTheFlatSheet) {
  FoldedSheetOptions options;
  options.winding = 0;
  options.edge = 0.25;
  for (const double turn : {0.0, 1.0, 2.0}) {
    options.turn = turn;
    const FoldedSheet sheet = makeFoldedSheet(options);
    EXPECT_NEAR(visibilityFromAbove(sheet), std::cyl_bessel_j(0, turn), 1e-3) << turn;
    EXPECT_NEAR(geometry::totalArea(sheet.mesh) / (options.length * options.width), 1, 1e-3);
  }
}

TEST(FoldedSheet, RefusesWhatWouldTouchOrCannotBeMeshed) {
  const auto with = [](auto change) {
    FoldedSheetOptions options;
    change(options);
    return options;
  };
  EXPECT_THROW((void)makeFoldedSheet(with([](auto& o) { o.turn = 2.3; })), InvalidInput);
  EXPECT_THROW((void)makeFoldedSheet(with([](auto& o) { o.winding = 20; })), InvalidInput);
  EXPECT_THROW((void)makeFoldedSheet(with([](auto& o) { o.edge = 5; })), InvalidInput);
  EXPECT_THROW((void)makeFoldedSheet(with([](auto& o) { o.edge = 1e-6; })), InvalidInput);
  EXPECT_THROW((void)makeFoldedSheet(with([](auto& o) { o.waves = 1; })), InvalidInput);
}

}  // namespace
}  // namespace explica::phantom
