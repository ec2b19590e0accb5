// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Geometry/Predicates.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace explica::geometry {
namespace {

TEST(Orientation, FollowsTheRightHandRule) {
  EXPECT_EQ(orientation(Eigen::Vector2d(0, 0), Eigen::Vector2d(1, 0), Eigen::Vector2d(0, 1)), 1);
  EXPECT_EQ(orientation(Eigen::Vector2d(0, 0), Eigen::Vector2d(0, 1), Eigen::Vector2d(1, 0)), -1);
  EXPECT_EQ(orientation(Point(0, 0, 0), Point(1, 0, 0), Point(0, 1, 0), Point(0.2, 0.2, 3)), 1);
  EXPECT_EQ(orientation(Point(0, 0, 0), Point(1, 0, 0), Point(0, 1, 0), Point(0.2, 0.2, -3)), -1);
}

// One unit in the last place decides: plain double arithmetic gets many of these wrong.
TEST(Orientation, IsExactNextToALine) {
  const Eigen::Vector2d a(12, 12), b(24, 24);
  for (int i = 0; i < 64; ++i) {
    for (int j = 0; j < 64; ++j) {
      const double ulp = std::ldexp(1.0, -53);
      const Eigen::Vector2d c(0.5 + i * ulp, 0.5 + j * ulp);
      // (a, b) runs along the diagonal: c is on its left exactly if its y exceeds its x.
      EXPECT_EQ(orientation(a, b, c), c.y() > c.x() ? 1 : (c.y() < c.x() ? -1 : 0));
    }
  }
}

// Points of the plane x + y + z = 3 that double represents exactly; one ulp off it must be seen.
TEST(Orientation, IsExactNextToAPlane) {
  const Point a(3, 0, 0), b(0, 3, 0), c(0, 0, 3);
  std::mt19937 random(7);
  std::uniform_int_distribution<int> grid(0, 1 << 20);
  for (int n = 0; n < 1000; ++n) {
    const double x = std::ldexp(grid(random), -20), y = std::ldexp(grid(random), -20);
    const double z = 3 - x - y;
    EXPECT_EQ(orientation(a, b, c, Point(x, y, z)), 0);
    EXPECT_EQ(orientation(a, b, c, Point(x, y, std::nextafter(z, 10))), 1);
    EXPECT_EQ(orientation(a, b, c, Point(x, y, std::nextafter(z, -10))), -1);
  }
}

TEST(Orientation, ChangesSignWithEverySwap) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> uniform(-1, 1);
  const auto point = [&] {
    return Point(uniform(random), uniform(random), 1e-17 * uniform(random));
  };
  for (int n = 0; n < 1000; ++n) {
    const Point a = point(), b = point(), c = point(), d = point();
    const int sign = orientation(a, b, c, d);
    EXPECT_EQ(orientation(b, a, c, d), -sign);
    EXPECT_EQ(orientation(a, b, d, c), -sign);
    EXPECT_EQ(orientation(c, b, a, d), -sign);
    EXPECT_EQ(orientation(b, c, a, d), sign);
  }
}

}  // namespace
}  // namespace explica::geometry
