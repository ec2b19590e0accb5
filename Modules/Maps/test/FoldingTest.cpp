// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Maps/Folding.h"

#include "Explica/Geometry/Fixtures.h"
#include "Explica/Geometry/MeshMeasures.h"
#include "Explica/IO/SurfaceFile.h"
#include "Explica/IO/VertexDataFile.h"
#include "Explica/Testing/Meshes.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include <cmath>
#include <filesystem>

namespace explica::maps {
namespace {

double correlation(const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
  const Eigen::VectorXd x = a.array() - a.mean(), y = b.array() - b.mean();
  return x.dot(y) / (x.norm() * y.norm());
}

TEST(Folding, CurvatureOfASphereIsOneOverItsRadiusWhateverItsMesh) {
  for (const int level : {3, 4}) {
    for (const double fwhm : {0.0, 2.0}) {
      const TriangleMesh ball = geometry::makeIcosphere(level, 20);
      const Eigen::VectorXd curvature = meanCurvature(ball, fwhm),
                            areas = geometry::vertexAreas(ball);
      EXPECT_NEAR(areas.dot(curvature) / areas.sum(), -0.05, 0.0002);
      // Thirds of the faces' areas are not Voronoi's at the 12 vertices of five faces.
      EXPECT_LT(std::sqrt((curvature.array() + 0.05).square().mean()), 0.001);
    }
  }
}

TEST(Folding, CurvatureConvergesOnAnEllipsoid) {
  // H = (|x|^2 - a^2 - b^2 - c^2) / (2 a^2 b^2 c^2 |g|^3), g = (x/a^2, y/b^2, z/c^2).
  const Vector axes(20, 15, 12);
  double previous = 0;
  for (const int level : {3, 4, 5}) {
    TriangleMesh ball = geometry::makeIcosphere(level);
    ball.positions *= axes.asDiagonal();
    const Eigen::VectorXd found = meanCurvature(ball, 0.0);
    double off = 0, weight = 0;
    const Eigen::VectorXd areas = geometry::vertexAreas(ball);
    for (Eigen::Index v = 0; v < found.size(); ++v) {
      const Vector x = ball.positions.row(v).transpose();
      const Vector g = x.cwiseQuotient(axes.cwiseAbs2());
      const double h = (x.squaredNorm() - axes.squaredNorm()) /
                       (2 * axes.cwiseAbs2().prod() * std::pow(g.norm(), 3));
      off += areas[v] * (found[v] - h) * (found[v] - h);
      weight += areas[v];
    }
    off = std::sqrt(off / weight);
    if (previous > 0) {
      EXPECT_GT(previous / off, 1.8);
    }
    previous = off;
  }
  EXPECT_LT(previous, 1e-3);
}

TEST(Folding, TotalCurvatureSurvivesDiffusion) {
  const TriangleMesh folded = geometry::makeFoldedSphere(4, 30);
  const Eigen::VectorXd areas = geometry::vertexAreas(folded);
  const double total = areas.dot(meanCurvature(folded, 0.0));
  EXPECT_NEAR(areas.dot(meanCurvature(folded)), total, 1e-9 * std::abs(total));
}

TEST(Folding, CurvatureAtABoundaryIsThatOfItsNeighbours) {
  TriangleMesh bowl = geometry::makeRectangle(40, 40, 10, 10);
  for (Eigen::Index v = 0; v < bowl.vertexCount(); ++v) {
    const double x = bowl.positions(v, 0) - 5, y = bowl.positions(v, 1) - 5;
    bowl.positions(v, 2) = 0.02 * (x * x + y * y);
  }
  const Eigen::VectorXd curvature = meanCurvature(bowl, 1.0);
  EXPECT_GT(curvature.minCoeff(), 0.025);
  EXPECT_LT(curvature.maxCoeff(), 0.042);
}

TEST(Folding, DepthIsZeroOnASphereAndGreatestInTheFolds) {
  const TriangleMesh ball = geometry::makeIcosphere(4, 30);
  EXPECT_LT(sulcalDepth(ball).cwiseAbs().maxCoeff(), 1e-3 * 30);
  const TriangleMesh folded = geometry::makeFoldedSphere(5, 30);
  const Eigen::VectorXd depth = sulcalDepth(folded);
  EXPECT_GT(correlation(depth, -folded.positions.rowwise().norm()), 0.9);
  EXPECT_NEAR(geometry::vertexAreas(folded).dot(depth), 0, 1e-9 * geometry::totalArea(folded));
}

TEST(Folding, ScalesWithTheSurface) {
  const TriangleMesh folded = geometry::makeFoldedSphere(4, 30);
  const TriangleMesh twice{2 * folded.positions, folded.faces};
  EXPECT_LT((sulcalDepth(twice) - 2 * sulcalDepth(folded)).cwiseAbs().maxCoeff(), 1e-9);
  EXPECT_LT((2 * meanCurvature(twice) - meanCurvature(folded)).cwiseAbs().maxCoeff(), 1e-9);
}

TEST(Folding, InflatedSurfacesKeepTheirAreaAndLoseTheirFolds) {
  const TriangleMesh folded = geometry::makeFoldedSphere(4, 50.0);
  const TriangleMesh open = inflated(folded);
  EXPECT_NEAR(geometry::totalArea(open), geometry::totalArea(folded), 1e-6 * 31416);
  EXPECT_LT(meanCurvature(open, 0).cwiseAbs().mean(),
            0.8 * meanCurvature(folded, 0).cwiseAbs().mean());
}

TEST(Folding, AgreesWithFreeSurfersDepth) {
  const auto folder = std::filesystem::path(EXPLICA_REAL_DATA) / "fsaverage5/fs_binary";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "skipped: no real data";
  io::SurfaceReadOptions reading;
  reading.space = io::SurfaceSpace::Scanner;
  for (const std::string side : {"lh.", "rh."}) {
    const TriangleMesh white = io::readSurface(folder / (side + "white"), reading).mesh;
    const auto sulc = io::readVertexMaps(folder / (side + "sulc"), white.vertexCount());
    EXPECT_GT(correlation(sulcalDepth(white), sulc.front().values), 0.98);
  }
}

}  // namespace
}  // namespace explica::maps
