// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Registration/Sessions.h"

#include "Explica/Core/Errors.h"
#include "Explica/Registration/AffineRegistration.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace explica::registration {
namespace {

using Motion = Eigen::Isometry3d;

constexpr double kSpacing = 4;  // mm

Grid grid(int size = 56) {
  Grid grid;
  grid.size = {size, size, size};
  grid.spacing = Vector::Constant(kSpacing);
  grid.origin = Point::Constant(-0.5 * kSpacing * (size - 1));
  return grid;
}

/// From 1 inside to 0 outside over some 6 mm.
double inside(double distance) {
  return 1 / (1 + std::exp(distance / 1.5));
}

/// Brightness of a head without symmetry: folds, a ventricle, a skull, a jaw below.
double headAt(const Point& p, double jaw) {
  const auto ball = [&](const Vector& radii, const Point& centre) {
    return inside(((p - centre).cwiseQuotient(radii).norm() - 1) * radii.minCoeff());
  };
  const double folds = std::sin(p.x() / 9 + 0.4) * std::sin(p.y() / 10) * std::sin(p.z() / 8 + 1);
  const Point none = Point::Zero();
  const double brain = ball({62, 78, 58}, none);
  const double skull = ball({74, 90, 70}, none) - ball({68, 84, 64}, none);
  return brain * (80 + 40 * folds) - 60 * ball({13, 15, 13}, {18, 25, 5}) + 90 * skull +
         100 * ball({14, 22, 10}, {0, 55 + jaw, -78});
}

/// What a scanner shows of the head, moved to where `place` maps the head's points, with noise.
Volume<float> session(const Motion& place, double gain, double jaw, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> noise(0, 2);
  Volume<float> image(grid());
  for (std::size_t v = 0; v < image.size(); ++v) {
    const auto [i, j, k] = image.grid.subscripts(v);
    const Point at = image.grid.toWorld(Vector(i, j, k));
    image[v] = static_cast<float>(gain * (headAt(place.inverse() * at, jaw) + noise(random)));
  }
  return image;
}

Motion placed(double degrees, const Vector& axis, const Vector& shift) {
  Motion motion = Motion::Identity();
  motion.linear() = Eigen::AngleAxisd(degrees * kPi / 180, axis.normalized()).toRotationMatrix();
  motion.translation() = shift;
  return motion;
}

/// Root mean square over a brain, mm.
double apart(const Motion& a, const Motion& b) {
  double sum = 0;
  int count = 0;
  for (int n = 0; n < 1000; ++n) {
    const Point p(7 * (n % 10) - 31, 8 * (n / 10 % 10) - 36, 6 * (n / 100) - 27);
    sum += (a * p - b * p).squaredNorm();
    ++count;
  }
  return std::sqrt(sum / count);
}

TEST(RigidRegistration, FindsATurnAndAGainAlikeBothWays) {
  const Motion first = placed(7, {1, 0.3, -0.5}, {6, -4, 9}),
               second = placed(9, {-0.6, 1, 0.4}, {-8, 5, -3});
  const Volume<float> a = session(first, 1, 0, 1), b = session(second, 2.5, 0, 2);
  const RigidRegistration there = registerRigidly(a, b), back = registerRigidly(b, a);
  EXPECT_LT(apart(there.motion, second * first.inverse()), 0.02 * kSpacing);
  EXPECT_LT(apart(there.motion * back.motion, Motion::Identity()), 0.005 * kSpacing);
  EXPECT_NEAR(there.gain, 1 / 2.5, 0.01 / 2.5);
  EXPECT_GT(there.correlation, 0.97);
}

// Without weights the jaw that opened by 8 mm draws the head along by a tenth of a voxel.
TEST(RigidRegistration, IsNotDrawnByWhatMovedAgainstTheHead) {
  const Motion second = placed(5, {0.2, 1, 0.4}, {3, 5, -3});
  const Volume<float> a = session(Motion::Identity(), 1, 0, 1), b = session(second, 1, 8, 2);
  EXPECT_LT(apart(registerRigidly(a, b).motion, second), 0.03 * kSpacing);
}

TEST(SessionAverage, LiesHalfwayAndFavoursNone) {
  const Motion first = placed(4, {1, 0.3, -0.5}, {6, -4, 9}),
               second = placed(9, {-0.6, 1, 0.4}, {-8, 5, -3});
  const std::vector<Volume<float>> both = {session(first, 1, 0, 1), session(second, 2, 0, 2)};
  const SessionAverage average = averageSessions(both);
  const auto angle = [&](std::size_t s) {
    return Eigen::AngleAxisd(average.toSession[s].linear()).angle();
  };
  EXPECT_NEAR(angle(0), angle(1), 1e-6);
  const Motion between = average.toSession[1] * average.toSession[0].inverse();
  EXPECT_LT(apart(between, second * first.inverse()), 0.02 * kSpacing);
  // The other order gives the same space, and so the same mean but for the gain.
  const SessionAverage other = averageSessions({both[1], both[0]});
  EXPECT_LT(apart(average.toSession[0], other.toSession[1]), 0.02 * kSpacing);
  ASSERT_EQ(average.mean.grid.spacing[0], kSpacing);
  double sum = 0, off = 0;
  for (std::size_t v = 0; v < average.mean.size(); ++v) {
    if (average.mean[v] < 40) continue;
    sum += average.mean[v];
    off += std::abs(average.sessions[0][v] - average.sessions[1][v]);
  }
  EXPECT_LT(off / sum, 0.05);  // noise of 2, brightness of 80, and blurred edges
}

TEST(NearbyRegistration, BringsAnImageOfAnotherContrastOntoTheFirst) {
  const Motion moved = placed(4, {0.2, -0.6, 1}, {5, -3, 4});
  const Volume<float> a = session(Motion::Identity(), 1, 0, 1);
  Volume<float> b = session(moved, 1, 20, 2);  // with the jaw open
  for (float& value : b.data) value = 250 - 1.5F * value;
  EXPECT_LT(apart(registerNearby(a, b), moved), 0.05 * kSpacing);
  // On long voxels of turned axes, too; brought back, what is seen lies where the first shows it.
  Grid turned = grid();
  turned.spacing = Vector(4, 4, 6);
  turned.size[2] = 38;
  turned.direction = placed(20, {1, 1, 0}, Vector::Zero()).linear();
  turned.origin = turned.direction * Point(-110, -110, -111);
  Volume<float> oblong(turned);
  for (std::size_t v = 0; v < oblong.size(); ++v) {
    const auto [i, j, k] = turned.subscripts(v);
    const Point at = moved.inverse() * turned.toWorld(Vector(i, j, k));
    oblong[v] = static_cast<float>(250 - 1.5 * headAt(at, 20));
  }
  const Motion found = registerNearby(a, oblong);
  EXPECT_LT(apart(found, moved), 0.05 * kSpacing);
  const Vector index(20, 31, 17);
  const Point seen = turned.toWorld(index);
  EXPECT_LT((broughtBack(turned, found).toWorld(index) - moved.inverse() * seen).norm(), 0.5);
  EXPECT_THROW((void)registerNearby(a, Volume<float>(grid(), 1.0F)), InvalidInput);
  Volume<float> noise(grid());
  std::mt19937 random(1);
  for (float& value : noise.data) value = static_cast<float>(random() % 1000);
  EXPECT_THROW((void)registerNearby(a, noise), InvalidInput);
  b.grid.origin += Vector(300, 0, 0);
  EXPECT_THROW((void)registerNearby(a, b), InvalidInput);
}

TEST(SessionAverage, OfThreeTurnsToNoneInTheMean) {
  const std::vector<Motion> places = {placed(6, {1, 0, 0}, {6, 0, 0}),
                                      placed(8, {0, 1, 0}, {0, 7, 0}),
                                      placed(5, {0, 0, 1}, {0, 0, -9})};
  std::vector<Volume<float>> sessions;
  for (const Motion& place : places) sessions.push_back(session(place, 1, 0, 3));
  const SessionAverage average = averageSessions(sessions);
  Vector turn = Vector::Zero(), shift = Vector::Zero();
  for (const Motion& motion : average.toSession) {
    const Eigen::AngleAxisd angle(motion.linear());
    turn += angle.angle() * angle.axis();
    shift += motion * Point::Zero();
  }
  EXPECT_LT(turn.norm() * 180 / kPi, 0.2);
  EXPECT_LT(shift.norm(), 1.5);  // of the centre of what is bright, not of the origin
}

TEST(SessionAverage, RefusesOneSessionAndImagesApart) {
  const Volume<float> one = session(Motion::Identity(), 1, 0, 1);
  EXPECT_THROW((void)averageSessions({one}), InvalidInput);
  EXPECT_THROW((void)averageSessions({one, Volume<float>(grid(), 0.0F)}), InvalidInput);
}

}  // namespace
}  // namespace explica::registration
