// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Sphere/SphereMap.h"

#include "Explica/Core/Errors.h"
#include "Explica/Core/Parallel.h"
#include "Explica/Flattening/Coarsening.h"
#include "Explica/Geometry/Fixtures.h"
#include "Explica/Geometry/MeshMeasures.h"
#include "Explica/Geometry/SphereLocator.h"
#include "Explica/Testing/Meshes.h"
#include "Explica/Testing/TimesCovered.h"

#include <gtest/gtest.h>

#include <random>

namespace explica::sphere {
namespace {

void expectOneToOne(const TriangleMesh& surface, const SphereMap& map) {
  const TriangleMesh image{map.positions, surface.faces};
  EXPECT_TRUE(geometry::turnedOver(image).empty());
  EXPECT_EQ(testing::timesCovered(image), 1);
  const Positions rounded = map.positions.cast<float>().cast<double>();
  EXPECT_TRUE(map.positions == rounded);
  EXPECT_NEAR(map.positions.rowwise().norm().minCoeff(), kSphereRadius, 1e-4);
}

TEST(SphereMap, OfASphereIsTheIdentity) {
  const TriangleMesh sphere = geometry::makeIcosphere(4, 30, Point(5, -7, 100));
  const SphereMap map = mapToSphere(sphere);
  expectOneToOne(sphere, map);
  const Positions same = (sphere.positions.rowwise() - Eigen::RowVector3d(5, -7, 100)) / 30;
  EXPECT_LT((map.positions / kSphereRadius - same).rowwise().norm().maxCoeff(), 0.01);
}

TEST(SphereMap, OfASpheroidTendsToTheMapThatKeepsAreas) {
  // A zone of a prolate spheroid between the equator and height z has the share of the half's area
  // that the sphere's zone up to its sine of latitude has.
  TriangleMesh spheroid = geometry::makeIcosphere(4);
  const double a = 2;
  spheroid.positions.col(2) *= a;
  const auto zone = [&](double z) {
    const double k = std::sqrt(a * a - 1) / (a * a);  // of k z in [0, sin]
    const double t = k * z;
    return (t * std::sqrt(1 - t * t) + std::asin(t)) / 2;
  };
  SphereMapOptions options;
  options.balance = 1000;
  options.maxIterations = 200;
  options.tolerance = 1e-7;
  const SphereMap map = mapToSphere(spheroid, options);
  expectOneToOne(spheroid, map);
  EXPECT_LT(sphereDistortion(spheroid, map.positions).arealMean, 0.01);
  double largest = 0;
  for (Eigen::Index v = 0; v < spheroid.vertexCount(); ++v) {
    const double sine = map.positions(v, 2) / kSphereRadius;
    largest = std::max(largest, std::abs(sine - zone(spheroid.positions(v, 2)) / zone(a)));
  }
  EXPECT_LT(largest, 0.03);
}

TEST(SphereMap, OfANeedleIsOneToOne) {
  TriangleMesh needle = geometry::makeIcosphere(4);
  for (Eigen::Index v = 0; v < needle.vertexCount(); ++v) {
    const double z = needle.positions(v, 2);
    if (z > 0.9) needle.positions(v, 2) += 200 * (z - 0.9);
  }
  const SphereMap map = mapToSphere(needle);
  expectOneToOne(needle, map);
  EXPECT_LT(sphereDistortion(needle, map.positions).arealMean, 1.2);
}

TEST(SphereMap, OfRandomFoldedSurfacesIsOneToOneAndTheBalanceIsATradeOff) {
  for (unsigned seed = 1; seed <= 2; ++seed) {
    TriangleMesh mesh = geometry::makeFoldedSphere(4, 30, 0.3, 4 + static_cast<int>(seed));
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> shift(-0.4, 0.4);
    for (double& x : mesh.positions.reshaped()) x += shift(random);
    SphereMapOptions options;
    options.balance = 1;
    const SphereMap shape = mapToSphere(mesh, options);
    options.balance = 10;
    const SphereMap area = mapToSphere(mesh, options);
    expectOneToOne(mesh, shape);
    expectOneToOne(mesh, area);
    const auto ofShape = sphereDistortion(mesh, shape.positions);
    const auto ofArea = sphereDistortion(mesh, area.positions);
    EXPECT_LT(ofArea.arealMean, ofShape.arealMean) << "seed " << seed;
    EXPECT_LT(ofShape.stretchMedian, ofArea.stretchMedian) << "seed " << seed;
  }
}

/// Every second or third vertex is left, with the faces that coarsening gives it.
TriangleMesh decimated(const TriangleMesh& mesh) {
  const auto levels = flattening::coarsen(flattening::intrinsicOf(mesh), {}, 4, true);
  const Faces& faces = levels[1].mesh.faces;
  std::vector<std::int32_t> number(static_cast<std::size_t>(mesh.vertexCount()), -1), kept;
  TriangleMesh result;
  result.faces.resize(faces.rows(), 3);
  for (Eigen::Index f = 0; f < faces.rows(); ++f) {
    for (int k = 0; k < 3; ++k) {
      std::int32_t& at = number[static_cast<std::size_t>(faces(f, k))];
      if (at < 0) {
        at = static_cast<std::int32_t>(kept.size());
        kept.push_back(faces(f, k));
      }
      result.faces(f, k) = at;
    }
  }
  result.positions = mesh.positions(kept, Eigen::all);
  return result;
}

TEST(SphereMap, OfFortyDeformedAndDecimatedSurfacesIsOneToOne) {
  for (unsigned seed = 1; seed <= 40; ++seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> unit(0, 1);
    TriangleMesh mesh =
        geometry::makeFoldedSphere(4, 30, 0.1 + 0.4 * unit(random), 3 + static_cast<int>(seed % 6));
    // Stretched, bent about the second axis, with vertices out of place.
    const double length = 1 + 3 * unit(random), bend = 0.03 * unit(random), noise = unit(random);
    for (Eigen::Index v = 0; v < mesh.vertexCount(); ++v) {
      const double x = length * mesh.positions(v, 0), z = mesh.positions(v, 2) + 60;
      mesh.positions.row(v) << z * std::sin(bend * x) + (1 - bend * z) * x, mesh.positions(v, 1),
          z * std::cos(bend * x);
      for (int a = 0; a < 3; ++a) mesh.positions(v, a) += noise * (unit(random) - 0.5);
    }
    if (seed % 2 == 0) mesh = decimated(mesh);
    SCOPED_TRACE("seed " + std::to_string(seed));
    expectOneToOne(mesh, mapToSphere(mesh));
  }
}

TEST(SphereMap, DoesNotDependOnThreadsNorOnTheUnit) {
  TriangleMesh mesh = geometry::makeFoldedSphere(4, 30);
  const Positions once = mapToSphere(mesh).positions;
  setThreadCount(1);
  EXPECT_EQ(mapToSphere(mesh).positions, once);
  setThreadCount(0);
  mesh.positions *= 4;
  EXPECT_LT((mapToSphere(mesh).positions - once).cwiseAbs().maxCoeff(), 1e-3);
}

TEST(SphereMap, IsAsOneToOneWhenStopped) {
  Monitor monitor;
  monitor.stopWanted = [] { return true; };
  const TriangleMesh mesh = geometry::makeFoldedSphere(4, 30);
  const SphereMap map = mapToSphere(mesh, {}, monitor);
  EXPECT_EQ(map.termination, Termination::Interrupted);
  expectOneToOne(mesh, map);
}

TEST(SphereMap, RefusesWhatIsNoSphere) {
  EXPECT_THROW((void)mapToSphere(geometry::makeTorus(16, 8, 3, 1)), InvalidInput);
  EXPECT_THROW((void)mapToSphere(geometry::makeRectangle(4, 4, 1, 1)), InvalidInput);
  EXPECT_THROW((void)mapToSphere(geometry::joined(geometry::makeIcosphere(1),
                                                  geometry::makeIcosphere(1, 1, Point(5, 0, 0)))),
               InvalidInput);
}

TEST(SphereDistortion, OfAScaledSphereIsNoneAndOfASpheroidItsOwn) {
  const TriangleMesh sphere = geometry::makeIcosphere(3);
  const auto none = sphereDistortion(sphere, 100 * sphere.positions);
  EXPECT_NEAR(none.arealMax, 0, 1e-12);
  EXPECT_NEAR(none.stretchP95, 1, 1e-6);
  EXPECT_EQ(none.turnedOver, 0);
  TriangleMesh sheared = geometry::makeRectangle(4, 4, 1, 1);
  sheared.positions.col(2).array() = 1;
  Positions image = sheared.positions;
  image.col(0) *= 3;
  const auto stretched = sphereDistortion(sheared, image);
  EXPECT_NEAR(stretched.stretchMedian, 3, 1e-9);
  EXPECT_NEAR(stretched.arealMax, 0, 1e-12);
}

TEST(OneToOne, PutsBackVerticesThatCrossedTheirRings) {
  TriangleMesh mesh = geometry::makeIcosphere(4, 100);
  std::mt19937 random(3);
  std::uniform_real_distribution<double> shift(-9, 9);
  for (Eigen::Index v = 0; v < mesh.vertexCount(); v += 3) {
    for (int k = 0; k < 3; ++k) mesh.positions(v, k) += shift(random);
  }
  ASSERT_GT(geometry::turnedOver(mesh).size(), 20u);
  const Positions before = mesh.positions;
  const OneToOne mended = makeOneToOne(mesh);
  EXPECT_GT(mended.turnedBefore, 20);
  EXPECT_EQ(mended.turnedAfter, 0);
  EXPECT_TRUE(geometry::turnedOver(mesh).empty());
  std::size_t next = 0;
  for (std::int32_t v = 0; v < mesh.vertexCount(); ++v) {
    if (next < mended.moved.size() && mended.moved[next] == v) {
      ++next;
    } else {
      EXPECT_LT((mesh.positions.row(v).normalized() - before.row(v).normalized()).norm(), 1e-6);
    }
  }
}

// Long needles, as flat parts of a surface have them, under a map that bends: a face is turned over
// where a vertex crosses the way between two that are far from each other.  Each is mended where it
// is, none is spread over its surroundings.
TEST(OneToOne, MendsNeedlesThatAMapBendsWithoutMovingOthers) {
  for (const double bend : {0.1, 0.2, 0.4}) {
    TriangleMesh mesh = geometry::makeIcosphere(4);
    mesh.positions.col(2) /= 100;  // a linear map turns no face over
    mesh.positions.rowwise().normalize();
    ASSERT_TRUE(geometry::turnedOver(mesh).empty());
    for (Eigen::Index v = 0; v < mesh.vertexCount(); ++v) {
      const double longitude = std::atan2(mesh.positions(v, 1), mesh.positions(v, 0));
      mesh.positions(v, 2) +=
          bend * std::sin(3 * longitude) * mesh.positions.row(v).head<2>().norm();
    }
    const OneToOne mended = makeOneToOne(mesh);
    EXPECT_GT(mended.turnedBefore, 50);
    EXPECT_EQ(mended.turnedAfter, 0);
    EXPECT_EQ(testing::timesCovered(mesh), 1);
    EXPECT_LT(mended.moved.size(), static_cast<std::size_t>(mended.turnedBefore)) << bend;
  }
}

TEST(MeansAtVertices, LeaveOutWhatIsNotKnown) {
  const TriangleMesh mesh = geometry::makeIcosphere(1);
  Eigen::VectorXd values = Eigen::VectorXd::Constant(mesh.faceCount(), 2.0);
  values[0] = kNaN;
  const Eigen::VectorXd means = meansAtVertices(mesh, values);
  EXPECT_TRUE(means.isApproxToConstant(2.0));
}

}  // namespace
}  // namespace explica::sphere
