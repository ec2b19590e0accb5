// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Core/Errors.h"
#include "Explica/Core/Parallel.h"
#include "Explica/Registration/AffineRegistration.h"
#include "Explica/Registration/Deformation.h"
#include "Explica/Registration/HeadRegistration.h"
#include "Explica/Registration/SkullStripping.h"
#include "Filters.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <functional>
#include <utility>

namespace explica::registration {
namespace {

Grid cube(int size, double spacing) {
  Grid grid;
  grid.size = {size, size, size};
  grid.spacing = Vector::Constant(spacing);
  grid.origin = Point::Constant(-0.5 * spacing * (size - 1));
  return grid;
}

/// Brightness of a head without symmetry: fluid, white matter with bumps, a skull about it.
double headAt(const Point& p) {
  const double r = p.cwiseQuotient(Vector(62, 78, 58)).norm();
  if (r > 1.25) return 0;
  if (r > 1.12) return 150;
  if (r > 1) return 15;
  const double folds =
      std::sin(p.x() / 7 + 0.4) * std::sin(p.y() / 8) * std::sin(p.z() / 6 + 1) + 0.004 * p.x();
  if ((p - Point(18, 25, 5)).norm() < 13) return 30;
  return r > 0.93 ? 40 : (folds > 0.1 ? 110 : 80);
}

Volume<float> drawn(const Grid& grid, const std::function<double(const Point&)>& value) {
  Volume<float> volume(grid);
  for (std::size_t v = 0; v < volume.size(); ++v) {
    const auto [i, j, k] = grid.subscripts(v);
    volume[v] = static_cast<float>(value(grid.toWorld(Vector(i, j, k))));
  }
  return volume;
}

bool inBrain(const Point& p) {
  return p.cwiseQuotient(Vector(62, 78, 58)).norm() <= 1;
}

Template phantomTemplate(double spacing = 3) {
  Template phantom;
  phantom.head = drawn(cube(static_cast<int>(220 / spacing), spacing), headAt);
  phantom.brain =
      drawn(phantom.head.grid, [](const Point& p) { return inBrain(p) ? headAt(p) : 0; });
  phantom.atlas = Volume<Label>(phantom.head.grid, 0);
  return phantom;
}

// An impulse becomes as wide along every axis, in millimetres, whatever the voxels.
TEST(Filters, SmoothByMillimetresAlongEveryAxis) {
  Grid grid = cube(41, 1);
  grid.spacing = Vector(1, 2, 0.7);
  Volume<float> impulse(grid, 0.0f);
  impulse(20, 20, 20) = 1;
  constexpr double kSigma = 2;
  const Volume<float> wide = smoothed(impulse, kSigma);
  Vector variance = Vector::Zero();
  double sum = 0;
  for (std::size_t v = 0; v < wide.size(); ++v) {
    const auto [i, j, k] = grid.subscripts(v);
    const Vector d = Vector(i - 20, j - 20, k - 20).cwiseProduct(grid.spacing);
    variance += wide[v] * d.cwiseAbs2();
    sum += wide[v];
  }
  EXPECT_NEAR(sum, 1, 1e-5);
  // The kernel ends at three standard deviations or a little later.
  for (int a = 0; a < 3; ++a) EXPECT_NEAR(variance[a], kSigma * kSigma, 0.05 * kSigma * kSigma);
}

/// Where the points of an image of the moved head lie in the template.
Eigen::Affine3d movement() {
  Eigen::Affine3d back = Eigen::Affine3d::Identity();
  back.linear() =
      (Eigen::AngleAxisd(0.26, Vector::UnitX()) * Eigen::AngleAxisd(-0.1, Vector::UnitY()) *
       Eigen::AngleAxisd(0.12, Vector::UnitZ()))
          .toRotationMatrix() *
      Vector(1.06, 0.95, 1.03).asDiagonal();
  back.translation() = Vector(9, -14, 11);
  return back;
}

TEST(HeadTransform, TellsHowMuchItSqueezesAHead) {
  EXPECT_NEAR(stretchOf(movement()), 1.06 / 0.95, 1e-12);
  EXPECT_NEAR(stretchOf(movement() * Eigen::Scaling(0.5)), 1.06 / 0.95, 1e-12);
}

double meanDistance(const HeadTransform& found, const std::function<Point(const Point&)>& truth) {
  double sum = 0;
  int count = 0;
  const Grid grid = cube(24, 8);
  for (std::size_t v = 0; v < grid.voxelCount(); ++v) {
    const auto [i, j, k] = grid.subscripts(v);
    const Point at = grid.toWorld(Vector(i, j, k));
    if (!inBrain(truth(at))) continue;
    sum += (found(at) - truth(at)).norm();
    ++count;
  }
  return sum / count;
}

/// Checks the affine map found for a head that lies so in the image of another scanner: other
/// brightness, other voxels, a bias field.
/// @param truth  from the image to the template
/// @param most   mean distance, mm
void expectFound(const Eigen::Affine3d& truth, Pose pose, double most) {
  const Template phantom = phantomTemplate();
  Grid grid = cube(64, 3.5);
  grid.spacing = Vector(3, 3.5, 4.5);
  const Volume<float> image = drawn(grid, [&](const Point& p) {
    return 3 * headAt(truth * p) * (1 + 0.2 * std::sin(p.x() / 60));
  });
  Volume<float> region = phantom.brain;
  for (float& value : region.data) value = value > 0 ? 1 : 0;
  const AffineRegistration found = registerAffine(image, phantom.head, region, pose);
  HeadTransform transform;
  transform.affine = found.templateToImage.inverse();
  EXPECT_LT(meanDistance(transform, [&](const Point& p) { return truth * p; }), most);
  EXPECT_GT(found.information, 1.1);
}

TEST(AffineRegistration, FindsAHeadThatWasMovedTurnedAndScaled) {
  expectFound(movement(), Pose::Upright, 1);
}

TEST(AffineRegistration, FindsAHeadThatIsTurnedByUpTo90Degrees) {
  for (const Vector& turn : {Vector(90, 0, 0), Vector(0, 0, 90), Vector(-30, 50, -55)}) {
    SCOPED_TRACE(turn.transpose());
    expectFound(movement() * Eigen::AngleAxisd(turn.norm() * kPi / 180, turn.normalized()),
                Pose::Turned, 1.5);
  }
}

TEST(AffineRegistration, RefusesWhatCannotBeRegistered) {
  const Template phantom = phantomTemplate(5);
  const Volume<float> empty(phantom.head.grid, 0.0f);
  EXPECT_THROW((void)registerAffine(phantom.head, phantom.head, empty), InvalidInput);
  EXPECT_THROW((void)registerAffine(empty, phantom.head, phantom.brain), InvalidInput);
}

Point bent(const Point& p) {
  return p + Vector(4 * std::sin(p.y() / 30), 3 * std::cos(p.z() / 25), 4 * std::sin(p.x() / 28));
}

TEST(Deformation, StraightensWhatWasBentWithoutFolds) {
  const Template phantom = phantomTemplate();
  const Volume<float> image =
      drawn(phantom.head.grid, [](const Point& p) { return headAt(bent(p)); });
  Volume<float> region(phantom.head.grid, 0.0f);
  for (std::size_t v = 0; v < region.size(); ++v) region[v] = phantom.brain[v] > 0 ? 1 : 0;
  DeformationOptions options;
  options.spacing = 3;
  const DeformationResult found =
      registerDeformation(image, phantom.head, region, Eigen::Affine3d::Identity(), options);
  const double before = meanDistance(HeadTransform{}, bent);
  EXPECT_GT(before, 3);
  EXPECT_LT(meanDistance(found.transform, bent), 0.3 * before);
  EXPECT_GT(found.agreement.leastJacobian, 0);
  EXPECT_GT(found.agreement.correlation, 0.8);
}

TEST(HeadRegistration, TakenAgainIsJudgedAsItWasWhenItWasFound) {
  const Template phantom = phantomTemplate(6);
  const auto image = [&](const Point& moved) {
    return drawn(phantom.head.grid, [&](const Point& p) { return headAt(bent(p + moved)); });
  };
  DeformationOptions options;
  options.spacing = 6;
  const HeadRegistration found = registerHead(image(Point::Zero()), phantom, false, 0, options);
  const HeadRegistration again =
      reuseRegistration(image(Point::Zero()), phantom, false, found.transform, options);
  EXPECT_NEAR(again.agreement.correlation, found.agreement.correlation, 1e-5);
  EXPECT_NEAR(again.agreement.leastJacobian, found.agreement.leastJacobian, 1e-4);
  EXPECT_EQ(again.brain.data, found.brain.data);
  EXPECT_EQ(again.information, 0);
  // Of a head that lies elsewhere it is no registration, and that shows.
  const HeadRegistration other =
      reuseRegistration(image(Point(0, 25, 10)), phantom, false, found.transform, options);
  EXPECT_LT(other.agreement.correlation, 0.5 * found.agreement.correlation);
  HeadTransform flea = found.transform;
  flea.affine.linear() *= 100;
  EXPECT_THROW((void)reuseRegistration(phantom.head, phantom, false, flea, options), InvalidInput);
}

TEST(Deformation, DoesNotDependOnThreads) {
  const Template phantom = phantomTemplate(6);
  const Volume<float> image =
      drawn(phantom.head.grid, [](const Point& p) { return headAt(bent(p)); });
  DeformationOptions options;
  options.spacing = 6;
  options.maxIterations = 5;
  const auto with = [&](int threads) {
    setThreadCount(threads);
    auto found = registerHead(image, phantom, false, 0, options).transform;
    setThreadCount(0);
    return found;
  };
  const HeadTransform one = with(1);
  const HeadTransform four = with(4);
  EXPECT_EQ(one.affine.matrix(), four.affine.matrix());
  ASSERT_EQ(one.displacement.size(), four.displacement.size());
  EXPECT_EQ(std::memcmp(one.displacement.data.data(), four.displacement.data.data(),
                        one.displacement.size() * sizeof(Eigen::Vector3f)),
            0);
}

TEST(HeadTransform, PullsLabelsFromWhereThePointsLie) {
  Volume<Label> labels(cube(10, 2), 0);
  labels(7, 4, 5) = 12;
  HeadTransform transform;
  transform.affine.translation() = Vector(4, 0, -2);
  const Volume<Label> found = pulled(labels, transform, labels.grid);
  EXPECT_EQ(found(5, 4, 6), 12);
  transform.displacement = Volume<Eigen::Vector3f>(labels.grid, Eigen::Vector3f(-4, 0, 2));
  EXPECT_EQ(pulled(labels, transform, labels.grid)(7, 4, 5), 12);
}

/// Shares of a known brain that a mask lacks, and of what it has beside the brain.
struct Misses {
  double missing = 0, extra = 0;
};

Misses missesOf(const Volume<Label>& mask) {
  Misses misses;
  double brain = 0;
  for (std::size_t v = 0; v < mask.size(); ++v) {
    const auto [i, j, k] = mask.grid.subscripts(v);
    const bool truth = inBrain(mask.grid.toWorld(Vector(i, j, k)));
    brain += truth ? 1 : 0;
    misses.missing += truth && mask[v] == 0 ? 1 : 0;
    misses.extra += !truth && mask[v] != 0 ? 1 : 0;
  }
  return {misses.missing / brain, misses.extra / brain};
}

/// A template's mask in the wrong place: moved, and so many mm smaller all around.
Volume<float> wrongMask(const Grid& grid, const Vector& moved, double smaller) {
  return drawn(grid, [&](const Point& p) {
    const Vector axes = Vector(62, 78, 58) - Vector::Constant(smaller);
    return (p + moved).cwiseQuotient(axes).norm() <= 1 ? 1.0 : 0.0;
  });
}

// The border is the image's, wherever the template's lies: 3 mm too small, or moved by 5 mm.
TEST(SkullStripping, FindsTheSkullFromAMaskInTheWrongPlace) {
  const Volume<float> head = drawn(cube(110, 2), headAt);
  for (const auto& [moved, smaller] :
       {std::pair{Vector(0, 0, 0), 3.0}, std::pair{Vector(4, -3, 0), 0.0}}) {
    const Volume<float> mask = wrongMask(head.grid, moved, smaller);
    const BrainMask found = stripSkull(head, mask);
    const Misses misses = missesOf(found.mask);
    // Half a voxel of 2 mm around a brain of 65 mm is 5 %.
    EXPECT_LT(misses.missing, 0.02) << moved.transpose() << ", " << smaller;
    EXPECT_LT(misses.extra, 0.05) << moved.transpose() << ", " << smaller;
    EXPECT_NEAR(found.meanOffset, smaller, 1);
    EXPECT_LT(found.openShare, 0.01);
    EXPECT_LT(found.deviation, 1);
  }
}

// The same offset for an image as bright as another scanner makes it, and shaded.
TEST(SkullStripping, DoesNotDependOnScaleOrShading) {
  const Volume<float> head = drawn(cube(74, 3), headAt);
  Volume<float> other = head;
  for (std::size_t v = 0; v < other.size(); ++v) {
    const auto [i, j, k] = other.grid.subscripts(v);
    other[v] *= static_cast<float>(7 * std::exp(0.003 * other.grid.toWorld(Vector(i, j, k)).y()));
  }
  const Volume<float> mask = wrongMask(head.grid, Vector::Zero(), 3);
  EXPECT_NEAR(stripSkull(head, mask).meanOffset, stripSkull(other, mask).meanOffset, 0.5);
}

// Without skull, tissue everywhere: the border cannot be found, and that is said.
TEST(SkullStripping, SaysWhereTissueGoesOnBeyondTheBorder) {
  const Volume<float> tissue = drawn(cube(74, 3), [](const Point& p) {
    return p.norm() < 15 ? 30.0 : (std::sin(p.x() / 7) > 0 ? 110.0 : 95.0);
  });
  const BrainMask found = stripSkull(tissue, wrongMask(tissue.grid, Vector::Zero(), 3));
  EXPECT_GT(found.openShare, 0.5);
}

TEST(SkullStripping, RefusesAMaskOutsideOfTheImage) {
  const Volume<float> head = drawn(cube(37, 6), headAt);
  EXPECT_THROW((void)stripSkull(head, Volume<float>(head.grid, 0.0f)), InvalidInput);
}

TEST(HeadRegistration, KnowsAHeadWithoutSkull) {
  const Template phantom = phantomTemplate(5);
  EXPECT_FALSE(looksStripped(phantom.head, phantom));
  EXPECT_TRUE(looksStripped(phantom.brain, phantom));
  Template withoutSkull = phantom;
  withoutSkull.head = {};
  EXPECT_THROW((void)registerHead(phantom.head, withoutSkull, false), InvalidInput);
}

}  // namespace
}  // namespace explica::registration
