// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Phantom/BeatingVentricle.h"

#include "Explica/Core/Errors.h"

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

using namespace explica;
using namespace explica::phantom;

namespace {

double volumeOf(const Volume<Label>& labels, Label label) {
  return static_cast<double>(std::count(labels.data.begin(), labels.data.end(), label)) *
         labels.grid.voxelVolume();
}

}  // namespace

TEST(BeatingVentricle, LabelsHoldTheExactVolumesAndTheWallIsIncompressible) {
  for (const double tilt : {0.0, 20.0}) {
    const auto beat = beatingVentricle({90, 1.4}, {.frames = 4, .tiltDeg = tilt});
    ASSERT_EQ(beat.frames.size(), 4U);
    for (const auto& frame : beat.frames) {
      EXPECT_NEAR(volumeOf(frame.labels, 1), frame.cavity, 0.003 * frame.cavity);
      EXPECT_NEAR(volumeOf(frame.labels, 2), frame.wall, 0.003 * frame.wall);
      EXPECT_DOUBLE_EQ(frame.wall, beat.frames[0].wall);
    }
    EXPECT_NEAR(beat.frames[2].cavity, 0.5 * beat.frames[0].cavity, 1e-6);
  }
}

TEST(BeatingVentricle, WallThickensAsItsVolumeDemands) {
  const auto beat = beatingVentricle({90, 1.4}, {.frames = 2});
  for (int third = 0; third < 3; ++third) {
    EXPECT_GT(beat.frames[1].thickness[third], 1.2 * beat.frames[0].thickness[third]);
  }
  // At the equator the thickness is the difference of the short half axes.
  const auto answer = beat.frames[0].exact.answer(Point(30, 0, 0));
  EXPECT_NEAR(answer.thickness(), 40 * (0.9 - 0.6), 0.5);
}

// Seen from the apex, angles from the anterior insertion to the septum run clockwise about +z: the
// right ventricle touches the wall where the angle about +z is smaller.
TEST(BeatingVentricle, TheRightVentricleBeginsAtTheAnteriorInsertion) {
  const auto beat = beatingVentricle({90, 1.4}, {.frames = 1, .tiltDeg = 20});
  const Volume<Label>& labels = beat.frames[0].labels;
  const auto labelBeside = [&](double degrees) {
    const Point insertion = beat.toHeart(beat.anteriorInsertion);
    const Point turned =
        Eigen::AngleAxisd(degrees * kPi / 180, Vector::UnitZ()) * (1.1 * insertion);
    const Vector at = labels.grid.toIndex(beat.toWorld * turned);
    return labels(static_cast<int>(std::lround(at.x())), static_cast<int>(std::lround(at.y())),
                  static_cast<int>(std::lround(at.z())));
  };
  EXPECT_EQ(labelBeside(-15), 3);
  EXPECT_EQ(labelBeside(-105), 3);
  EXPECT_EQ(labelBeside(-135), 0);
  EXPECT_EQ(labelBeside(15), 0);
}

TEST(BeatingVentricle, RefusesNonsense) {
  EXPECT_THROW((void)beatingVentricle({90, 1.4}, {.frames = 0}), InvalidInput);
  EXPECT_THROW((void)beatingVentricle({90, 1.4}, {.frames = 2, .tiltDeg = 60}), InvalidInput);
  EXPECT_THROW((void)beatingVentricle({40, 1.4}, {.frames = 2}), InvalidInput);
  EXPECT_THROW((void)beatingVentricle({90, 1.4}, {.frames = 2, .slice = -1.0}), InvalidInput);
}
