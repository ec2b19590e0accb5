// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Sphere/Register.h"

#include "Explica/Core/Errors.h"
#include "Explica/Core/Parallel.h"
#include "Explica/Geometry/Fixtures.h"
#include "Explica/Geometry/SphereLocator.h"
#include "Explica/Testing/TimesCovered.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

namespace explica::sphere {
namespace {

/// A sphere with smooth maps that no rotation repeats.
FoldingSphere foldedAt(const Positions& places) {
  FoldingSphere folding;
  folding.sphere = geometry::makeIcosphere(4, 100);
  const auto x = places.col(0).array(), y = places.col(1).array(), z = places.col(2).array();
  folding.sulc = ((5 * x).sin() + (4 * y + z).cos() + 2 * x * z).matrix();
  folding.curvature = ((9 * z + x).cos() + (7 * y - 5 * x).sin()).matrix();
  return folding;
}

FoldingSphere folded() {
  return foldedAt(geometry::makeIcosphere(4).positions);
}

RegisterOptions quick() {
  RegisterOptions options;
  options.level = 3;
  return options;
}

/// Largest and mean angle between directions, degrees.
std::pair<double, double> anglesBetween(const Positions& a, const Positions& b) {
  const Eigen::VectorXd chords =
      (a.rowwise().normalized() - b.rowwise().normalized()).rowwise().norm();
  return {chords.maxCoeff() * 180 / kPi, chords.mean() * 180 / kPi};
}

TEST(RegisterSphere, ToItselfIsTheIdentity) {
  const FoldingSphere sphere = folded();
  const auto result = registerSphere(sphere, sphere, quick());
  EXPECT_LT(anglesBetween(result.positions, sphere.sphere.positions).first, 0.1);
  EXPECT_GT(result.after.sulc, 0.999);
}

TEST(RegisterSphere, TurnsBackARotation) {
  const FoldingSphere target = folded();
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(kPi / 3, Vector(1, -2, 0.5).normalized()).toRotationMatrix();
  FoldingSphere moving = target;
  moving.sphere.positions *= turn.transpose();
  const auto result = registerSphere(moving, target, quick());
  EXPECT_LT(result.before.sulc, 0.5);
  EXPECT_LT(anglesBetween(result.positions, target.sphere.positions).first, 0.5);
  EXPECT_LT(Eigen::AngleAxisd(result.rotation * turn).angle() * 180 / kPi, 0.5);
}

TEST(RegisterSphere, FindsAWarpWithinItsBoundOfAreas) {
  // Maps of places that were moved along z by a smooth one-to-one map.
  const TriangleMesh grid = geometry::makeIcosphere(4);
  Positions places = grid.positions;
  places.col(2).array() += 0.25 * (1 - places.col(2).array().square());
  places.rowwise().normalize();
  const FoldingSphere target = folded(), moving = foldedAt(places);
  RegisterOptions options = quick();
  options.level = 4;
  options.rotate = false;
  options.smoothness = 0.2;
  const auto result = registerSphere(moving, target, options);
  EXPECT_GT(result.after.sulc, result.before.sulc);
  EXPECT_GT(result.after.sulc, 0.99);
  EXPECT_LT(anglesBetween(result.positions, places).second, 1);
  EXPECT_EQ(result.rounding.turnedAfter, 0);
  const TriangleMesh registered{result.positions, moving.sphere.faces};
  EXPECT_TRUE(geometry::turnedOver(registered).empty());
  EXPECT_EQ(testing::timesCovered(registered), 1);
  options.maxAreal = 0.2;
  const auto bounded = registerSphere(moving, target, options);
  // The bound is on flat faces at their heights over the centre, some 0.02 less on this grid.
  EXPECT_LE(bounded.arealLog2.cwiseAbs().maxCoeff(), 0.22);
  EXPECT_GT(result.arealLog2.cwiseAbs().maxCoeff(), 0.3);
}

// Folds 15 degrees apart were moved by up to 14.  A coarse level that still shows them draws each
// to its neighbour; what is broader than they leads them home.
TEST(RegisterSphere, BringsFoldsHomePastTheirNeighbours) {
  const TriangleMesh grid = geometry::makeIcosphere(5);
  const auto foldedLike = [&](const Positions& places) {
    FoldingSphere folding;
    folding.sphere = geometry::makeIcosphere(5, 100);
    const auto x = places.col(0).array(), y = places.col(1).array(), z = places.col(2).array();
    const Eigen::VectorXd narrow = (24 * z + 2 * x).sin().matrix();
    folding.sulc = ((5 * x).sin() + (4 * y + z).cos() + 2 * z * (1 + x)).matrix() + 2 * narrow;
    folding.curvature = ((4 * z + x).cos() + (3 * y - 5 * x).sin()).matrix() + 2 * narrow;
    return folding;
  };
  Positions places = grid.positions;
  places.col(2).array() += 0.25 * (1 - places.col(2).array().square());
  places.rowwise().normalize();
  RegisterOptions options;
  options.level = 5;
  options.rotate = false;
  options.smoothness = 0.5;
  const auto result = registerSphere(foldedLike(places), foldedLike(grid.positions), options);
  const auto angles = anglesBetween(result.positions, places);
  EXPECT_LT(angles.second, 1) << "largest " << angles.first;
}

// Parts of the sphere are twisted against each other by as much as the folds are apart: after the
// rotation that agrees best one of them lies in the neighbours of its folds.
TEST(RegisterSphere, DoesNotTrustTheRotationThatAgreesBest) {
  const TriangleMesh grid = geometry::makeIcosphere(5);
  const auto foldedLike = [&](const Positions& places) {
    FoldingSphere folding;
    folding.sphere = geometry::makeIcosphere(5, 100);
    const auto x = places.col(0).array(), y = places.col(1).array(), z = places.col(2).array();
    Eigen::VectorXd narrow(places.rows());  // 30 degrees apart
    for (Eigen::Index v = 0; v < places.rows(); ++v) {
      narrow[v] = 2 * std::sin(12 * std::atan2(y[v], x[v])) * std::hypot(x[v], y[v]);
    }
    folding.sulc = ((3 * x).sin() + (2 * y + z).cos() + 2 * z * (1 + x)).matrix() + narrow;
    folding.curvature = ((2 * z + x).cos() + (2 * y - 3 * x).sin()).matrix() + narrow;
    return folding;
  };
  Positions places = grid.positions;
  for (Eigen::Index v = 0; v < places.rows(); ++v) {
    const double angle = 15 * kPi / 180 * std::tanh(4 * (places(v, 2) + 0.3));
    places.row(v) = (Eigen::AngleAxisd(angle, Vector::UnitZ()) * Point(places.row(v))).transpose();
  }
  RegisterOptions options;
  options.level = 5;
  options.smoothness = 0.5;
  const auto result = registerSphere(foldedLike(places), foldedLike(grid.positions), options);
  const auto angles = anglesBetween(result.positions, places);
  EXPECT_LT(angles.second, 1) << "largest " << angles.first;
}

TEST(RegisterSphere, MirroredSpheresAgree) {
  const FoldingSphere target = folded();
  FoldingSphere moving = target;
  moving.sphere.positions.col(0) *= -1;  // faces of a left hemisphere run the same way outwards
  moving.sphere.faces.col(1).swap(moving.sphere.faces.col(2));
  moving.sphere = mirrored(std::move(moving.sphere));
  const auto result = registerSphere(moving, target, quick());
  EXPECT_LT(anglesBetween(result.positions, target.sphere.positions).first, 0.1);
}

TEST(RegisterSphere, DoesNotDependOnThreads) {
  const FoldingSphere target = folded();
  FoldingSphere moving = target;
  moving.sulc.array() += 0.3 * moving.curvature.array();
  const Positions once = registerSphere(moving, target, quick()).positions;
  setThreadCount(1);
  EXPECT_TRUE(registerSphere(moving, target, quick()).positions == once);
  setThreadCount(0);
}

TEST(RegisterSphere, RefusesMapsOfAnotherMesh) {
  FoldingSphere moving = folded();
  moving.sulc.conservativeResize(100);
  EXPECT_THROW((void)registerSphere(moving, folded(), quick()), InvalidInput);
}

}  // namespace
}  // namespace explica::sphere
