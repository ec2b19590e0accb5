// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Sampling/Depth.h"

#include "Explica/Core/Errors.h"
#include "Explica/Geometry/Fixtures.h"
#include "Explica/Geometry/MeshMeasures.h"

#include <gtest/gtest.h>

#include <cmath>

namespace explica::sampling {
namespace {

TEST(Depths, AreANumberOrAList) {
  EXPECT_EQ(depthsFromText("1"), std::vector<double>{0.5});
  EXPECT_EQ(depthsFromText("3"), (std::vector<double>{0, 0.5, 1}));
  EXPECT_EQ(depthsFromText("0"), std::vector<double>{0});
  EXPECT_EQ(depthsFromText("1.0"), std::vector<double>{1});
  EXPECT_EQ(depthsFromText("0.25,0,1"), (std::vector<double>{0.25, 0, 1}));
  for (const char* text : {"", "-1", "1001", "0.5,", "0.5,x", "1.5", "nan", "0.5,0.5", "3 4"}) {
    EXPECT_THROW(static_cast<void>(depthsFromText(text)), InvalidInput) << text;
  }
}

TEST(Depths, OfEqualVolumeSplitACylinderWallAndAShellAsTheyShould) {
  // Between spheres of 10 and 14 mm the column's area grows with the square of the radius; the
  // linear law is off by 0.3 % of the way there.
  const TriangleMesh white = geometry::makeIcosphere(5, 10.0),
                     pial = geometry::makeIcosphere(5, 14.0);
  const double inner = geometry::enclosedVolume(white),
               all = geometry::enclosedVolume(pial) - inner;
  for (const double depth : {0.0, 0.25, 0.5, 0.75, 1.0}) {
    TriangleMesh at = white;
    at.positions = positionsAtDepth(white, pial, depth, DepthKind::Volume);
    EXPECT_NEAR((geometry::enclosedVolume(at) - inner) / all, depth, 0.005) << depth;
    at.positions = positionsAtDepth(white, pial, depth, DepthKind::Depth);
    EXPECT_NEAR(at.positions.row(7).norm(), 10 + 4 * depth, 1e-9);
  }
  // Where the area does grow linearly, the law is exact: r^2 between 3 and 5 about an axis.
  const Eigen::VectorXd a = Eigen::VectorXd::Constant(1, 3), b = Eigen::VectorXd::Constant(1, 5);
  const double share = shareOfWay(a, b, 0.5, DepthKind::Volume)[0];
  EXPECT_NEAR(std::pow(3 + 2 * share, 2), 0.5 * (9 + 25), 1e-12);
  EXPECT_NEAR(shareOfWay(b, a, 0.5, DepthKind::Volume)[0], 1 - share, 1e-12);
  EXPECT_EQ(shareOfWay(a, a, 0.3, DepthKind::Volume)[0], 0.3);
}

TEST(Depths, NeedSurfacesThatCorrespond) {
  const TriangleMesh white = geometry::makeIcosphere(2, 10.0);
  TriangleMesh other = geometry::makeIcosphere(2, 12.0);
  other.faces.row(3).reverseInPlace();
  EXPECT_THROW(static_cast<void>(positionsAtDepth(white, other, 0.5, DepthKind::Depth)),
               InvalidInput);
  EXPECT_THROW(requireCorresponding(white, geometry::makeIcosphere(3, 12.0)), InvalidInput);
}

}  // namespace
}  // namespace explica::sampling
