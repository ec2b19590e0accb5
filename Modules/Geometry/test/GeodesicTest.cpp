// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Geometry/Geodesic.h"

#include "Explica/Core/Errors.h"
#include "Explica/Geometry/Fixtures.h"
#include "Explica/Geometry/MeshMeasures.h"
#include "Explica/Testing/Meshes.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

namespace explica::geometry {
namespace {

Eigen::VectorXd fromVertex(const TriangleMesh& mesh, std::int32_t source,
                           double limit = kInfinity) {
  return geodesicDistances(mesh, buildTopology(mesh.faces, mesh.vertexCount()), std::array{source},
                           limit);
}

TEST(Geodesic, IsEuclideanOnAPlane) {
  // Cells four times as long as wide: long edges and diagonals must not show.
  const TriangleMesh sheet = makeRectangle(12, 24, 4.0, 2.0);
  for (const std::int32_t source : {0, 137, 160}) {
    const Eigen::VectorXd distance = fromVertex(sheet, source);
    const Eigen::VectorXd exact =
        (sheet.positions.rowwise() - sheet.positions.row(source)).rowwise().norm();
    EXPECT_LT((distance - exact).cwiseAbs().maxCoeff(), 1e-9);
  }
}

TEST(Geodesic, BendingAPlaneChangesNothing) {
  TriangleMesh sheet = makeRectangle(40, 20, 3.0, 1.5);
  const Eigen::VectorXd flat = fromVertex(sheet, 100);
  for (Eigen::Index v = 0; v < sheet.vertexCount(); ++v) {  // a prism with flat, isometric sides
    const double s = std::abs(sheet.positions(v, 0) - 1.5);
    sheet.positions(v, 0) = s * 0.6;
    sheet.positions(v, 2) = s * 0.8 * (v % 41 < 20 ? -1 : 1);
  }
  EXPECT_LT((fromVertex(sheet, 100) - flat).cwiseAbs().maxCoeff(), 1e-9);
}

TEST(Geodesic, ConvergesToTheArcOnASphere) {
  std::vector<double> error;
  for (int level = 2; level <= 5; ++level) {
    const TriangleMesh sphere = makeIcosphere(level);
    const Eigen::VectorXd distance = fromVertex(sphere, 0);
    double worst = 0;
    for (Eigen::Index v = 0; v < sphere.vertexCount(); ++v) {
      const double cosine = sphere.positions.row(v).dot(sphere.positions.row(0));
      worst = std::max(worst, std::abs(distance[v] - std::acos(std::clamp(cosine, -1.0, 1.0))));
    }
    error.push_back(worst);
  }
  for (std::size_t i = 1; i < error.size(); ++i) EXPECT_LT(error[i], 0.7 * error[i - 1]);
  EXPECT_LT(error.back(), 0.01 * kPi);  // one per cent of the farthest way, at 20,480 faces
}

TEST(Geodesic, LimitAndComponentsAreInfinite) {
  const TriangleMesh sheet = makeRectangle(20, 20, 2.0, 2.0);
  const Eigen::VectorXd distance = fromVertex(sheet, 0, 0.5);
  for (Eigen::Index v = 0; v < sheet.vertexCount(); ++v) {
    EXPECT_EQ(std::isfinite(distance[v]), sheet.positions.row(v).norm() <= 0.5 + 1e-12);
  }
}

TEST(Geodesic, NearestOfSeveralSourcesCounts) {
  const TriangleMesh mesh = makeFoldedSphere(3);
  const MeshTopology topology = buildTopology(mesh.faces, mesh.vertexCount());
  const std::array<std::int32_t, 2> both = {0, 300};
  const Eigen::VectorXd joint = geodesicDistances(mesh, topology, both);
  const Eigen::VectorXd least = fromVertex(mesh, 0).cwiseMin(fromVertex(mesh, 300));
  EXPECT_EQ(joint[0], 0);
  EXPECT_EQ(joint[300], 0);
  // Where the fronts meet, an edge holds one distance of each: a share of an edge is lost, not
  // more.
  EXPECT_LT((joint - least).cwiseAbs().maxCoeff(), 0.3 * meanEdgeLength(mesh));
}

TEST(Geodesic, SourcesMustExist) {
  const TriangleMesh mesh = makeIcosphere(0);
  const MeshTopology topology = buildTopology(mesh.faces, mesh.vertexCount());
  EXPECT_THROW((void)geodesicDistances(mesh, topology, std::array<std::int32_t, 1>{12}),
               InvalidInput);
  EXPECT_THROW((void)geodesicDistances(mesh, topology, {}), InvalidInput);
}

}  // namespace
}  // namespace explica::geometry
