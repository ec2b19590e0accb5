// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Ventricle/Beat.h"

#include "Explica/Core/Errors.h"
#include "Explica/Core/Parallel.h"
#include "Explica/IO/VolumeFile.h"
#include "Explica/Phantom/BeatingVentricle.h"

#include <Eigen/Geometry>

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <random>

using namespace explica;
using namespace explica::ventricle;

namespace {

Beat beatOf(const phantom::BeatingVentricle& phantom, const HeartOptions& options = {}) {
  std::vector<Volume<Label>> hearts;
  std::vector<int> numbers;
  for (const auto& frame : phantom.frames) {
    hearts.push_back(frame.labels);
    numbers.push_back(static_cast<int>(numbers.size()));
  }
  return measureBeat(hearts, numbers, options);
}

/// The exact means over the columns of a frame that count, by segment from 0.
std::vector<double> exactMeans(const phantom::BeatingVentricle& phantom, const Beat& beat,
                               std::size_t f) {
  const Frame& frame = beat.frames[f];
  const WallThickness& wall = *frame.measures;
  std::vector<ColumnMean> means(kSegments + 1);
  for (std::size_t n = 0; n < wall.thickness.size(); ++n) {
    if (!wall.counts(n)) continue;
    const auto number = static_cast<std::int32_t>(n);
    const Point x = phantom.toHeart(wall.annulus.world(number));
    const double t = phantom.frames[f].exact.answer(x).thickness();
    means[frame.segments->segmentOf[wall.annulus.linear(number)]].add(t, t);
  }
  std::vector<double> values;
  for (int s = 1; s <= kSegments; ++s) values.push_back(means[s].mean());
  return values;
}

/// The expert's end-diastolic labels, or nothing.
std::optional<Volume<Label>> realHeart(const char* name) {
  const auto file = std::filesystem::path(EXPLICA_REAL_DATA) / "lv_sunnybrook_SCD0000101" / name;
  if (!std::filesystem::exists(file)) return {};
  return io::readLabels(file).volume;
}

/// The same heart seen by another grid: turned, mirrored or moved.
Volume<Label> placed(Volume<Label> heart, const Eigen::Matrix3d& direction) {
  heart.grid.origin = direction * heart.grid.origin + Point(30, -20, 10);
  heart.grid.direction = direction * heart.grid.direction;
  return heart;
}

}  // namespace

class TiltedSlices : public ::testing::TestWithParam<double> {};

TEST_P(TiltedSlices, GiveTheSegmentsTheirExactThickness) {
  const auto phantom =
      phantom::beatingVentricle({90, 1.4}, {.frames = 2, .slice = 8, .tiltDeg = GetParam()});
  const Beat beat = beatOf(phantom);
  EXPECT_NEAR(beat.atDiastole().axis.stackAngleDeg, GetParam(), 1);
  for (std::size_t f = 0; f < 2; ++f) {
    ASSERT_TRUE(beat.frames[f].measures->bySlice);
    const auto exact = exactMeans(phantom, beat, f);
    double worst = 0;
    int measured = 0;
    for (int s = 0; s < 16; ++s) {
      const Segment& row = beat.frames[f].segments->rows[s];
      // The base may cut all of a segment's slices where the stack is tilted most.
      if (GetParam() >= 20 && std::isnan(row.thickness)) continue;
      ++measured;
      EXPECT_GT(row.voxels, 40U) << row.number;
      EXPECT_NEAR(row.thickness, exact[s], 0.3) << "segment " << row.number;
      worst = std::max(worst, std::abs(row.thickness - exact[s]));
    }
    EXPECT_GE(measured, 15);
    std::printf("tilt %g, frame %zu: greatest error of a segment's mean %.2f mm\n", GetParam(), f,
                worst);
  }
}

INSTANTIATE_TEST_SUITE_P(Degrees, TiltedSlices, ::testing::Values(0, 10, 20));

/// The same stack with each slice moved within its plane by whole pixels, the same in all frames.
void moveSlices(std::vector<Volume<Label>>& hearts, const std::vector<Eigen::Vector2i>& pixels) {
  for (Volume<Label>& heart : hearts) {
    const Volume<Label> before = heart;
    for (std::size_t v = 0; v < heart.size(); ++v) {
      const auto [i, j, k] = heart.grid.subscripts(v);
      const int p = i - pixels[k][0], q = j - pixels[k][1];
      heart[v] = heart.grid.contains(p, q, k) ? before(p, q, k) : kOutside;
    }
  }
}

