// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "../src/Star.h"

#include "Explica/Geometry/SphereLocator.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace explica::sphere {
namespace {

/// True if the faces that join the first neighbour to the ring are positive.
bool joinsToTheFirst(const Ring& ring) {
  for (std::size_t n = 1; n + 1 < ring.size(); ++n) {
    if (geometry::sphericalOrientation(ring[0], ring[n], ring[n + 1]) <= 0) return false;
  }
  return true;
}

void expectPlaceInside(const Ring& ring) {
  ASSERT_TRUE(joinsToTheFirst(ring));
  const auto place = placeInside(ring);
  ASSERT_TRUE(place);
  EXPECT_TRUE(seesRing(ring, *place));
}

// From a decimated fsaverage5 pial surface: the angle at the first neighbour is of more than 180
// degrees, and what sees the whole ring is a sliver beside it.
TEST(PlaceInside, IsFoundInASliverBesideAReflexAngle) {
  expectPlaceInside({{-0.6741712998493673, 0.33088759881103297, -0.66030784897082906},
                     {-0.22000656308903277, 0.16156490256078651, -0.96202593232109657},
                     {0.49942533725802918, -0.38578902297825551, -0.77571977044174067},
                     {-0.27562770809113735, -0.88708320959810627, 0.37028738269288769},
                     {-0.4136039344372518, 0.46704808413923316, 0.78153558621466335}});
}

TEST(PlaceInside, IsFoundForRandomRingsThatTheFirstNeighbourIsJoinedTo) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> unit(0, 1);
  const Point first(0.36, 0.48, 0.8);
  const TangentFrame frame = tangentFrame(first);
  int rings = 0;
  for (int n = 0; n < 400; ++n) {
    Ring ring = {first};
    for (int k = 0; k < 5; ++k) {
      const double at = (50 + 10 * unit(random)) * k * kPi / 180;
      const double away = std::pow(10, -8 * unit(random));
      ring.push_back(
          (first + away * frame * Eigen::Vector2d(std::cos(at), std::sin(at))).normalized());
    }
    if (!joinsToTheFirst(ring)) continue;
    ++rings;
    expectPlaceInside(ring);
  }
  EXPECT_GT(rings, 300);
}

}  // namespace
}  // namespace explica::sphere
