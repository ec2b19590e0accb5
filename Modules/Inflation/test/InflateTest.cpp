// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Inflation/Inflate.h"

#include "Explica/Core/Errors.h"
#include "Explica/Core/Parallel.h"
#include "Explica/Geometry/Fixtures.h"
#include "Explica/Geometry/MeshMeasures.h"
#include "Explica/Geometry/SelfIntersection.h"
#include "Explica/Inflation/DirectionField.h"
#include "Explica/Testing/Meshes.h"
#include "Explica/Unfolding/Distortion.h"
#include "Explica/Visibility/SphereView.h"

#include "Explica/Core/StopScope.h"

#include <gtest/gtest.h>

#include <atomic>

#include <Eigen/Geometry>

#include <algorithm>
#include <numeric>

namespace explica::inflation {
namespace {

/// Folds of a closed surface that hide each other.
TriangleMesh folded() {
  return geometry::makeFoldedSphere(4, 30.0, 0.5, 9);
}

double visibilityOf(const TriangleMesh& mesh) {
  return visibility::lookFromSphere(mesh, visibility::enclosingSphere(mesh, 64)).visibility;
}

unfolding::Distortion distortionOf(const TriangleMesh& before, const TriangleMesh& after) {
  std::vector<std::int32_t> all(static_cast<std::size_t>(before.faceCount()));
  std::iota(all.begin(), all.end(), 0);
  return unfolding::measureDistortion(before, after.positions, all);
}

TEST(Inflate, ASphereStaysAsItIs) {
  const TriangleMesh sphere = geometry::makeIcosphere(3, 40);
  const InflateResult result = inflate(sphere);
  EXPECT_EQ(result.termination, Termination::TargetReached);
  EXPECT_EQ(result.history.size(), 1u);
  EXPECT_NEAR(result.history.back().visibility, 1, 1e-4);
  EXPECT_EQ(result.mesh.positions, sphere.positions);
}

TEST(Inflate, OpensFoldsKeepsAreasAndCrossesNowhere) {
  const TriangleMesh mesh = folded();
  ASSERT_LT(visibilityOf(mesh), 0.85);
  InflateOptions options;
  options.frames = 5;
  const InflateResult result = inflate(mesh, options);
  EXPECT_EQ(result.termination, Termination::TargetReached);
  EXPECT_EQ(result.flag, unfolding::Flag::None);
  EXPECT_GE(visibilityOf(result.mesh), 0.98);
  EXPECT_EQ(result.history.back().seen, 1);
  EXPECT_LE(distortionOf(mesh, result.mesh).areaErrorMean, 0.008);
  EXPECT_TRUE(geometry::findSelfIntersections(result.mesh).empty());
  ASSERT_EQ(result.frames.size(), 5u);
  EXPECT_EQ(result.frames.front().positions, mesh.positions);
  EXPECT_EQ(result.frames.back().positions, result.mesh.positions);
  for (const InflateFrame& frame : result.frames) {
    const TriangleMesh state{frame.positions, mesh.faces};
    EXPECT_TRUE(geometry::findSelfIntersections(state).empty());
    EXPECT_NEAR(visibilityOf(state), frame.visibility, 0.03);
  }
  // No step raises its objective.
  for (const InflateRecord& row : result.history) {
    EXPECT_LE(row.step.objectiveAfter, row.step.objectiveBefore + 1e-9);
  }
}

TEST(Inflate, OfTheMirrorImageIsTheMirrorImage) {
  const TriangleMesh mesh = folded();
  TriangleMesh mirrored = mesh;
  mirrored.positions.col(0) *= -1;  // its faces now look inward
  ASSERT_LT(geometry::enclosedVolume(mirrored), 0);
  const InflateResult one = inflate(mesh), other = inflate(mirrored);
  EXPECT_EQ(other.mesh.faces, mesh.faces);
  const auto a = distortionOf(mesh, one.mesh), b = distortionOf(mirrored, other.mesh);
  EXPECT_NEAR(b.edgeStrainMean, a.edgeStrainMean, 0.05 * a.edgeStrainMean);
  EXPECT_NEAR(-geometry::enclosedVolume(other.mesh), geometry::enclosedVolume(one.mesh),
              0.02 * geometry::enclosedVolume(one.mesh));
}

TEST(Inflate, TurnsAndGrowsWithTheSurface) {
  const TriangleMesh mesh = folded();
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(0.7, Vector(0.5, 0.3, -0.6).normalized()).toRotationMatrix();
  TriangleMesh other = mesh;
  other.positions = 2 * mesh.positions * turn.transpose();
  other.positions.rowwise() += Eigen::RowVector3d(2000, -500, 100);
  const InflateResult a = inflate(mesh), b = inflate(other);
  const double strainA = distortionOf(mesh, a.mesh).edgeStrainMean;
  EXPECT_NEAR(distortionOf(other, b.mesh).edgeStrainMean, strainA, 0.05 * strainA);
  EXPECT_NEAR(geometry::enclosedVolume(b.mesh), 8 * geometry::enclosedVolume(a.mesh),
              0.02 * 8 * geometry::enclosedVolume(a.mesh));
}

TEST(Inflate, ResumedEqualsARunThatNeverStopped) {
  const TriangleMesh mesh = folded();
  InflateOptions options;
  options.frames = 3;
  const InflateResult whole = inflate(mesh, options);
  for (const int stop : {3, 4}) {  // between two looks, and at one
    InflateOptions part = options;
    part.maxIterations = stop;
    const InflateResult first = inflate(mesh, part);
    ASSERT_EQ(first.termination, Termination::MaxIterations);
    const InflateResult rest = inflate(mesh, options, {}, &first.checkpoint);
    EXPECT_EQ(rest.termination, whole.termination);
    EXPECT_EQ(rest.mesh.positions, whole.mesh.positions) << stop;
    ASSERT_EQ(rest.history.size(), whole.history.size());
    EXPECT_EQ(rest.history.back().visibility, whole.history.back().visibility);
    EXPECT_EQ(rest.frames[1].positions, whole.frames[1].positions);
  }
}

TEST(Inflate, DoesNotDependOnTheNumberOfThreads) {
  const TriangleMesh mesh = folded();
  InflateOptions options;
  options.maxIterations = 6;
  setThreadCount(1);
  const Positions one = inflate(mesh, options).mesh.positions;
  setThreadCount(3);
  const Positions three = inflate(mesh, options).mesh.positions;
  setThreadCount(0);
  EXPECT_EQ(one, three);
}

TEST(Inflate, SaysSoWhereTheGoalIsOutOfReach) {
  // The hole of a torus cannot be opened, and its inside never sees all of the sphere before it.
  InflateOptions options;
  options.maxIterations = 400;
  const InflateResult result = inflate(geometry::makeTorus(24, 12, 30, 12), options);
  EXPECT_EQ(result.termination, Termination::Stalled);
  EXPECT_LT(result.history.back().visibility, 0.98);
  EXPECT_TRUE(geometry::findSelfIntersections(result.mesh).empty());
}

TEST(Inflate, StopsWhenAsked) {
  Monitor monitor;
  std::atomic<int> reports = 0;
  monitor.onProgress = [&](double, std::string_view) { ++reports; };
  monitor.stopWanted = [&] { return reports >= 3; };
  const InflateResult result = inflate(folded(), {}, monitor);
  EXPECT_EQ(result.termination, Termination::Interrupted);
  EXPECT_GE(result.history.size(), 2u);
  EXPECT_LE(result.history.size(), 4u);

  monitor.stopWanted = [] { return true; };
  EXPECT_THROW((void)inflate(folded(), {}, monitor), Interrupted) << "before there is a state";
}

TEST(Inflate, RefusesWhatItCannotInflate) {
  EXPECT_THROW((void)inflate(geometry::makeRectangle(4, 4, 1, 1)), InvalidInput);
  EXPECT_THROW((void)inflate(geometry::joined(geometry::makeIcosphere(1, 1),
                                              geometry::makeIcosphere(1, 1, Point(9, 0, 0)))),
               InvalidInput);
  const TriangleMesh mesh = folded();
  const auto refused = [&](auto change) {
    InflateOptions options;
    change(options);
    EXPECT_THROW((void)inflate(mesh, options), InvalidInput);
  };
  refused([](InflateOptions& o) { o.targetSeen = 0; });
  refused([](InflateOptions& o) { o.targetSeen = 1.1; });
  refused([](InflateOptions& o) { o.smoothing = 0; });
  refused([](InflateOptions& o) { o.lookEvery = 0; });
  refused([](InflateOptions& o) { o.viewpoints = 0; });
  refused([](InflateOptions& o) { o.maxIterations = 0; });
  refused([](InflateOptions& o) { o.frames = -1; });
  const unfolding::Checkpoint foreign;
  EXPECT_THROW((void)inflate(mesh, {}, {}, &foreign), InvalidInput);
}

TEST(DirectionField, KeepsWhatIsTheSameEverywhere) {
  const TriangleMesh mesh = folded();
  Positions given(mesh.faceCount(), 3);
  given.rowwise() = Eigen::RowVector3d(0.2, 0.1, -0.3);
  const Positions spread = DirectionField(mesh, 5).spread(given);
  const Eigen::RowVector3d unit = given.row(0).normalized();
  EXPECT_LT((spread.rowwise() - unit).rowwise().norm().maxCoeff(), 1e-9);
}

TEST(DirectionField, GivesFacesThatSeeNothingWhatTheirNeighboursSee) {
  const TriangleMesh mesh = geometry::makeIcosphere(4, 10);
  Positions given = geometry::faceNormalVectors(mesh).rowwise().normalized();
  const Positions normals = given;
  for (Eigen::Index f = 0; f < mesh.faceCount(); ++f) {
    if (normals(f, 2) > 0.95) given.row(f).setZero();
  }
  const Positions spread = DirectionField(mesh, 2).spread(given);
  for (Eigen::Index f = 0; f < mesh.faceCount(); ++f) {
    if (normals(f, 2) <= 0.95) continue;
    EXPECT_GT(spread.row(f).dot(normals.row(f)), 0.9);
  }
}

// On a sphere of radius R the normals are eigenfunctions: the field is theirs over 1 + 2 s^2 / R^2,
// which their unit length hides, and a degree-2 field beside them falls by (1 + 2 t) / (1 + 6 t).
TEST(DirectionField, DampsHarmonicsAsItsEquationSays) {
  constexpr double R = 10, s = 4, t = s * s / (R * R);
  const TriangleMesh mesh = geometry::makeIcosphere(5, R);
  const Positions normals = geometry::faceNormalVectors(mesh).rowwise().normalized();
  Positions given = normals;
  for (Eigen::Index f = 0; f < mesh.faceCount(); ++f) {
    given(f, 0) += 0.1 * normals(f, 1) * normals(f, 2);
  }
  const Positions spread = DirectionField(mesh, s).spread(given);
  for (Eigen::Index f = 0; f < mesh.faceCount(); f += 97) {
    Vector expected = normals.row(f).transpose() / (1 + 2 * t);
    expected[0] += 0.1 * normals(f, 1) * normals(f, 2) / (1 + 6 * t);
    EXPECT_LT((spread.row(f).transpose() - expected.normalized()).norm(), 4e-3);
  }
}

}  // namespace
}  // namespace explica::inflation
