// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Geometry/MeshMeasures.h"

#include "Explica/Geometry/Fixtures.h"
#include "Explica/Geometry/MeshTopology.h"
#include "Explica/Testing/Meshes.h"

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include <cmath>
#include <random>

namespace explica::geometry {
namespace {

TEST(TurnOutward, TurnsClockwiseFacesOnceOnly) {
  TriangleMesh mesh = makeIcosphere(2);
  const double volume = enclosedVolume(mesh);
  mesh.faces.col(1).swap(mesh.faces.col(2));
  EXPECT_TRUE(turnOutward(mesh));
  EXPECT_DOUBLE_EQ(enclosedVolume(mesh), volume);
  EXPECT_FALSE(turnOutward(mesh));
}

TEST(MeshMeasures, SphereConvergesAtSecondOrder) {
  std::vector<double> areaError, volumeError;
  for (int level = 2; level <= 5; ++level) {
    const TriangleMesh mesh = makeIcosphere(level, 2.0, {100, -50, 30});
    areaError.push_back(std::abs(totalArea(mesh) - 16 * kPi));
    volumeError.push_back(std::abs(enclosedVolume(mesh) - 32 * kPi / 3));
  }
  for (std::size_t i = 1; i < areaError.size(); ++i) {
    EXPECT_NEAR(std::log2(areaError[i - 1] / areaError[i]), 2.0, 0.1);
    EXPECT_NEAR(std::log2(volumeError[i - 1] / volumeError[i]), 2.0, 0.1);
  }
}

TEST(MeshMeasures, VolumeChangesSignWhenFacesAreInverted) {
  TriangleMesh mesh = makeFoldedSphere(3);
  const double volume = enclosedVolume(mesh);
  EXPECT_GT(volume, 0);
  mesh.faces.col(1).swap(mesh.faces.col(2));
  EXPECT_NEAR(enclosedVolume(mesh), -volume, 1e-12);
}

TEST(MeshMeasures, RigidMotionChangesNothing) {
  TriangleMesh mesh = makeFoldedSphere(3);
  const Eigen::VectorXd areas = faceAreas(mesh);
  const double volume = enclosedVolume(mesh);
  const Eigen::Matrix3d rotation = Eigen::AngleAxisd(1.1, Vector(1, 2, -1).normalized()).matrix();
  mesh.positions =
      ((mesh.positions * rotation.transpose()).rowwise() + Eigen::RowVector3d(3, 4, 5)).eval();
  EXPECT_LT((faceAreas(mesh) - areas).cwiseAbs().maxCoeff(), 1e-13);
  EXPECT_NEAR(enclosedVolume(mesh), volume, 1e-12);
}

TEST(MeshMeasures, VertexAreasSumToTheArea) {
  const TriangleMesh mesh = makeFoldedSphere(3);
  EXPECT_NEAR(vertexAreas(mesh).sum(), totalArea(mesh), 1e-12);
}

// Face normals of a closed surface sum to zero, and its angle defects to 2 pi chi.
TEST(MeshMeasures, ClosedSurfaceObeysGaussBonnet) {
  for (const TriangleMesh& mesh : {makeFoldedSphere(3), makeTorus(30, 15, 2, 0.7)}) {
    EXPECT_LT(faceNormalVectors(mesh).colwise().sum().norm(), 1e-12);
    double angles = 0;
    for (Eigen::Index f = 0; f < mesh.faceCount(); ++f) {
      for (int k = 0; k < 3; ++k) {
        const Vector u = mesh.corner(f, (k + 1) % 3) - mesh.corner(f, k);
        const Vector v = mesh.corner(f, (k + 2) % 3) - mesh.corner(f, k);
        angles += std::atan2(u.cross(v).norm(), u.dot(v));
      }
    }
    const double defect = 2 * kPi * static_cast<double>(mesh.vertexCount()) - angles;
    EXPECT_NEAR(defect, 2 * kPi * static_cast<double>(inspectMesh(mesh).eulerCharacteristic), 1e-9);
  }
}

TEST(CotangentLaplacian, IsZeroOnLinearFunctionsInsideAFlatPatch) {
  const TriangleMesh mesh = makeRectangle(7, 5, 3.0, 1.0);
  const Eigen::SparseMatrix<double> laplacian = cotangentLaplacian(mesh);
  const Eigen::VectorXd linear = mesh.positions * Vector(2, -3, 0);
  const Eigen::VectorXd result = laplacian * linear;
  for (int j = 1; j < 5; ++j) {
    for (int i = 1; i < 7; ++i) EXPECT_NEAR(result[j * 8 + i], 0, 1e-12);
  }
  // The Dirichlet energy of a linear function is |gradient|^2 times the area.
  EXPECT_NEAR(linear.dot(result), 13 * 3.0, 1e-10);
}

TEST(CotangentLaplacian, QuadraticFormIsNotNegative) {
  const Eigen::SparseMatrix<double> laplacian = cotangentLaplacian(makeFoldedSphere(2));
  std::mt19937 random(17);
  std::normal_distribution<double> normal;
  for (int n = 0; n < 5; ++n) {
    Eigen::VectorXd x(laplacian.rows());
    for (auto& value : x) value = normal(random);
    EXPECT_GT(x.dot(laplacian * x), 0);
  }
  EXPECT_LT((laplacian * Eigen::VectorXd::Ones(laplacian.rows())).cwiseAbs().maxCoeff(), 1e-12);
}

TEST(MeshMeasures, AnglesOfAThinTriangle) {
  TriangleMesh mesh;
  mesh.positions.resize(3, 3);
  mesh.positions << 0, 0, 0, 1, 0, 0, 0.5, 1e-6, 0;
  mesh.faces.resize(1, 3);
  mesh.faces << 0, 1, 2;
  EXPECT_NEAR(smallestAnglesRad(mesh)[0], std::atan(2e-6), 1e-15);
}

}  // namespace
}  // namespace explica::geometry
