// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Ventricle/Reference.h"

#include "Explica/Ventricle/Pictures.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <sstream>

namespace explica::ventricle {

namespace {

/// Two frames whose segments are all of one thickness, without volumes of voxels.
Beat beatOf(double diastole, double systole) {
  Beat beat;
  beat.frames.resize(2);
  beat.systole = 1;
  for (std::size_t f = 0; f < 2; ++f) {
    Frame& frame = beat.frames[f];
    frame.number = static_cast<int>(f);
    frame.cavity = f == 0 ? 135 : 50;
    frame.mass = 119;
    frame.segments = Segments{};
    for (int n = 1; n <= kSegments; ++n) {
      Segment row;
      row.number = n;
      row.thickness = f == 0 ? diastole : systole;
      frame.segments->rows.push_back(row);
    }
  }
  beat.ejectionFraction = 100 * (135. - 50) / 135;
  return beat;
}

}  // namespace

TEST(Reference, StandsInTheOrderOfItsQuantitiesAndNamesItsSource) {
  for (std::size_t n = 0; n < references().size(); ++n) {
    const Reference& reference = references()[n];
    EXPECT_EQ(static_cast<std::size_t>(reference.quantity), n);
    EXPECT_NE(reference.source.find(" et al. 20"), std::string::npos) << reference.name;
    EXPECT_GT(reference.women.low(), 0) << reference.name;
    EXPECT_GT(reference.men.low(), 0) << reference.name;
  }
}

TEST(Reference, ValuesAreMeansOfRingsAndDifferencesInMillimetres) {
  Beat beat = beatOf(6, 10);
  beat.frames[0].segments->rows[6].thickness = kNaN;  // segment 7 does not count
  beat.frames[1].segments->rows[0].thickness = 22;    // segment 1 thickens by 16 mm
  EXPECT_DOUBLE_EQ(valueOf(beat, Quantity::MiddleThickness), 6);
  EXPECT_DOUBLE_EQ(valueOf(beat, Quantity::BasalThickening), (16 + 5 * 4) / 6.);
  EXPECT_DOUBLE_EQ(valueOf(beat, Quantity::MiddleThickening), 4);
  EXPECT_DOUBLE_EQ(valueOf(beat, Quantity::ApicalThickening), 4);
  EXPECT_DOUBLE_EQ(valueOf(beat, Quantity::SystolicVolume), 50);
  beat.frames.resize(1);
  beat.systole = 0;
  beat.ejectionFraction.reset();
  for (const auto quantity :
       {Quantity::BasalThickening, Quantity::SystolicVolume, Quantity::Ejection}) {
    EXPECT_TRUE(std::isnan(valueOf(beat, quantity)));
  }
}

TEST(Reference, TableTellsTheDistanceInStandardDeviations) {
  const std::string table = referenceTable(beatOf(5.3, 10));
  EXPECT_NE(table.find("end-diastolic thickness, middle ring\tmm\t5.300\t5.3\t0.9\t0.00\t6.3\t1.1\t"
                       "-0.91\t"),
            std::string::npos)
      << table;
  EXPECT_NE(table.find("end-systolic volume of the cavity\tml\t50.000\t42\t12\t0.67\t50\t16\t0.00"),
            std::string::npos)
      << table;
  std::istringstream lines(table);
  std::size_t count = 0;
  for (std::string line; std::getline(lines, line); ++count) {
    EXPECT_EQ(std::count(line.begin(), line.end(), '\t'), 11) << line;
  }
  EXPECT_EQ(count, references().size() + 1);
}

TEST(Reference, TheBullseyeNamesTheRanges) {
  Beat beat = beatOf(6, 10);
  for (Frame& frame : beat.frames) frame.thickness = 6;
  const std::string eye = bullseye(beat).svg;
  EXPECT_NE(eye.find("women 5.3 (SD 0.9), men 6.3 (SD 1.1) mm"), std::string::npos);
  EXPECT_NE(eye.find("middle 4.0, healthy 4.4 (SD 1.4) mm"), std::string::npos);
}

TEST(Reference, TheBullseyesOfAHeartKeepApart) {
  Beat beat = beatOf(6, 10);
  beat.orientation.source = OrientationSource::RightVentricle;
  for (Frame& frame : beat.frames) {
    for (Segment& row : frame.segments->rows) {
      row.voxels = 2000;
      row.leftOut = 3500;  // 59500 of 93500
      row.thickening = 67;
    }
  }
  const report::Picture seen = bullseye(beat).pixels;
  constexpr int kMargin = 12;  // pixels that stay white beside what is next to them
  for (int panel = 0; panel <= 3; ++panel) {
    const int middle = seen.width * panel / 3;
    for (int x = std::max(0, middle - kMargin); x < std::min(seen.width, middle + kMargin); ++x) {
      for (int y = 0; y < seen.height; ++y) {
        ASSERT_EQ(static_cast<int>(*seen.pixel(x, y)), 255)
            << "panel " << panel << " at " << x << ", " << y;
      }
    }
  }
}

}  // namespace explica::ventricle
