// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Flattening/Flatten.h"

#include "Explica/Core/Errors.h"
#include "Explica/Core/Parallel.h"
#include "Explica/Core/StopScope.h"
#include "Explica/Flattening/Comparison.h"
#include "Explica/Flattening/RimContact.h"
#include "Explica/Geometry/Fixtures.h"
#include "Explica/Geometry/MeshMeasures.h"
#include "Explica/Geometry/SelfIntersection.h"
#include "Explica/Testing/Meshes.h"
#include "Explica/Testing/Selections.h"

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <random>

namespace explica::flattening {
namespace {

using testing::everyFace;

Disc wholeDisc(const TriangleMesh& mesh) {
  return discOf(mesh, everyFace(mesh));
}

/// The faces of a mesh whose corners all satisfy a condition.
template <class Condition>
Disc partOf(const TriangleMesh& mesh, const Condition& condition) {
  std::vector<std::int32_t> faces;
  for (Eigen::Index f = 0; f < mesh.faceCount(); ++f) {
    if (condition(mesh.corner(f, 0)) && condition(mesh.corner(f, 1)) &&
        condition(mesh.corner(f, 2))) {
      faces.push_back(static_cast<std::int32_t>(f));
    }
  }
  return discOf(mesh, faces);
}

TriangleMesh mapOf(const Disc& disc, const FlatMap& map) {
  TriangleMesh flat{Positions::Zero(disc.mesh.vertexCount(), 3), disc.mesh.faces};
  flat.positions.leftCols<2>() = map.positions;
  return flat;
}

double largestStrain(const TriangleMesh& before, const TriangleMesh& after) {
  double largest = 0;
  for (Eigen::Index f = 0; f < before.faceCount(); ++f) {
    for (int k = 0; k < 3; ++k) {
      const double l0 = (before.corner(f, (k + 1) % 3) - before.corner(f, k)).norm();
      const double l1 = (after.corner(f, (k + 1) % 3) - after.corner(f, k)).norm();
      largest = std::max(largest, std::abs(l1 / l0 - 1));
    }
  }
  return largest;
}

double meanAreaError(const TriangleMesh& before, const TriangleMesh& after) {
  return (geometry::faceAreas(after).cwiseQuotient(geometry::faceAreas(before)).array() - 1)
      .abs()
      .mean();
}

void expectOneToOne(const Disc& disc, const FlatMap& map) {
  EXPECT_EQ(map.turnedOver, 0);
  EXPECT_EQ(map.rimCrossings, 0);
  EXPECT_TRUE(geometry::findSelfIntersections(mapOf(disc, map)).empty());
}

/// Rolls the plane up: x becomes the angle of a cylinder.
TriangleMesh onCylinder(TriangleMesh mesh, double radius) {
  for (Eigen::Index v = 0; v < mesh.vertexCount(); ++v) {
    const double angle = mesh.positions(v, 0) / radius;
    mesh.positions.row(v) << radius * std::sin(angle), mesh.positions(v, 1),
        radius * std::cos(angle);
  }
  return mesh;
}

FlattenOptions sharp() {
  FlattenOptions options;
  options.tolerance = 1e-12;
  return options;
}

TEST(Flatten, APlanarPatchKeepsEveryLength) {
  TriangleMesh mesh = geometry::makeRectangle(17, 11, 34, 20);
  const Eigen::AngleAxisd turn(0.7, Vector(1, 2, 3).normalized());
  mesh.positions = (mesh.positions * turn.toRotationMatrix().transpose()).eval();
  const Disc disc = wholeDisc(mesh);
  const FlatMap map = flatten(disc, sharp());
  expectOneToOne(disc, map);
  // Coordinates below 32 mm are written to 2e-6 mm, edges are 2 mm long.
  EXPECT_LT(largestStrain(disc.mesh, mapOf(disc, map)), 4e-6);
}

TEST(Flatten, FacetsAroundACylinderUnrollWithoutStrain) {
  // Rows of facets along the axis are flat strips, so that the faceted cylinder itself unrolls.
  const TriangleMesh mesh = onCylinder(geometry::makeRectangle(40, 6, 50, 12), 20);
  const Disc disc = wholeDisc(mesh);
  for (const FlattenOptions& options : {FlattenOptions(), sharp()}) {
    const FlatMap map = flatten(disc, options);
    expectOneToOne(disc, map);
    EXPECT_LT(largestStrain(disc.mesh, mapOf(disc, map)), 1e-5);
    EXPECT_EQ(map.termination, Termination::Converged);
  }
}

TEST(Flatten, AFacetedConeUnrollsWithoutStrain) {
  TriangleMesh mesh = geometry::makeRectangle(30, 8, 1.5, 10);
  for (Eigen::Index v = 0; v < mesh.vertexCount(); ++v) {
    // Straight generators from the tip: x is the angle about the axis, y the way from the tip.
    const double angle = mesh.positions(v, 0), way = mesh.positions(v, 1) + 5;
    mesh.positions.row(v) << 0.6 * way * std::cos(angle), 0.6 * way * std::sin(angle), -0.8 * way;
  }
  const Disc disc = wholeDisc(mesh);
  const FlatMap map = flatten(disc, sharp());
  expectOneToOne(disc, map);
  EXPECT_LT(largestStrain(disc.mesh, mapOf(disc, map)), 1e-5);
}

TEST(Flatten, AHalfSphereKeepsAreasAndLiesBetweenTheKnownMaps) {
  const Disc disc =
      partOf(geometry::makeIcosphere(4, 20), [](const Point& p) { return p.z() > -0.1; });
  const FlatMap map = flatten(disc);
  expectOneToOne(disc, map);
  const TriangleMesh flat = mapOf(disc, map);
  EXPECT_LT(meanAreaError(disc.mesh, flat), 0.0101);
  // Archimedes: the map of a half sphere that keeps areas is a disc of radius sqrt(2) r.
  double rim = 0;
  for (const std::int32_t v : disc.rim) rim += flat.positions.row(v).norm();
  rim /= static_cast<double>(disc.rim.size());
  EXPECT_NEAR(rim, std::sqrt(2.0) * 20, 0.02 * rim);
}

TEST(Flatten, AreasAreKeptBetterTheMoreIsAsked) {
  const Disc disc =
      partOf(geometry::makeFoldedSphere(5, 30, 0.2, 5), [](const Point& p) { return p.z() > 5; });
  double before = kInfinity;
  for (const double tolerance : {0.1, 0.03, 0.01}) {
    FlattenOptions options;
    options.areaTolerance = tolerance;
    const FlatMap map = flatten(disc, options);
    expectOneToOne(disc, map);
    const double error = meanAreaError(disc.mesh, mapOf(disc, map));
    EXPECT_LT(error, tolerance * 1.02);
    EXPECT_LE(error, before);
    before = error;
  }
}

TEST(Flatten, ASphereWithASmallOpeningNeitherFoldsNorOverlaps) {
  // Nine tenths of a sphere: the rim is far too short for what it encloses.
  const Disc disc =
      partOf(geometry::makeIcosphere(4, 10), [](const Point& p) { return p.z() > -8; });
  FlattenOptions options;
  options.areaTolerance = 0.3;
  expectOneToOne(disc, flatten(disc, options));
}

TEST(Flatten, HolesStayOpenAndNothingLiesInThem) {
  const Disc disc = partOf(geometry::makeFoldedSphere(4, 20, 0.1, 4), [](const Point& p) {
    return p.z() > 2 && (p - Point(0, 0, 20)).norm() > 6;
  });
  ASSERT_EQ(disc.holes.size(), 1U);
  const FlatMap map = flatten(disc);
  expectOneToOne(disc, map);
  EXPECT_LT(meanAreaError(disc.mesh, mapOf(disc, map)), 0.0101);
}

TEST(Flatten, ACombWhoseTeethCouldLandOnEachOtherStaysOneToOne) {
  // A strip with deep cuts over a sphere: its teeth spread, and may not meet.
  const Disc disc = partOf(geometry::makeIcosphere(5, 20), [](const Point& p) {
    const double angle = std::atan2(p.y(), p.x());
    return p.z() > -17 && (p.z() > 12 || std::abs(std::sin(3 * angle)) > 0.15);
  });
  FlattenOptions options;
  options.areaTolerance = 0.05;
  expectOneToOne(disc, flatten(disc, options));
}

TEST(Flatten, TheMapDoesNotDependOnTheNumberOfThreads) {
  const Disc disc =
      partOf(geometry::makeFoldedSphere(4, 30, 0.2, 5), [](const Point& p) { return p.z() > 5; });
  const int before = threadCount();
  setThreadCount(1);
  const FlatMap one = flatten(disc);
  setThreadCount(3);
  const FlatMap three = flatten(disc);
  setThreadCount(before);
  EXPECT_TRUE(one.positions == three.positions);
}

/// A folded cap, and a monitor that asks to stop at the n-th question.
Disc foldedCap() {
  return partOf(geometry::makeFoldedSphere(4, 30, 0.2, 5),
                [](const Point& p) { return p.z() > 5; });
}

Monitor stoppingAt(int question, int& asked) {
  Monitor monitor;
  monitor.stopWanted = [question, &asked] { return ++asked > question; };
  return monitor;
}

TEST(Flatten, StoppedAnywhereItIsOneToOneAndGoesOnToTheMapOfARunThatNeverStopped) {
  const Disc disc = foldedCap();
  int questions = 0;
  FlattenOptions options;
  options.frames = 4;
  const FlatMap whole = flatten(disc, options, stoppingAt(1 << 20, questions));
  ASSERT_GT(questions, 6);
  for (int at = 0; at < questions; at += 3) {
    int asked = 0;
    const FlatMap stopped = flatten(disc, options, stoppingAt(at, asked));
    EXPECT_EQ(stopped.termination, Termination::Interrupted) << at;
    expectOneToOne(disc, stopped);
    const FlatMap resumed = flatten(disc, options, {}, &stopped.state);
    EXPECT_EQ(resumed.termination, whole.termination);
    EXPECT_EQ(resumed.iterations, whole.iterations);
    EXPECT_TRUE(resumed.positions == whole.positions) << at;
    EXPECT_TRUE(resumed.frames == whole.frames) << at;
  }
  const FlatMap again = flatten(disc, options, {}, &whole.state);
  EXPECT_TRUE(again.positions == whole.positions);  // nothing was left to do
}

TEST(Flatten, StoppedOnACoarseLevelItGoesOnFromThere) {
  const Disc disc =
      partOf(geometry::makeFoldedSphere(6, 30, 0.2, 5), [](const Point& p) { return p.z() > 5; });
  int asked = 0;
  const FlatMap stopped = flatten(disc, {}, stoppingAt(2, asked));
  EXPECT_EQ(stopped.state.level, 1);
  EXPECT_EQ(stopped.state.iterations, 2);
  expectOneToOne(disc, stopped);
  EXPECT_TRUE(flatten(disc, {}, {}, &stopped.state).positions == flatten(disc).positions);
}

/// Before there is a map nothing is worth going on for; from then on no stop loses it.
TEST(Flatten, AStopWithinTheCoarseningEndsItAndAnyLaterOneLeavesAMap) {
  const Disc disc = foldedCap();
  std::atomic<int> asked = 0;
  const auto stoppedAt = [&](int at) {
    asked = 0;
    Monitor monitor;
    monitor.stopWanted = [at, &asked] { return ++asked > at; };
    const StopScope scope(&monitor);
    return flatten(disc, {}, monitor);
  };
  (void)stoppedAt(1 << 20);
  const int questions = asked;
  EXPECT_THROW((void)stoppedAt(0), Interrupted);
  int mapped = 0;
  try {
    for (; mapped < questions; ++mapped) expectOneToOne(disc, stoppedAt(questions - 1 - mapped));
  } catch (const Interrupted&) {
  }
  EXPECT_GT(mapped, 6);  // iterations
  EXPECT_LT(mapped, questions);
  EXPECT_THROW((void)stoppedAt((questions - mapped) / 2), Interrupted);
}

/// Lobes on thin stalks, a small lobe on a large one and so on: the map of few vertices into a
/// circle would shrink them beyond rounding.
TEST(Flatten, LobesBehindLobesStayOneToOne) {
  TriangleMesh mesh = geometry::makeIcosphere(5, 10);
  for (Eigen::Index v = 0; v < mesh.vertexCount(); ++v) {
    const double height = (mesh.positions(v, 2) + 10) / 20;  // 0 to 1
    const double girth = 0.15 + std::abs(std::cos(3.5 * kPi * height));
    mesh.positions.row(v).head<2>() *= girth;
    mesh.positions(v, 2) *= 4;
  }
  const Disc disc = partOf(mesh, [](const Point& p) { return p.z() > -38; });
  FlattenOptions options;
  options.areaTolerance = 0.3;
  expectOneToOne(disc, flatten(disc, options));
  int asked = 0;
  expectOneToOne(disc, flatten(disc, options, stoppingAt(0, asked)));
}

TEST(Flatten, ASmallerAreaToleranceTakesAFinishedMapFurther) {
  const Disc disc = foldedCap();
  FlattenOptions options;
  options.areaTolerance = 0.05;
  const FlatMap rough = flatten(disc, options);
  options.areaTolerance = 0.005;
  const FlatMap fine = flatten(disc, options, {}, &rough.state);
  EXPECT_GT(meanAreaError(disc.mesh, mapOf(disc, rough)), 0.008);
  EXPECT_LT(meanAreaError(disc.mesh, mapOf(disc, fine)), 0.00505);
}

TEST(Flatten, FramesLeadFromACircleToTheMapAndAreOneToOne) {
  const Disc disc = foldedCap();
  FlattenOptions options;
  options.frames = 6;
  FlatMap map = flatten(disc, options);
  ASSERT_EQ(map.frames.size(), 6U);
  EXPECT_TRUE(map.frames.back() == map.positions);
  std::vector<double> toEnd;
  for (const FlatPositions& frame : map.frames) {
    FlatMap state = map;
    state.positions = frame;
    state.turnedOver = countTurnedOver(disc.mesh.faces, frame);
    state.rimCrossings = static_cast<std::int64_t>(rimCrossings(disc.rim, frame).size());
    expectOneToOne(disc, state);
    toEnd.push_back((frame - map.positions).norm());
  }
  EXPECT_GT(toEnd[0], toEnd[3]);
  EXPECT_GT(toEnd[3], toEnd[4]);
  // The coarsest rim lies on a circle; what was put back lies near it.
  double least = kInfinity, most = 0;
  for (const std::int32_t v : disc.rim) {
    const double radius = map.frames.front().row(v).norm();
    least = std::min(least, radius);
    most = std::max(most, radius);
  }
  EXPECT_LT(most / least, 1.3);
  options.frames = 0;
  EXPECT_TRUE(flatten(disc, options).positions == map.positions);
}

TEST(Flatten, RefusesAStateOfAnotherDisc) {
  const Disc disc = foldedCap();
  int asked = 0;
  const FlatMap stopped = flatten(disc, {}, stoppingAt(5, asked));
  const Disc other =
      partOf(geometry::makeFoldedSphere(4, 30, 0.2, 5), [](const Point& p) { return p.z() > 7; });
  EXPECT_THROW((void)flatten(other, {}, {}, &stopped.state), InvalidInput);
  FlattenState wrong = stopped.state;
  wrong.level = 40;
  EXPECT_THROW((void)flatten(disc, {}, {}, &wrong), InvalidInput);
}

TEST(Flatten, ScalesWithTheSurface) {
  const TriangleMesh mesh = geometry::makeFoldedSphere(4, 32, 0.2, 5);
  TriangleMesh small = mesh;
  small.positions /= 64;
  const auto top = [](double limit) { return [limit](const Point& p) { return p.z() > limit; }; };
  const Disc disc = partOf(mesh, top(5)), tiny = partOf(small, top(5.0 / 64));
  ASSERT_EQ(disc.faceOrigin, tiny.faceOrigin);
  const FlatMap map = flatten(disc), scaled = flatten(tiny);
  EXPECT_LT((map.positions - 64 * scaled.positions).cwiseAbs().maxCoeff(), 1e-4);
}

TEST(Flatten, PointsUpWhereTheReferenceDoes) {
  TriangleMesh mesh = geometry::makeRectangle(10, 10, 20, 20);
  for (Eigen::Index v = 0; v < mesh.vertexCount(); ++v) {  // a wall seen from -x: z goes up
    const double x = mesh.positions(v, 0), y = mesh.positions(v, 1);
    mesh.positions.row(v) << 0, -x, y;
  }
  const Disc disc = wholeDisc(mesh);
  const FlatMap map = flatten(disc);
  const Eigen::VectorXd z = disc.mesh.positions.col(2).array() - 10;
  EXPECT_LT((map.positions.col(1) - z).cwiseAbs().maxCoeff(), 1e-3);
}

TEST(Disc, WhatHangsOnByOneVertexIsLeftOutAndCounted) {
  TriangleMesh mesh = geometry::makeRectangle(6, 6, 6, 6);
  std::vector<std::int32_t> faces;
  for (Eigen::Index f = 0; f < mesh.faceCount(); ++f) {
    Point middle = (mesh.corner(f, 0) + mesh.corner(f, 1) + mesh.corner(f, 2)) / 3;
    const bool large = middle.x() < 4 && middle.y()<4, corner = middle.x()> 4 && middle.y() > 4;
    if (large || corner) faces.push_back(static_cast<std::int32_t>(f));
  }
  const Disc disc = discOf(mesh, faces);
  EXPECT_EQ(disc.mesh.faceCount(), 32);
  EXPECT_EQ(disc.trimmedFaces, 8U);
}

TEST(Disc, TheLargestPieceIsTakenWhereItHasMoreThanHalfOfTheArea) {
  const TriangleMesh small = geometry::makeRectangle(2, 2, 2, 2);
  const TriangleMesh both = geometry::joined(small, geometry::makeRectangle(4, 4, 4, 4));
  const Disc disc = wholeDisc(both);
  EXPECT_EQ(disc.mesh.faceCount(), 32);
  EXPECT_EQ(disc.otherPieces, 1U);
  EXPECT_NEAR(disc.areaOfOthers, 0.2, 1e-12);
  for (const std::int32_t f : disc.faceOrigin) EXPECT_GE(f, small.faceCount());
  for (const std::int32_t v : disc.vertexOrigin) EXPECT_GE(v, small.vertexCount());
}

TEST(Disc, RefusesWhatNoPlaneCanHold) {
  EXPECT_THROW((void)wholeDisc(geometry::makeIcosphere(2)), InvalidInput);
  EXPECT_THROW((void)discOf(geometry::makeIcosphere(2), {}), InvalidInput);
  const TriangleMesh a = geometry::makeRectangle(3, 3, 3, 3);
  EXPECT_THROW((void)wholeDisc(geometry::joined(a, a)), InvalidInput);
  TriangleMesh torus = geometry::makeTorus(24, 12, 10, 3);
  torus.faces = torus.faces.topRows(torus.faceCount() - 1).eval();
  EXPECT_THROW((void)wholeDisc(torus), InvalidInput);
}

TEST(Flatten, RefusesASurfaceWithoutAreaAndOptionsOutOfRange) {
  TriangleMesh mesh = geometry::makeRectangle(4, 4, 4, 4);
  FlattenOptions options;
  options.areaTolerance = 0;
  EXPECT_THROW((void)flatten(wholeDisc(mesh), options), InvalidInput);
  mesh.positions.col(0).setZero();
  EXPECT_THROW((void)flatten(wholeDisc(mesh)), InvalidInput);
}

TEST(Flatten, NeedlesAndFacesOfNoAreaDoNotHinderTheRest) {
  TriangleMesh mesh = geometry::makeRectangle(8, 8, 8, 8);
  mesh.positions.row(40) = mesh.positions.row(41);  // two faces vanish, others become needles
  const Disc disc = wholeDisc(mesh);
  const FlatMap map = flatten(disc);
  EXPECT_GE(map.raisedFaces, 2U);
  expectOneToOne(disc, map);
}

TEST(RimCrossings, FindsCrossingsTouchesAndEdgesThatRunBack) {
  FlatPositions flat(5, 2);
  flat << 0, 0, 4, 0, 4, 4, 2, -1, 0, 4;
  EXPECT_EQ(rimCrossings({0, 1, 2, 3, 4}, flat).size(), 2U);
  flat.row(3) << 2, 0;  // touches the first edge
  EXPECT_FALSE(rimCrossings({0, 1, 2, 3, 4}, flat).empty());
  flat.row(3) << 2, 3;
  EXPECT_TRUE(rimCrossings({0, 1, 2, 3, 4}, flat).empty());
  flat << 0, 0, 4, 0, 4, 4, 4, 2, 0, 4;  // from the third to the fourth back along the second
  EXPECT_FALSE(rimCrossings({0, 1, 2, 3, 4}, flat).empty());
}

}  // namespace
}  // namespace explica::flattening