/// Less their line of least squares over those slices: a trend along the stack cannot be told from
/// a tilted axis.
void removeTrend(std::vector<Eigen::Vector2i>& pixels, const std::vector<int>& slices) {
  const auto count = static_cast<double>(slices.size());
  double middle = 0, squares = 0;
  Eigen::Vector2d mean = Eigen::Vector2d::Zero(), slope = mean;
  for (const int k : slices) middle += k / count, mean += pixels[k].cast<double>() / count;
  for (const int k : slices) {
    slope += (k - middle) * pixels[k].cast<double>();
    squares += (k - middle) * (k - middle);
  }
  for (const int k : slices) {
    const Eigen::Vector2d rest = pixels[k].cast<double>() - mean - (k - middle) / squares * slope;
    pixels[k] = rest.array().round().cast<int>();
  }
}

/// Of the segments that both have a mean of, mm.
double greatestChange(const Segments& before, const Segments& after) {
  double greatest = 0;
  for (int s = 0; s < 16; ++s) {
    const double change = std::abs(after.rows[s].thickness - before.rows[s].thickness);
    if (!std::isnan(change)) greatest = std::max(greatest, change);
  }
  return greatest;
}

class JumpingSlices : public ::testing::TestWithParam<int> {};

/// Breath holds of different depth move slices; that is no slope of the wall.
TEST_P(JumpingSlices, LeaveTheWallAsThickAsItWas) {
  const int most = GetParam();  // pixels of 1.4 mm
  const auto phantom =
      phantom::beatingVentricle({90, 1.4}, {.frames = 4, .slice = 8, .tiltDeg = 10});
  const Beat still = beatOf(phantom);
  std::vector<Volume<Label>> hearts;
  std::vector<int> numbers;
  for (const auto& frame : phantom.frames) {
    hearts.push_back(frame.labels);
    numbers.push_back(static_cast<int>(numbers.size()));
  }
  std::mt19937 random(7);
  std::uniform_int_distribution<int> jump(-most, most);
  std::vector<Eigen::Vector2i> pixels;
  for (int k = 0; k < hearts[0].grid.size[2]; ++k) pixels.emplace_back(jump(random), jump(random));
  std::vector<int> aligned;
  for (int k = 0; k < hearts[0].grid.size[2]; ++k) {
    if (still.alignment.shift[k].norm() > 0) aligned.push_back(k);
  }
  removeTrend(pixels, aligned);
  moveSlices(hearts, pixels);
  const Beat moved = measureBeat(hearts, numbers);
  const Segments& before = *still.atDiastole().segments;
  const double change = greatestChange(before, *moved.atDiastole().segments);
  SliceAlignment none = moved.alignment;
  for (Eigen::Vector2d& shift : none.shift) shift.setZero();
  const Frame& frame = moved.atDiastole();
  const double without =
      greatestChange(before, segmentsOf(frame.heart, measureWall(frame.heart, frame.axis, none),
                                        frame.axis, moved.orientation));
  EXPECT_LE(change, 0.25);
  EXPECT_GE(moved.alignment.largest, most > 1 ? 1.4 : 0);
  std::printf(
      "up to %.1f mm: shifts found %.2f mm rms, slope +- %.1f degrees, greatest change of a "
      "segment "
      "%.2f mm, not aligned %.2f mm\n",
      1.4 * most, moved.alignment.rms, moved.alignment.slopeErrorDeg, change, without);
}

INSTANTIATE_TEST_SUITE_P(Pixels, JumpingSlices, ::testing::Values(0, 1, 2, 3, 4));

TEST(Beat, VolumesAndThickeningOfAnIncompressibleWallAreExact) {
  const auto phantom = phantom::beatingVentricle({90, 1.4}, {.frames = 6, .slice = 1.4});
  const Beat beat = beatOf(phantom);
  EXPECT_EQ(beat.diastole, 0U);
  EXPECT_EQ(beat.systole, 3U);
  EXPECT_NEAR(*beat.ejectionFraction, 50, 0.5);
  for (std::size_t f = 0; f < 6; ++f) {
    const Frame& frame = beat.frames[f];
    const auto& truth = phantom.frames[f];
    EXPECT_FALSE(frame.measures->bySlice);
    EXPECT_NEAR(frame.cavity, 1e-3 * truth.cavity, 1e-5 * truth.cavity);
    EXPECT_NEAR(frame.wall, 1e-3 * truth.wall, 1e-5 * truth.wall);
    EXPECT_DOUBLE_EQ(frame.mass, 1.05 * frame.wall);
    for (const Segment& row : frame.segments->rows) {
      if (row.number == kSegments) continue;
      const auto third = static_cast<std::size_t>((row.number - 1) / 6);
      const double exact = 100 * (truth.thickness[third] / phantom.frames[0].thickness[third] - 1);
      EXPECT_NEAR(row.thickening, exact, 3) << "frame " << f << " segment " << row.number;
      EXPECT_NEAR(row.thickness, truth.thickness[third], 0.3);
    }
  }
}

