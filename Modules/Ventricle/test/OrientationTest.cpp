// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Ventricle/Orientation.h"

#include "Explica/Core/Errors.h"
#include "Explica/Phantom/BeatingVentricle.h"
#include "Explica/Ventricle/Segments.h"

#include <gtest/gtest.h>

#include <cmath>

using namespace explica;
using namespace explica::ventricle;

namespace {

phantom::BeatingVentricle tilted(double degrees, double slice) {
  return phantom::beatingVentricle({90, 1.4}, {.frames = 1, .slice = slice, .tiltDeg = degrees});
}

}  // namespace

TEST(LongAxis, IsFoundWhateverTheTiltAndTheSlices) {
  for (const double slice : {1.4, 8.0}) {
    for (const double degrees : {0.0, 10.0, 20.0, 30.0}) {
      const auto phantom = tilted(degrees, slice);
      const LongAxis axis = findLongAxis(phantom.frames[0].labels);
      const Vector truth = phantom.toWorld * Vector(0, 0, -1);
      const double angle = std::acos(std::min(1.0, axis.direction.dot(truth))) * 180 / kPi;
      EXPECT_LE(angle, slice < 2 ? 0.5 : 1.5) << degrees << " degrees, slices " << slice;
      EXPECT_NEAR(axis.stackAngleDeg, degrees, slice < 2 ? 0.5 : 1.5);
      EXPECT_NEAR(axis.length(), 15 + 40 * std::sqrt(1.36), slice < 2 ? 1.5 : 5);
    }
  }
}

TEST(Orientation, TheRightVentricleTellsTheAnteriorInsertion) {
  for (const double degrees : {0.0, 20.0}) {
    const auto phantom = tilted(degrees, 8);
    const Volume<Label>& heart = phantom.frames[0].labels;
    const LongAxis axis = findLongAxis(heart);
    const Orientation found = findOrientation(heart, axis);
    EXPECT_EQ(found.source, OrientationSource::RightVentricle);
    EXPECT_NEAR(found.septumDeg, 120, 20);
    const Orientation given =
        findOrientation(heart, axis, {.insertion = phantom.anteriorInsertion, .imageAxis = {}});
    EXPECT_EQ(given.source, OrientationSource::Point);
    const double apart = std::acos(found.anterior.dot(given.anterior)) * 180 / kPi;
    EXPECT_LE(apart, 5) << degrees;
  }
}

TEST(Orientation, WithoutRightVentricleItSaysNoneOrTakesAnImageAxis) {
  Volume<Label> heart = tilted(0, 8).frames[0].labels;
  for (Label& l : heart.data) l = l == kRight ? kOutside : l;
  const LongAxis axis = findLongAxis(heart);
  EXPECT_EQ(findOrientation(heart, axis).source, OrientationSource::None);
  const Orientation image =
      findOrientation(heart, axis, {.insertion = {}, .imageAxis = ImageAxis::JMinus});
  EXPECT_EQ(image.source, OrientationSource::ImageAxis);
  EXPECT_NEAR(image.anterior[1], -1, 0.05);
}

TEST(Orientation, APointFarFromTheHeartIsRefusedWithTheWayToFindIt) {
  const auto phantom = tilted(0, 8);
  const Volume<Label>& heart = phantom.frames[0].labels;
  const LongAxis axis = findLongAxis(heart);
  for (const Point& point : {Point(9999, 0, 0), Point(0, 0, -10)}) {
    try {
      (void)findOrientation(heart, axis, {.insertion = point, .imageAxis = {}});
      FAIL() << "accepted";
    } catch (const InvalidInput& error) {
      EXPECT_NE(std::string(error.what()).find("ITK-SNAP"), std::string::npos) << error.what();
    }
  }
}

TEST(Segments, TurnFromTheAnteriorInsertionToTheSeptum) {
  EXPECT_EQ(segmentAt(0.1, 30), 2);
  EXPECT_EQ(segmentAt(0.1, 90), 3);
  EXPECT_EQ(segmentAt(0.1, 359), 1);
  EXPECT_EQ(segmentAt(0.5, 150), 10);
  EXPECT_EQ(segmentAt(0.9, 60), 14);
  EXPECT_EQ(segmentAt(0.9, 0), 13);
  EXPECT_EQ(segmentAt(1.1, 0), 17);
  EXPECT_EQ(segmentAt(-0.1, 0), 0);
  EXPECT_EQ(segmentName(2, true), "basal anteroseptal");
  EXPECT_EQ(segmentName(16, true), "apical lateral");
  EXPECT_EQ(segmentName(16, false), "apical 4");
}
