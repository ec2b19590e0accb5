// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Maps/Smoothing.h"

#include "Explica/Core/Errors.h"
#include "Explica/Geometry/Fixtures.h"
#include "Explica/Geometry/MeshMeasures.h"
#include "Explica/Maps/HeatFlow.h"
#include "Explica/Testing/Meshes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace explica::maps {
namespace {

Eigen::MatrixXd noise(Eigen::Index rows, Eigen::Index maps, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  return Eigen::MatrixXd::NullaryExpr(rows, maps, [&] { return normal(random); });
}

/// Distance at which a radial profile falls to half of its value at vertex `centre`.
double halfWidth(const TriangleMesh& mesh, const Eigen::VectorXd& values, Eigen::Index centre) {
  double below = kInfinity, above = 0, vBelow = 0, vAbove = 0;
  for (Eigen::Index v = 0; v < values.size(); ++v) {
    const double d = (mesh.positions.row(v) - mesh.positions.row(centre)).norm();
    if (values[v] >= 0.5 * values[centre] && d > above) above = d, vAbove = values[v];
    if (values[v] < 0.5 * values[centre] && d < below) below = d, vBelow = values[v];
  }
  const double share = (vAbove - 0.5 * values[centre]) / (vAbove - vBelow);
  return above + share * (below - above);
}

TEST(Smoothing, APointInAPlaneGetsTheWidthAskedFor) {
  const TriangleMesh sheet = geometry::makeRectangle(120, 120, 60, 60);
  const Eigen::Index centre = 60 * 121 + 60;
  Eigen::VectorXd point = Eigen::VectorXd::Zero(sheet.vertexCount());
  point[centre] = 1;
  for (const double fwhm : {6.0, 10.0}) {
    const Eigen::VectorXd wide = smoothMaps(sheet, point, fwhm);
    EXPECT_NEAR(2 * halfWidth(sheet, wide, centre), fwhm, 0.01 * fwhm);
    const double x2 =
        wide.dot((sheet.positions.col(0).array() - 30).square().matrix()) / wide.sum();
    EXPECT_NEAR(x2, fwhm * fwhm / (8 * std::log(2)), 0.01 * fwhm * fwhm / (8 * std::log(2)));
    // The kernel itself, not only its width.
    const double variance = fwhm * fwhm / (8 * std::log(2));
    const Eigen::VectorXd exact = (-(sheet.positions.rowwise() - sheet.positions.row(centre))
                                        .rowwise()
                                        .squaredNorm()
                                        .array() /
                                   (2 * variance))
                                      .exp();
    EXPECT_LT((wide / wide[centre] - exact).cwiseAbs().maxCoeff(), 0.01);
  }
}

TEST(Smoothing, HarmonicsOnASphereDecayByTheirEigenvalue) {
  double previous = 0;
  for (const int level : {3, 4, 5}) {
    const TriangleMesh ball = geometry::makeIcosphere(level, 20);
    const Eigen::VectorXd z = ball.positions.col(2) / 20;
    const Eigen::VectorXd second = 3 * z.array().square() - 1;  // eigenvalue 6 / R^2
    const double fwhm = 12, time = fwhm * fwhm / (16 * std::log(2));
    const Eigen::VectorXd smooth = smoothMaps(ball, second, fwhm);
    const double off =
        std::abs(smooth.dot(second) / second.dot(second) / std::exp(-6 * time / 400) - 1);
    if (previous > 0) {
      EXPECT_GT(previous / off, 3);  // second order in the edge
    }
    previous = off;
  }
  EXPECT_LT(previous, 1e-3);
}

TEST(Smoothing, KeepsConstantsAndIntegrals) {
  const TriangleMesh folded = geometry::makeFoldedSphere(4, 30);
  const Eigen::VectorXd areas = geometry::vertexAreas(folded);
  Eigen::MatrixXd maps = noise(folded.vertexCount(), 2, 7);
  maps.col(1).setConstant(2.5);
  const Eigen::MatrixXd smooth = smoothMaps(folded, maps, 8);
  EXPECT_NEAR(areas.dot(smooth.col(0)), areas.dot(maps.col(0)), 1e-9 * areas.sum());
  EXPECT_LT((smooth.col(1).array() - 2.5).abs().maxCoeff(), 1e-10);
  EXPECT_LT(smooth.col(0).cwiseAbs().maxCoeff(), 0.7 * maps.col(0).cwiseAbs().maxCoeff());
}

TEST(Smoothing, NeitherNaNNorTheOutsideOfTheMaskReachesOthers) {
  const TriangleMesh ball = geometry::makeIcosphere(4, 20);
  Eigen::VectorXd values = Eigen::VectorXd::Constant(ball.vertexCount(), 3);
  std::vector<bool> mask(static_cast<std::size_t>(values.size()));
  Eigen::Index unknown = 0;
  for (Eigen::Index v = 0; v < values.size(); ++v) {
    mask[static_cast<std::size_t>(v)] = ball.positions(v, 2) < 10;
    if (!mask[static_cast<std::size_t>(v)]) values[v] = 1000;
    if (ball.positions(v, 2) < -15) values[v] = kNaN, ++unknown;
  }
  const Eigen::VectorXd smooth = smoothMaps(ball, values, 15, mask);
  Eigen::Index stillUnknown = 0;
  for (Eigen::Index v = 0; v < values.size(); ++v) {
    if (std::isnan(smooth[v])) {
      ++stillUnknown;
    } else {
      EXPECT_NEAR(smooth[v], values[v], 1e-9);
    }
  }
  EXPECT_EQ(stillUnknown, unknown);
}

TEST(Smoothing, MapsKnownAtOtherVerticesGoBesideEachOther) {
  const TriangleMesh ball = geometry::makeIcosphere(3, 20);
  Eigen::MatrixXd maps = noise(ball.vertexCount(), 3, 3);
  maps(5, 1) = kNaN;
  const Eigen::MatrixXd together = smoothMaps(ball, maps, 6);
  for (int c = 0; c < 3; ++c) {
    const Eigen::VectorXd alone = smoothMaps(ball, maps.col(c), 6);
    for (Eigen::Index v = 0; v < alone.size(); ++v) {
      if (c == 1 && v == 5) continue;
      EXPECT_EQ(together(v, c), alone[v]);
    }
  }
}

TEST(Smoothing, NoiseIsMeasuredAsSmoothAsItWasMade) {
  const TriangleMesh ball = geometry::makeIcosphere(5, 30);  // edges of 1.1 mm
  for (const double fwhm : {8.0, 14.0}) {
    const Eigen::MatrixXd smooth = smoothMaps(ball, noise(ball.vertexCount(), 6, 1), fwhm);
    EXPECT_NEAR(estimateFwhm(ball, smooth), fwhm, 0.03 * fwhm);
    EXPECT_NEAR(estimateFwhm(ball, smooth.col(0)), fwhm, 0.15 * fwhm);
  }
  EXPECT_TRUE(std::isnan(estimateFwhm(ball, Eigen::VectorXd::Ones(ball.vertexCount()))));
  EXPECT_LT(estimateFwhm(ball, noise(ball.vertexCount(), 4, 1)), 2);
  EXPECT_LT(estimateFwhm(ball, noise(ball.vertexCount(), 6, 1)), 2);
}

TEST(Smoothing, RefusesWhatDoesNotFit) {
  const TriangleMesh ball = geometry::makeIcosphere(1);
  EXPECT_THROW((void)smoothMaps(ball, Eigen::VectorXd::Ones(3), 1), InvalidInput);
  EXPECT_THROW((void)smoothMaps(ball, Eigen::VectorXd::Ones(42), 0), InvalidInput);
}

}  // namespace
}  // namespace explica::maps