TEST(Beat, ThickSlicesKeepVolumesAndThickening) {
  const auto phantom = phantom::beatingVentricle({90, 1.4}, {.frames = 2, .slice = 8});
  const Beat beat = beatOf(phantom);
  for (std::size_t f = 0; f < 2; ++f) {
    EXPECT_NEAR(beat.frames[f].cavity, 1e-3 * phantom.frames[f].cavity,
                1e-5 * phantom.frames[f].cavity);
    EXPECT_NEAR(beat.frames[f].wall, 1e-3 * phantom.frames[f].wall, 1e-5 * phantom.frames[f].wall);
  }
  EXPECT_NEAR(*beat.ejectionFraction, 50, 1);
  for (const Segment& row : beat.frames[1].segments->rows) {
    const auto third = static_cast<std::size_t>((row.number - 1) / 6);
    if (third > 1) continue;  // at the apex other slices hold a ring at end-systole
    const double exact =
        100 * (phantom.frames[1].thickness[third] / phantom.frames[0].thickness[third] - 1);
    EXPECT_NEAR(row.thickening, exact, 3) << row.number;
  }
}

TEST(Beat, DoesNotDependOnWhereTheImageLiesNorOnThreads) {
  const auto phantom =
      phantom::beatingVentricle({90, 1.4}, {.frames = 1, .slice = 8, .tiltDeg = 10});
  const Beat straight = beatOf(phantom);
  const Eigen::Matrix3d turned =
      Eigen::AngleAxisd(1.1, Vector(3, -1, 2).normalized()).toRotationMatrix();
  setThreadCount(1);
  const Beat moved = measureBeat({placed(phantom.frames[0].labels, turned)}, {0});
  setThreadCount(0);
  for (int s = 0; s < kSegments; ++s) {
    const Segment& a = straight.atDiastole().segments->rows[s];
    const Segment& b = moved.atDiastole().segments->rows[s];
    EXPECT_EQ(a.voxels, b.voxels);
    if (a.voxels == 0) continue;
    EXPECT_NEAR(a.thickness, b.thickness, 1e-6);
  }
}

TEST(Beat, AMirroredImageHasItsSegmentsMirrored) {
  // A mirror image of a heart turns the other way round: the septum's halves change places, while
  // thickness stays.
  const auto phantom =
      phantom::beatingVentricle({90, 1.4}, {.frames = 1, .slice = 8, .tiltDeg = 10});
  const Beat straight = beatOf(phantom);
  const Eigen::Matrix3d mirror = Vector(-1, 1, 1).asDiagonal().toDenseMatrix();
  const Beat mirrored = measureBeat({placed(phantom.frames[0].labels, mirror)}, {0});
  const auto at = [](const Beat& beat, int number) {
    return beat.atDiastole().segments->rows[number - 1];
  };
  for (const auto& [a, b] : {std::pair{2, 3}, {1, 4}, {6, 5}, {8, 9}, {7, 10}, {12, 11}}) {
    EXPECT_NEAR(at(straight, a).thickness, at(mirrored, b).thickness, 0.02);
    EXPECT_NEAR(static_cast<double>(at(straight, a).voxels),
                static_cast<double>(at(mirrored, b).voxels), 8);
  }
}

namespace {

/// Two series of numbers, one beside the other.
class Agreement {
 public:
  void add(double a, double b) {
    n_ += 1;
    a_ += a, b_ += b, aa_ += a * a, bb_ += b * b, ab_ += a * b, apart_ += std::abs(a - b);
  }
  [[nodiscard]] double apart() const { return apart_ / n_; }
  [[nodiscard]] double correlation() const {
    return (n_ * ab_ - a_ * b_) / std::sqrt((n_ * aa_ - a_ * a_) * (n_ * bb_ - b_ * b_));
  }

 private:
  double n_ = 0, a_ = 0, b_ = 0, aa_ = 0, bb_ = 0, ab_ = 0, apart_ = 0;
};

/// Cosine of the slope of the middle between both circles of a slice's areas, by its neighbours.
double uprightness(const std::vector<SliceRow>& rows, std::size_t k, double spacing) {
  const auto middle = [](const SliceRow& row) {
    return 0.5 *
           (std::sqrt(row.cavityArea / kPi) + std::sqrt((row.cavityArea + row.wallArea) / kPi));
  };
  const std::size_t next = std::min(k + 1, rows.size() - 1);
  const double run = spacing * static_cast<double>(next - (k - 1));
  return std::cos(std::atan((middle(rows[next]) - middle(rows[k - 1])) / run));
}

}  // namespace

