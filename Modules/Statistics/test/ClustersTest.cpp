// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Statistics/Clusters.h"

#include "Explica/Geometry/Fixtures.h"
#include "Explica/Geometry/MeshMeasures.h"
#include "Explica/Testing/Meshes.h"
#include "RandomNumbers.h"

#include <gtest/gtest.h>

namespace explica::statistics {
namespace {

TEST(Clusters, TwoPatchesOfARectangle) {
  // 5 x 4 vertices, row by row.
  const TriangleMesh mesh = geometry::makeRectangle(4, 3, 4, 3);
  const auto neighbours = geometry::buildTopology(mesh.faces, mesh.vertexCount()).vertexVertices;
  Eigen::VectorXd values = Eigen::VectorXd::Zero(mesh.vertexCount());
  values[0] = 4;
  values[1] = 3;
  values[19] = 5;
  const auto found = findClusters(neighbours, values, 2, Eigen::VectorXd::Constant(20, 0.5));
  ASSERT_EQ(found.size(), 2U);
  EXPECT_EQ(found[0].vertices, (std::vector<std::int32_t>{0, 1}));
  EXPECT_EQ(found[0].extent, 1);
  EXPECT_EQ(found[0].mass, 0.5 * (2 + 1));
  EXPECT_EQ(found[1].peak, 19);
}

TEST(Clusters, TheLargestIsThatOfTheList) {
  const TriangleMesh mesh = geometry::makeIcosphere(3, 10);
  const auto neighbours = geometry::buildTopology(mesh.faces, mesh.vertexCount()).vertexVertices;
  const Eigen::VectorXd areas = geometry::vertexAreas(mesh);
  const Eigen::VectorXf single = areas.cast<float>();
  const std::vector<float> areaList(single.data(), single.data() + single.size());
  LargestClusterFinder finder(neighbours, areaList);
  for (unsigned seed = 1; seed < 20; ++seed) {
    const Eigen::VectorXf values = testing::normalMatrix(mesh.vertexCount(), 1, seed).cast<float>();
    const LargestCluster largest =
        finder.find({values.data(), static_cast<std::size_t>(values.size())}, 0.8F);
    const Eigen::VectorXd exact = values.cast<double>();
    double extent = 0, mass = 0;
    for (const Eigen::VectorXd& side : {exact, Eigen::VectorXd(-exact)}) {
      for (const Cluster& c : findClusters(neighbours, side, 0.8F, areas)) {
        extent = std::max(extent, c.extent);
        mass = std::max(mass, c.mass);
      }
    }
    EXPECT_NEAR(largest.extent, extent, 1e-4 * extent);
    EXPECT_NEAR(largest.mass, mass, 1e-4 * mass);
  }
}

}  // namespace
}  // namespace explica::statistics
