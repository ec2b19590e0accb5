// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Maps/Regions.h"

#include "Explica/Core/Errors.h"
#include "Explica/Geometry/Fixtures.h"
#include "Explica/Geometry/MeshMeasures.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

namespace explica::maps {
namespace {

TEST(Regions, VolumesOfAllVerticesAreWhatTheSurfacesEnclose) {
  const TriangleMesh white = geometry::makeFoldedSphere(4, 30);
  TriangleMesh pial = white;
  for (Eigen::Index v = 0; v < pial.vertexCount(); ++v) {
    pial.positions.row(v) *= 1.05 + 0.03 * std::sin(static_cast<double>(v));
  }
  const double between = geometry::enclosedVolume(pial) - geometry::enclosedVolume(white);
  EXPECT_NEAR(vertexVolumes(white, pial).sum(), between, 1e-9 * between);
  TriangleMesh other = pial;
  other.faces.row(0).swap(other.faces.row(1));
  EXPECT_THROW((void)vertexVolumes(white, other), InvalidInput);
}

TEST(Regions, VolumeOfAShellIsSharedEvenly) {
  const TriangleMesh white = geometry::makeIcosphere(4, 10);
  const TriangleMesh pial = geometry::makeIcosphere(4, 12);
  const Positions normals = geometry::faceNormalVectors(white);  // twice the areas long
  Eigen::VectorXd exact = Eigen::VectorXd::Zero(white.vertexCount());
  for (Eigen::Index f = 0; f < white.faceCount(); ++f) {
    const double pyramid = normals.row(f).dot(white.positions.row(white.faces(f, 0))) / 6;
    for (int k = 0; k < 3; ++k) exact[white.faces(f, k)] += pyramid * (1.2 * 1.2 * 1.2 - 1) / 3;
  }
  EXPECT_LT((vertexVolumes(white, pial) - exact).cwiseAbs().maxCoeff(), 1e-9);
}

TEST(Regions, MomentsAreThoseOfTheRegionsVertices) {
  const std::array<Label, 6> keys = {4, 4, 9, 4, 9, 0};
  const std::array<Label, 3> regions = {9, 4, 5};
  Eigen::VectorXd values(6), areas(6);
  values << 1, 2, 10, 6, kNaN, 100;
  areas << 1, 1, 3, 2, 5, 9;
  const auto found = regionMoments(keys, values, areas, regions);
  EXPECT_EQ(found[0].count, 1);
  EXPECT_EQ(found[0].mean, 10);
  EXPECT_EQ(found[0].deviation, 0);
  EXPECT_EQ(found[1].count, 3);
  EXPECT_EQ(found[1].sum, 9);
  EXPECT_EQ(found[1].mean, 3);
  EXPECT_NEAR(found[1].deviation, std::sqrt(14.0 / 3), 1e-15);
  EXPECT_EQ(found[1].meanOverArea, 15.0 / 4);
  EXPECT_NEAR(found[1].deviationOverArea, std::sqrt(20.75 / 4), 1e-15);
  EXPECT_EQ(found[2].count, 0);
  EXPECT_TRUE(std::isnan(found[2].mean));
}

}  // namespace
}  // namespace explica::maps
