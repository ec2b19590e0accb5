// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Visibility/GlobalMeasures.h"

#include "Explica/Core/Errors.h"
#include "Explica/Geometry/Fixtures.h"

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include <cmath>

namespace explica::visibility {
namespace {

TEST(HiddenViewingArea, OfASphereIsAreaAndVolumeOnly) {
  // 2 pi r^2 A + 6 pi r V for radius s: 8 pi^2 r s^2 (r + s).
  const double r = 3;
  const double exact = 8 * kPi * kPi * r * (r + 1);
  std::array<double, 2> error{};
  for (int level = 3; level <= 4; ++level) {
    const double found = hiddenViewingArea(geometry::makeIcosphere(level), Point::Zero(), r);
    error[static_cast<std::size_t>(level - 3)] = std::abs(found / exact - 1);
  }
  EXPECT_LT(error[1], 0.05);
  EXPECT_GT(std::log2(error[0] / error[1]), 0.7);  // first order: the own face is left out
}

TEST(HiddenViewingArea, DependsOnAreaAndVolumeOnlyForFoldedSurfacesToo) {
  const TriangleMesh folded = geometry::makeFoldedSphere(4, 1.0, 0.15, 4);
  double area = 0;
  double volume = 0;
  for (Eigen::Index f = 0; f < folded.faceCount(); ++f) {
    const Vector cross = (folded.corner(f, 1) - folded.corner(f, 0))
                             .cross(folded.corner(f, 2) - folded.corner(f, 0));
    area += cross.norm() / 2;
    volume += folded.corner(f, 0).dot(cross) / 6;
  }
  const double r = 3;
  const double exact = 2 * kPi * r * r * area + 6 * kPi * r * volume;
  EXPECT_NEAR(hiddenViewingArea(folded, Point::Zero(), r) / exact, 1, 0.05);
}

TEST(HiddenViewingArea, RefusesASphereThatIsTooSmall) {
  EXPECT_THROW((void)hiddenViewingArea(geometry::makeIcosphere(1), Point::Zero(), 1), InvalidInput);
}

TEST(SelfOcclusion, IsZeroForConvexSurfacesOnly) {
  EXPECT_EQ(selfOcclusion(geometry::makeIcosphere(2)), 0);
  EXPECT_GT(selfOcclusion(geometry::makeFoldedSphere(3)), 0);
}

TEST(SelfOcclusion, OfABowlIsEveryPairInIt) {
  // Half a sphere seen from within: each point sees each other one.
  TriangleMesh bowl = geometry::makeIcosphere(2);
  bowl.faces.col(1).swap(bowl.faces.col(2));
  double area = 0;
  double ownArea = 0;
  for (Eigen::Index f = 0; f < bowl.faceCount(); ++f) {
    const double a = (bowl.corner(f, 1) - bowl.corner(f, 0))
                         .cross(bowl.corner(f, 2) - bowl.corner(f, 0))
                         .norm() /
                     2;
    area += a;
    ownArea += a * a;
  }
  EXPECT_NEAR(selfOcclusion(bowl), area * area - ownArea, 1e-9 * area * area);
}

}  // namespace
}  // namespace explica::visibility