TEST(Beat, RealSlicesAreAsThickAsTheirAreasSay) {
  const auto raw = realHeart("ED_label.nii.gz");
  if (!raw) GTEST_SKIP() << "skipped: no real data";
  const Beat beat = measureBeat({relabelled(*raw, findRoles({*raw}))}, {0});
  const std::vector<SliceRow> rows = sliceRows(beat.atDiastole());
  ASSERT_EQ(rows.size(), 9U);
  Agreement within, upright;
  for (std::size_t k = 1; k < rows.size(); ++k) {
    within.add(rows[k].areaEquivalent, rows[k].plain);
    upright.add(rows[k].areaEquivalent * uprightness(rows, k, 10), rows[k].thickness);
  }
  std::printf("within the slice %.3f mm, r %.4f; made upright %.3f mm, r %.4f\n", within.apart(),
              within.correlation(), upright.apart(), upright.correlation());
  EXPECT_LE(within.apart(), 0.25);
  EXPECT_GE(within.correlation(), 0.99);
  EXPECT_LE(upright.apart(), 0.25);
  EXPECT_GE(upright.correlation(), 0.99);
  // The ring that the outflow tract opens.
  EXPECT_NE(rows[0].kind, SliceKind::Ring);
  EXPECT_EQ(rows[0].counted, 0U);
  for (const Segment& row : beat.atDiastole().segments->rows) {
    if (row.number > 6) continue;
    EXPECT_GT(row.lowest, 2) << row.number;
  }
}

TEST(Beat, AFrameWithoutWallCountsForVolumesOnly) {
  const auto phantom = phantom::beatingVentricle({90, 1.4}, {.frames = 2, .slice = 8});
  Volume<Label> bare = phantom.frames[1].labels;
  for (Label& label : bare.data) label = label == kCavity ? kCavity : kOutside;
  const Beat beat = measureBeat({phantom.frames[0].labels, bare}, {0, 7});
  EXPECT_EQ(beat.systole, 1U);
  EXPECT_NEAR(*beat.ejectionFraction, 50, 1);
  EXPECT_FALSE(beat.frames[1].segments);
  EXPECT_EQ(beat.frames[1].why, "it has no wall");
  EXPECT_NE(frameTable(beat).find("7\tES\t"), std::string::npos);
  EXPECT_EQ(segmentTable(beat).find("\t7\t"), std::string::npos);
  EXPECT_THROW((void)measureBeat({bare}, {0}), InvalidInput);
}

TEST(Beat, AFrameThatNobodyHasLabelledIsNoSystole) {
  const auto phantom = phantom::beatingVentricle({90, 1.4}, {.frames = 2, .slice = 8});
  const Volume<Label>&full = phantom.frames[0].labels, &small = phantom.frames[1].labels;
  const Volume<Label> none(full.grid, kOutside);
  const Beat beat = measureBeat({none, full, none, small}, {0, 1, 2, 3});
  EXPECT_EQ(beat.diastole, 1U);
  EXPECT_EQ(beat.systole, 3U);
  EXPECT_NEAR(*beat.ejectionFraction, 50, 1);
  EXPECT_FALSE(measureBeat({none, full}, {0, 1}).ejectionFraction);
}

TEST(Slices, CountsThoseWithoutLabelsBetweenOthers) {
  const auto phantom = phantom::beatingVentricle({90, 1.4}, {.frames = 1, .slice = 8});
  const Volume<Label> whole = phantom.frames[0].labels;
  EXPECT_EQ(missingSlices(whole), 0);
  const int middle = whole.grid.size[2] / 2;
  for (const Label lost : {kCavity, kWall}) {
    Volume<Label> heart = whole;
    for (int j = 0; j < heart.grid.size[1]; ++j) {
      for (int i = 0; i < heart.grid.size[0]; ++i) {
        for (const int k : {middle, middle + 1}) {
          if (heart(i, j, k) == lost) heart(i, j, k) = kOutside;
        }
      }
    }
    EXPECT_EQ(missingSlices(heart), 2);
  }
}

TEST(Slices, CountsVoxelsThatCavityAndWallEnclose) {
  Volume<Label> heart =
      phantom::beatingVentricle({90, 1.4}, {.frames = 1, .slice = 8}).frames[0].labels;
  EXPECT_EQ(enclosedVoxels(heart), 0);
  const int middle = heart.grid.size[2] / 2;
  const Eigen::Vector2d centre = slicesOf(heart)[static_cast<std::size_t>(middle)].centre / 1.4;
  const int i = static_cast<int>(centre.x()), j = static_cast<int>(centre.y());
  ASSERT_EQ(heart(i, j, middle), kCavity);
  heart(i, j, middle) = heart(i + 1, j, middle) = kOutside;
  EXPECT_EQ(enclosedVoxels(heart), 2);
}

TEST(Beat, RefusesFramesOfDifferentGrids) {
  const auto a = phantom::beatingVentricle({90, 1.4}, {.frames = 1, .slice = 8});
  const auto b = phantom::beatingVentricle({92, 1.4}, {.frames = 1, .slice = 8});
  EXPECT_THROW((void)measureBeat({a.frames[0].labels, b.frames[0].labels}, {0, 1}), InvalidInput);
}
