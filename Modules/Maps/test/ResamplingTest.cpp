// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Maps/Resampling.h"

#include "Explica/Core/Errors.h"
#include "Explica/Geometry/MeshMeasures.h"
#include "Explica/Maps/Icosphere.h"
#include "Explica/Testing/Meshes.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include <cmath>

namespace explica::maps {
namespace {

TriangleMesh turned(TriangleMesh mesh, double angleRad) {
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(angleRad, Vector(1, 2, 3).normalized()).toRotationMatrix();
  mesh.positions *= turn.transpose();
  return mesh;
}

ResamplingWeights weightsOf(const TriangleMesh& from, const TriangleMesh& to,
                            ResamplingMethod method) {
  return resamplingWeights(from, to, method, geometry::vertexAreas(from),
                           geometry::vertexAreas(to));
}

constexpr ResamplingMethod kAll[] = {ResamplingMethod::Adaptive, ResamplingMethod::Barycentric,
                                     ResamplingMethod::Nearest};

TEST(Resampling, KeepsConstantsAndTheIdentity) {
  const TriangleMesh fine = fsaverageSphere(4), coarse = turned(fsaverageSphere(3), 0.7);
  for (const ResamplingMethod method : kAll) {
    for (const auto* to : {&fine, &coarse}) {
      const auto weights = weightsOf(fine, *to, method);
      const Eigen::VectorXd ones = resampleMaps(weights, Eigen::VectorXd::Ones(fine.vertexCount()));
      EXPECT_LT((ones.array() - 1).abs().maxCoeff(), 1e-12);
    }
    const auto same = weightsOf(fine, fine, method);
    const Eigen::VectorXd z = fine.positions.col(2);
    EXPECT_LT((resampleMaps(same, z) - z).cwiseAbs().maxCoeff(), 1e-9);
  }
}

TEST(Resampling, LinearFunctionsComeBackToSecondOrder) {
  double previous = 0;
  for (const int level : {3, 4, 5}) {
    const TriangleMesh from = fsaverageSphere(level), to = turned(fsaverageSphere(3), 0.4);
    const auto weights = weightsOf(from, to, ResamplingMethod::Barycentric);
    const Eigen::MatrixXd off = resampleMaps(weights, from.positions) - to.positions;
    const double largest = off.cwiseAbs().maxCoeff();
    if (previous > 0) {
      EXPECT_NEAR(std::log2(previous / largest), 2, 0.3);
    }
    previous = largest;
  }
}

TEST(Resampling, AdaptiveWeightsUseEveryVertexAndKeepIntegrals) {
  const TriangleMesh from = fsaverageSphere(5), to = turned(fsaverageSphere(3), 0.3);
  const Eigen::VectorXd fromAreas = geometry::vertexAreas(from),
                        toAreas = geometry::vertexAreas(to);
  const auto adaptive = weightsOf(from, to, ResamplingMethod::Adaptive);
  Eigen::VectorXd used = adaptive.transpose() * Eigen::VectorXd::Ones(to.vertexCount());
  EXPECT_GT(used.minCoeff(), 0);
  EXPECT_EQ((weightsOf(from, to, ResamplingMethod::Barycentric).transpose() *
             Eigen::VectorXd::Ones(to.vertexCount()))
                .minCoeff(),
            0);
  // What each source vertex hands on is its area, so that even noise keeps its mean.
  Eigen::VectorXd noise(from.vertexCount());
  for (Eigen::Index v = 0; v < noise.size(); ++v) noise[v] = static_cast<double>(v * 7919 % 1009);
  const double mean = fromAreas.dot(noise) / fromAreas.sum();
  const auto off = [&](ResamplingMethod method) {
    const Eigen::VectorXd there = resampleMaps(weightsOf(from, to, method), noise);
    return std::abs(toAreas.dot(there) / toAreas.sum() - mean);
  };
  EXPECT_LT(off(ResamplingMethod::Adaptive), 1);
  EXPECT_GT(off(ResamplingMethod::Barycentric), 3 * off(ResamplingMethod::Adaptive));
}

TEST(Resampling, AmountsKeepTheirSum) {
  const TriangleMesh from = fsaverageSphere(4), to = turned(fsaverageSphere(3), 0.3);
  const Eigen::VectorXd toAreas = geometry::vertexAreas(to);
  Eigen::VectorXd amounts = geometry::vertexAreas(from);
  for (Eigen::Index v = 0; v < amounts.size(); ++v) amounts[v] *= 1 + from.positions(v, 0) / 150;
  const Eigen::VectorXd there =
      resampleAmounts(weightsOf(from, to, ResamplingMethod::Adaptive), toAreas, amounts);
  EXPECT_NEAR(there.sum() / amounts.sum(), 1, 1e-12);
  // As a density they are the same function of the place.
  const Eigen::VectorXd expected = 1 + to.positions.col(0).array() / 150;
  EXPECT_LT((there.cwiseQuotient(toAreas) - expected).norm() / expected.norm(), 0.02);
  Eigen::VectorXd unknown = amounts;
  unknown[7] = kNaN;
  EXPECT_NEAR(
      resampleAmounts(weightsOf(from, to, ResamplingMethod::Adaptive), toAreas, unknown).sum(),
      amounts.sum() - amounts[7], 1e-9 * amounts.sum());
}

TEST(Resampling, RadiiDoNotMatter) {
  const TriangleMesh from = fsaverageSphere(3);
  TriangleMesh to = turned(fsaverageSphere(2), 0.2);
  const Eigen::VectorXd areas = geometry::vertexAreas(to);
  const auto one =
      resamplingWeights(from, to, ResamplingMethod::Adaptive, geometry::vertexAreas(from), areas);
  to.positions *= 0.25;  // to the last bit: a power of 2
  const auto other =
      resamplingWeights(from, to, ResamplingMethod::Adaptive, geometry::vertexAreas(from), areas);
  EXPECT_EQ((one - other).norm(), 0);
}

TEST(Resampling, LeavesNaNOutWhileHalfOfTheWeightIsKnown) {
  const TriangleMesh from = fsaverageSphere(3), to = fsaverageSphere(4);
  const auto weights = weightsOf(from, to, ResamplingMethod::Barycentric);
  Eigen::VectorXd values = Eigen::VectorXd::Ones(from.vertexCount());
  values[0] = kNaN;
  const Eigen::VectorXd result = resampleMaps(weights, values);
  EXPECT_TRUE(std::isnan(result[0]));
  Eigen::Index unknown = 0;
  for (const double value : result) {
    unknown += std::isnan(value);
    if (!std::isnan(value)) {
      EXPECT_EQ(value, 1);
    }
  }
  EXPECT_LE(unknown, 6);  // the vertex, and edge middles that round below one half
}

TEST(Resampling, LabelsGoByTheLargestArea) {
  const TriangleMesh from = fsaverageSphere(5), to = fsaverageSphere(3);
  VertexKeys keys(from.vertexCount());
  for (Eigen::Index v = 0; v < keys.size(); ++v) keys[v] = from.positions(v, 2) > 5 ? 7 : -3;
  const VertexKeys result = resampleLabels(weightsOf(from, to, ResamplingMethod::Adaptive), keys);
  for (Eigen::Index v = 0; v < result.size(); ++v) {
    if (std::abs(to.positions(v, 2) - 5) > 4) {
      EXPECT_EQ(result[v], to.positions(v, 2) > 5 ? 7 : -3);
    }
  }
}

TEST(Resampling, RefusesWhatIsNoSphere) {
  TriangleMesh flat = geometry::makeRectangle(4, 4, 1, 1);
  EXPECT_THROW((void)weightsOf(flat, fsaverageSphere(2), ResamplingMethod::Nearest), InvalidInput);
}

}  // namespace
}  // namespace explica::maps
