// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Statistics/RandomField.h"

#include "Explica/Core/Types.h"
#include "Explica/Statistics/Distributions.h"
#include "Explica/Testing/Meshes.h"

#include <gtest/gtest.h>

#include <cmath>

namespace explica::statistics {
namespace {

TEST(RandomField, FOfOneIsTSquared) {
  for (const double df : {7.0, 40.0, kInfinity}) {
    for (const double t : {0.5, 2.0, 4.5}) {
      const auto one = eulerDensities(t, {df, 0}), squared = eulerDensities(t * t, {df, 1});
      for (std::size_t d = 0; d < 3; ++d) EXPECT_NEAR(squared[d], 2 * one[d], 1e-12 * squared[d]);
    }
  }
}

TEST(RandomField, ManyDegreesOfFreedomAreInfinitelyMany) {
  const auto many = eulerDensities(3, {1e7, 0}), infinite = eulerDensities(3, {kInfinity, 0});
  for (std::size_t d = 0; d < 3; ++d) EXPECT_NEAR(many[d], infinite[d], 1e-5 * infinite[d]);
}

TEST(RandomField, ReselsOfARectangleAreItsMeasures) {
  const TriangleMesh mesh = geometry::makeRectangle(6, 4, 12, 8);
  const auto topology = geometry::buildTopology(mesh.faces, mesh.vertexCount());
  constexpr double kFwhm = 3;
  // The metric of a field of that FWHM: 4 log 2 / FWHM^2 times squared lengths.
  Eigen::VectorXd roughness(topology.edges.rows());
  for (Eigen::Index e = 0; e < roughness.size(); ++e) {
    roughness[e] =
        (mesh.positions.row(topology.edges(e, 0)) - mesh.positions.row(topology.edges(e, 1)))
            .squaredNorm() *
        4 * std::log(2.0) / kFwhm / kFwhm;
  }
  const Resels resels =
      reselsOf(mesh.faces, topology, roughness,
               std::vector<bool>(static_cast<std::size_t>(mesh.vertexCount()), true));
  EXPECT_NEAR(resels.byDimension[0], 1, 1e-12);
  EXPECT_NEAR(resels.byDimension[1], (12 + 8) / kFwhm, 1e-12);
  EXPECT_NEAR(resels.byDimension[2], 12 * 8 / kFwhm / kFwhm, 1e-12);
  EXPECT_NEAR(resels.perVertex.sum(), resels.byDimension[2], 1e-12);
}

TEST(RandomField, PeaksOfHigherThresholdsAreRarer) {
  Resels resels;
  resels.byDimension = {2, 0, 80};
  resels.places = 10242;
  double before = 1;
  for (double t = -1; t < 8; t += 0.05) {
    const double p = peakProbability(t, {30, 0}, resels);
    EXPECT_LE(p, before + 1e-12);
    before = p;
  }
  EXPECT_LT(before, 1e-3);
}

TEST(RandomField, OneResellessPlaceHasItsOwnP) {
  Resels point;
  point.byDimension = {1, 0, 0};
  point.places = 1;
  EXPECT_NEAR(peakProbability(2, {10, 0}, point), tTail(2, 10), 1e-12);
}

TEST(RandomField, ClusterSizesHaveTheExpectedMean) {
  // Area above the threshold is the number of clusters times their mean size.
  for (const double df : {20.0, 60.0}) {
    const FieldKind kind{df, 0};
    const double threshold = tQuantile(0.001, df);
    const ClusterSizes sizes(threshold, kind, 1, kInfinity);
    double mean = 0;
    constexpr double kStep = 1e-3;
    for (double s = kStep / 2; s < 8; s += kStep) mean += sizes.single(s) * kStep;
    const auto rho = eulerDensities(threshold, kind);
    EXPECT_NEAR(mean, rho[0] / rho[2], 0.01 * mean);
  }
}

TEST(RandomField, ClustersOfAGaussianFieldAreExponential) {
  const FieldKind kind{kInfinity, 0};
  const ClusterSizes sizes(3, kind, 50, kInfinity);
  const auto rho = eulerDensities(3, kind);
  const double mean = rho[0] / rho[2];
  EXPECT_NEAR(sizes.single(mean), std::exp(-1), 1e-12);
  EXPECT_NEAR(sizes.largest(0), -std::expm1(-50 * rho[2]), 1e-12);
}

TEST(RandomField, RoughnessOfIndependentPlacesIsTwo) {
  Eigen::MatrixXd y(4, 3);
  y << 1, 0, 1, -1, 0, -1, 0, 1, 0, 0, -1, 0;
  Edges edges(2, 2);
  edges << 0, 1, 0, 2;
  const Eigen::VectorXd rough = edgeRoughness(
      Eigen::MatrixXd::Ones(4, 1), Eigen::MatrixXd::Zero(1, 3), edges,
      [&](std::size_t person, std::span<double> values) {
        for (std::size_t v = 0; v < 3; ++v)
          values[v] = y(static_cast<Eigen::Index>(person), static_cast<Eigen::Index>(v));
      });
  EXPECT_NEAR(rough[0], 2, 1e-14);
  EXPECT_NEAR(rough[1], 0, 1e-14);
}

}  // namespace
}  // namespace explica::statistics
