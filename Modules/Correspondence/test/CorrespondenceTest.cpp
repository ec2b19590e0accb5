// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Correspondence/Correspondence.h"
#include "Explica/Correspondence/Measurement.h"

#include "Explica/Core/Errors.h"
#include "Explica/Core/Parallel.h"
#include "Explica/Correspondence/Layers.h"
#include "Explica/Correspondence/Sulci.h"
#include "Explica/Harmonic/Phantoms.h"

#include <Eigen/Geometry>

#include <gtest/gtest.h>
#include <hwy/targets.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <random>

using namespace explica;
using namespace explica::correspondence;
using harmonic::Annulus;
using harmonic::ExactAnnulus;
using harmonic::Interpolant;

namespace {

bool sameBytes(const Eigen::Vector3f& one, const Eigen::Vector3f& other) {
  return std::memcmp(one.data(), other.data(), sizeof(float) * 3) == 0;
}

struct Solved {
  ExactAnnulus exact;
  Annulus annulus;
  Interpolant interpolant;
};

Solved solve(const ExactAnnulus& exact, const Grid& grid) {
  Solved s;
  s.exact = exact;
  s.annulus = harmonic::annulusFromLevels(harmonic::sampled(grid, exact.innerLevel),
                                          harmonic::sampled(grid, exact.outerLevel),
                                          {0, harmonic::LevelInside::Below});
  s.interpolant = harmonic::solveInterpolant(s.annulus);
  return s;
}

/// Mean and greatest error in units of the finest spacing.
struct Errors {
  double meanPoint = 0, maxPoint = 0, meanThickness = 0, maxThickness = 0;
};

Errors errorsOf(const Solved& s, const Correspondence& found, double unit) {
  Errors e;
  EXPECT_EQ(found.missing, 0U);
  for (std::int32_t n = 0; n < static_cast<std::int32_t>(s.annulus.count()); ++n) {
    const Point x = s.annulus.world(n);
    const auto answer = s.exact.answer(x);
    const double inner = (x + found.innerPoint[n].cast<double>() - answer.innerPoint).norm() / unit;
    const double outer = (x + found.outerPoint[n].cast<double>() - answer.outerPoint).norm() / unit;
    const double thickness = std::abs(found.thickness(n) - answer.thickness()) / unit;
    e.meanPoint += 0.5 * (inner + outer);
    e.maxPoint = std::max({e.maxPoint, inner, outer});
    e.meanThickness += thickness;
    e.maxThickness = std::max(e.maxThickness, thickness);
  }
  e.meanPoint /= static_cast<double>(s.annulus.count());
  e.meanThickness /= static_cast<double>(s.annulus.count());
  return e;
}

CorrespondenceOptions with(Method method, std::optional<double> lambda = {}) {
  CorrespondenceOptions options;
  options.method = method;
  options.lambda = lambda;
  return options;
}

Solved eccentric() {
  return solve(harmonic::exactEccentric(10, 25, 5),
               harmonic::centredGrid({72, 72, 1}, {0.75, 0.75, 1}));
}

Solved spheroids() {
  return solve(harmonic::exactSpheroids(30, 0.5, 1),
               harmonic::centredGrid({64, 64, 88}, Vector::Constant(1)));
}

TEST(ThicknessSummary, AMeanOverTheMiddleSurfaceCountsEachColumnByItsCrossSection) {
  // Columns of 2 and 6 voxels of 1 mm, as many of one kind as of the other.
  Correspondence found;
  for (const int t : {2, 6}) {
    for (int voxel = 0; voxel < t; ++voxel) {
      found.innerDistance.push_back(voxel + 0.5);
      found.outerDistance.push_back(t - voxel - 0.5);
    }
  }
  const ThicknessSummary summary = summaryOf(found);
  EXPECT_NEAR(summary.mean, 4, 1e-12);
  EXPECT_NEAR(summary.meanOfVoxels, 5, 1e-12);
}

/// Mean of a measure over the surface at half depth, by many random points of the tissue: those
/// within a tenth of half depth, each by 1 / thickness.
double exactMean(const ExactAnnulus& exact, double reach) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> uniform(-reach, reach);
  double sum = 0, weights = 0;
  for (int n = 0; n < 1000000; ++n) {
    const Point x(uniform(random), uniform(random), uniform(random));
    if (exact.innerLevel(x) <= 0 || exact.outerLevel(x) >= 0) continue;
    const auto answer = exact.answer(x);
    if (std::abs(answer.innerDistance / answer.thickness() - 0.5) > 0.1) continue;
    sum += 1;
    weights += 1 / answer.thickness();
  }
  return sum / weights;
}

TEST(ThicknessSummary, HasTheMeanOverTheMiddleSurfaceOfATissueOfUnevenThickness) {
  const Solved s = spheroids();
  const ThicknessSummary summary = summaryOf(findCorrespondences(s.annulus, s.interpolant));
  const double exact = exactMean(s.exact, 44);
  std::printf("mean over the middle surface %.3f mm, of voxels %.3f mm, exact %.3f mm\n",
              summary.mean, summary.meanOfVoxels, exact);
  EXPECT_NEAR(summary.mean, exact, 0.02);
  EXPECT_GT(std::abs(summary.meanOfVoxels - exact), 0.1);
}

/// A shell of 15 and 20 voxels whose centre is off the grid's middle, so that the image's faces cut
/// it obliquely.
Volume<Label> cutShell(const Vector& spacing) {
  Grid grid;
  grid.size = {48, 44, 30};
  grid.spacing = spacing;
  Volume<Label> labels(grid);
  for (std::size_t v = 0; v < labels.size(); ++v) {
    const auto at = grid.subscripts(v);
    const double r = (Vector(at[0], at[1], at[2]).cwiseProduct(spacing) - Vector(23, 9, 7)).norm();
    labels[v] = r < 15 ? 1 : r < 20 ? 2 : 0;
  }
  return labels;
}

TEST(ImageEdge, TissueThatRunsOutOfTheImageIsMeasuredAndMarkedWhereTheEdgeReaches) {
  harmonic::LabelRoles roles;
  roles.inner = {1};
  roles.tissue = {2};
  for (const Vector& spacing : {Vector(1, 1, 1), Vector(1, 1, 0.7)}) {
    const Measurement m = measure(harmonic::annulusFromLabels(cutShell(spacing), roles));
    double sum = 0, worstFree = 0, worstMarked = 0;
    std::size_t free = 0;
    ASSERT_EQ(m.nearEdge.size(), m.annulus.count());
    EXPECT_EQ(m.correspondence.missing, 0U);
    for (std::size_t n = 0; n < m.annulus.count(); ++n) {
      const double t = m.correspondence.thickness(n);
      EXPECT_GT(m.layers[n], 0);
      double& worst = m.nearEdge[n] ? worstMarked : worstFree;
      worst = std::max(worst, std::abs(t - 5));
      if (m.nearEdge[n]) continue;
      sum += t;
      ++free;
    }
    EXPECT_EQ(free + m.cutVoxels, m.annulus.count());
    EXPECT_GT(free, m.annulus.count() / 5);
    EXPECT_NEAR(sum / static_cast<double>(free), 5, 0.05);
    EXPECT_LT(worstFree, 0.5);
    EXPECT_GT(worstMarked, 2 * worstFree);
  }
}

/// A layer that runs on far beyond the region under it, whose other side lies below the image.
TEST(ImageEdge, WhatLeavesTheImageBeforeItsBoundaryIsNotLost) {
  Grid grid;
  grid.size = {120, 8, 12};
  Volume<Label> labels(grid);
  for (std::size_t v = 0; v < labels.size(); ++v) {
    const auto at = grid.subscripts(v);
    labels[v] = at[2] >= 6 ? 0 : at[2] < 2 && at[0] < 15 ? 1 : 2;
  }
  harmonic::LabelRoles roles;
  roles.inner = {1};
  roles.tissue = {2};
  std::vector<std::string> warnings;
  Monitor monitor;
  monitor.onWarning = [&](const std::string& text) { warnings.push_back(text); };
  const Measurement m = measure(harmonic::annulusFromLabels(labels, roles), {}, monitor);
  EXPECT_GT(m.correspondence.missing, 100U);
  EXPECT_EQ(m.lost, 0U);
  EXPECT_EQ(m.cutVoxels, m.annulus.count());
  ASSERT_EQ(warnings.size(), 1U);
  EXPECT_NE(warnings[0].find(std::to_string(m.correspondence.missing) +
                             " whose trajectory leaves the image"),
            std::string::npos)
      << warnings[0];
}

/// A piece of tissue within the inner region; a speck of it, as any real tissue has some, is
/// counted.
TEST(Measurement, SaysOnceWhyTissueHasNoThicknessAndWhere) {
  const auto shell = harmonic::makePhantom(harmonic::PhantomKind::Shell, {64, 1}).labels;
  for (const int side : {1, 6}) {
    auto labels = shell;
    for (int v = 0; v < side * side * side; ++v) {
      labels(30 + v % side, 30 + v / side % side, 30 + v / side / side) = 2;
    }
    std::vector<std::string> warnings;
    Monitor monitor;
    monitor.onWarning = [&](const std::string& text) { warnings.push_back(text); };
    const Measurement m =
        measure(harmonic::annulusFromLabels(labels, {{1}, {2}, {}, {}}, {}, monitor), {}, monitor);
    EXPECT_EQ(m.annulus.droppedVoxels, static_cast<std::size_t>(side * side * side));
    ASSERT_EQ(warnings.size(), side == 1 ? 0U : 1U);
    if (side == 1) continue;
    EXPECT_EQ(warnings[0],
              "216 voxels of tissue could not be measured: 216 in pieces that touch only one of "
              "the two boundaries (the first at voxel (30, 30, 30))");
  }
}

}  // namespace

TEST(Correspondence, LagrangianIsExactToAFewHundredthsOfAVoxel) {
  for (const Solved& s : {eccentric(), spheroids()}) {
    const Errors e =
        errorsOf(s, findCorrespondences(s.annulus, s.interpolant, with(Method::Lagrangian)),
                 s.annulus.grid.spacing[0]);
    EXPECT_LE(e.meanPoint, 0.02);
    EXPECT_LE(e.maxPoint, 0.1);
    EXPECT_LE(e.meanThickness, 0.01);
  }
}

TEST(Correspondence, HybridAtLambdaZeroIsLagrangian) {
  const Solved s = eccentric();
  const auto a = findCorrespondences(s.annulus, s.interpolant, with(Method::Lagrangian));
  const auto b = findCorrespondences(s.annulus, s.interpolant, with(Method::Hybrid, 0.0));
  for (std::size_t n = 0; n < s.annulus.count(); ++n) {
    EXPECT_NEAR(a.thickness(n), b.thickness(n), 1e-6);
    EXPECT_LE((a.innerPoint[n] - b.innerPoint[n]).norm(), 1e-6F);
  }
}

TEST(Correspondence, HybridIsNearlyAsGoodAndEulerianVisiblyWorse) {
  const Solved s = spheroids();
  const auto error = [&](const CorrespondenceOptions& options) {
    return errorsOf(s, findCorrespondences(s.annulus, s.interpolant, options), 1).meanPoint;
  };
  const double lagrangian = error(with(Method::Lagrangian));
  EXPECT_LE(error(with(Method::Hybrid)), 1.5 * lagrangian);
  EXPECT_GE(error(with(Method::AppendixA, kInfinity)), 5 * lagrangian);
  EXPECT_GE(error(with(Method::Eulerian)), 20 * lagrangian);
}

TEST(Correspondence, HybridDoesNotJumpAtLambdaInfinity) {
  const Solved s = eccentric();
  const auto finite = findCorrespondences(s.annulus, s.interpolant, with(Method::Hybrid, 1e6));
  const auto infinite =
      findCorrespondences(s.annulus, s.interpolant, with(Method::Hybrid, kInfinity));
  EXPECT_EQ(finite.innerDistance, infinite.innerDistance);
  EXPECT_EQ(finite.outerDistance, infinite.outerDistance);
}

TEST(Correspondence, LambdaDialsAppendixAFromTheLagrangianToTheSweep) {
  const Solved s = eccentric();
  const double unit = s.annulus.grid.spacing[0];
  const auto measured = [&](std::optional<double> lambda) {
    const auto found =
        findCorrespondences(s.annulus, s.interpolant, with(Method::AppendixA, lambda));
    return std::pair{errorsOf(s, found, unit).meanPoint, found.traced};
  };
  const double lagrangian =
      errorsOf(s, findCorrespondences(s.annulus, s.interpolant, with(Method::Lagrangian)), unit)
          .meanPoint;
  const double eulerian =
      errorsOf(s, findCorrespondences(s.annulus, s.interpolant, with(Method::Eulerian)), unit)
          .meanPoint;
  EXPECT_DOUBLE_EQ(measured(0.0).first, lagrangian);
  auto before = measured(0.1);
  for (const double lambda : {0.2, 0.4, 0.8, 1.6, 3.2}) {
    const auto now = measured(lambda);
    EXPECT_GE(now.first, before.first) << lambda;
    EXPECT_LE(now.second, before.second) << lambda;
    before = now;
  }
  EXPECT_NEAR(measured(kInfinity).first, before.first, 0.1 * before.first);
  EXPECT_GT(before.first, 10 * lagrangian);
  EXPECT_LT(before.first, eulerian);
}

/// A copy of one upwind neighbour where the other is not solved would not know of lambda.
TEST(Correspondence, TheLargestErrorOfAppendixAFollowsLambda) {
  const Solved s = solve(harmonic::exactEccentric(10, 25, 5),
                         harmonic::centredGrid({128, 128, 1}, {0.5, 0.5, 1}));
  const auto largest = [&](double lambda) {
    const auto found =
        findCorrespondences(s.annulus, s.interpolant, with(Method::AppendixA, lambda));
    double most = 0;
    for (std::int32_t n = 0; n < static_cast<std::int32_t>(s.annulus.count()); ++n) {
      const Point x = s.annulus.world(n);
      const Point there = x + found.innerPoint[n].cast<double>();
      most = std::max(most, (there - s.exact.answer(x).innerPoint).norm());
    }
    return most;
  };
  EXPECT_LE(largest(0.1), 0.01);  // mm
  EXPECT_LE(largest(0.1), 0.5 * largest(0.3));
}

TEST(Correspondence, AppendixAIsOfFirstOrderAndTheHybridOfSecond) {
  const ExactAnnulus exact = harmonic::exactEccentric(10, 25, 5);
  double appendix[2], ours[2];
  for (int fine = 0; fine < 2; ++fine) {
    const double h = fine ? 0.375 : 0.75;
    const int n = fine ? 144 : 72;
    const Solved s = solve(exact, harmonic::centredGrid({n, n, 1}, {h, h, 1}));
    const auto error = [&](const CorrespondenceOptions& options) {
      return errorsOf(s, findCorrespondences(s.annulus, s.interpolant, options), 1).meanPoint;
    };
    appendix[fine] = error(with(Method::AppendixA, kInfinity));
    ours[fine] = error(with(Method::Hybrid, kInfinity));
  }
  EXPECT_NEAR(std::log2(appendix[0] / appendix[1]), 1, 0.4);
  EXPECT_NEAR(std::log2(ours[0] / ours[1]), 2, 0.7);
}

TEST(Correspondence, HoldsForAnisotropicVoxelsAndObliqueAxes) {
  Grid grid = harmonic::centredGrid({64, 48, 30}, {0.5, 0.7, 1.1});
  const ExactAnnulus exact = harmonic::exactShell(7, 13);
  Solved straight = solve(exact, grid);
  const Errors e = errorsOf(
      straight, findCorrespondences(straight.annulus, straight.interpolant, with(Method::Hybrid)),
      0.5);
  EXPECT_LE(e.meanThickness, 0.02);
  EXPECT_LE(e.maxPoint, 0.25);

  // The same tissue seen by a turned grid: a shell does not notice.
  grid.direction = Eigen::AngleAxisd(0.5, Vector(1, 2, 3).normalized()).toRotationMatrix();
  grid.origin = grid.direction * grid.origin;
  const Solved turned = solve(exact, grid);
  const Errors f = errorsOf(
      turned, findCorrespondences(turned.annulus, turned.interpolant, with(Method::Hybrid)), 0.5);
  EXPECT_NEAR(e.meanThickness, f.meanThickness, 1e-4);
  EXPECT_NEAR(e.meanPoint, f.meanPoint, 1e-3);
}

/// Corners of a face of long voxels are farther apart than those of cubes, and no less alike.
TEST(Correspondence, InterpolatesOnFacesOfLongVoxelsToo) {
  const ExactAnnulus exact = harmonic::exactShell(9, 18);
  const auto followed = [&](const Vector& spacing) {
    const Vector size = Vector::Constant(40).cwiseQuotient(spacing);
    const Solved s =
        solve(exact, harmonic::centredGrid({static_cast<int>(size[0]), static_cast<int>(size[1]),
                                            static_cast<int>(size[2])},
                                           spacing));
    const auto found = findCorrespondences(s.annulus, s.interpolant, with(Method::Hybrid));
    EXPECT_LE(errorsOf(s, found, spacing.minCoeff()).meanThickness, 0.004);
    return static_cast<double>(found.traced) / (2 * static_cast<double>(s.annulus.count()));
  };
  const double ofCubes = followed(Vector::Constant(0.5));
  EXPECT_LT(followed({0.5, 0.5, 1}), 1.5 * ofCubes);
  EXPECT_LT(followed({1, 0.5, 0.5}), 1.5 * ofCubes);
}

TEST(Correspondence, DoesNotDependOnTheNumberOfThreads) {
  for (const Solved& s : {eccentric(), spheroids()}) {
    // A small lambda sends many trajectories past the first face, through several blocks.
    for (const std::optional<double> lambda : {std::optional<double>{}, std::optional{0.5}}) {
      const auto foundBy = [&](int threads) {
        setThreadCount(threads);
        return findCorrespondences(s.annulus, s.interpolant, with(Method::Hybrid, lambda));
      };
      const auto one = foundBy(1);
      for (const int threads : {2, 4}) {
        const auto many = foundBy(threads);
        EXPECT_EQ(one.innerDistance, many.innerDistance);
        EXPECT_EQ(one.outerDistance, many.outerDistance);
        EXPECT_EQ(one.innerPoint, many.innerPoint);
        EXPECT_EQ(one.outerPoint, many.outerPoint);
        EXPECT_EQ(one.traced, many.traced);
      }
    }
  }
  setThreadCount(0);
}

TEST(Correspondence, EmbeddingServesAsWellAsSubvoxelBoundaries) {
  harmonic::AnnulusOptions options;
  options.boundary = harmonic::BoundaryModel::Embedding;
  for (const Solved& direct : {eccentric(), spheroids()}) {
    Solved s;
    s.exact = direct.exact;
    const Grid& grid = direct.annulus.grid;
    s.annulus = harmonic::annulusFromLevels(harmonic::sampled(grid, s.exact.innerLevel),
                                            harmonic::sampled(grid, s.exact.outerLevel),
                                            {0, harmonic::LevelInside::Below}, options);
    s.interpolant = harmonic::solveInterpolant(s.annulus);
    EXPECT_LE(s.interpolant.misfit, 1e-3);
    for (const Method method : {Method::Lagrangian, Method::Hybrid}) {
      const auto found = findCorrespondences(s.annulus, s.interpolant, with(method));
      const Errors e = errorsOf(s, found, grid.spacing[0]);
      std::printf("embedding: points %.4f / %.4f, thickness %.4f / %.4f voxel, misfit %.1e\n",
                  e.meanPoint, e.maxPoint, e.meanThickness, e.maxThickness, s.interpolant.misfit);
      EXPECT_EQ(found.missing, 0U);
      EXPECT_LE(e.meanPoint, 0.02);
      EXPECT_LE(e.meanThickness, 0.01);
    }
  }
}

TEST(Correspondence, LabelsAloneGiveATwentiethOfAVoxel) {
  // The second size puts the poles, equators and axes elsewhere between the voxels.
  for (const auto kind : {harmonic::PhantomKind::Shell, harmonic::PhantomKind::Spheroid}) {
    for (const harmonic::PhantomOptions& size :
         {harmonic::PhantomOptions{96, 1}, harmonic::PhantomOptions{101, 0.9}}) {
      const auto phantom = harmonic::makePhantom(kind, size);
      Solved s;
      s.exact = phantom.exact;
      s.annulus = harmonic::annulusFromLabels(phantom.labels, {{1}, {2}, {}, {}});
      s.interpolant = harmonic::solveInterpolant(s.annulus);
      const Errors e = errorsOf(s, findCorrespondences(s.annulus, s.interpolant), size.spacing);
      std::printf("labels: mean %.4f max %.4f voxel\n", e.meanThickness, e.maxThickness);
      EXPECT_LE(e.meanThickness, 0.06);
      EXPECT_LE(e.maxThickness, 0.5);
    }
  }
}

TEST(Trajectory, ReachesAnyLevelFromAnyPoint) {
  const Solved s = spheroids();
  const TrajectoryTracer tracer(s.annulus, s.interpolant);
  const Point start(14.2, 3.1, 12.7);
  ASSERT_LT(s.exact.innerLevel(start) * s.exact.outerLevel(start), 0);
  const auto answer = s.exact.answer(start);
  const Trace out = tracer.trace(start, 1), in = tracer.trace(start, 0);
  ASSERT_TRUE(out.reached && in.reached);
  EXPECT_NEAR((out.point - answer.outerPoint).norm(), 0, 0.05);
  EXPECT_NEAR((in.point - answer.innerPoint).norm(), 0, 0.05);
  EXPECT_NEAR(out.length + in.length, answer.thickness(), 0.02);
  const Trace half = tracer.trace(in.point, 0.5);
  ASSERT_TRUE(half.reached);
  EXPECT_NEAR(s.exact.answer(half.point).u, 0.5, 0.003);
  EXPECT_FALSE(tracer.trace(Point(200, 0, 0), 1).reached);
}

/// Two slabs of white matter, grey matter all between: each bank is half of it.
Volume<Label> banksThatTouch(int between = 11, const Vector& spacing = {1, 1, 0.9}) {
  const int wide = between + 13;
  Volume<Label> labels(harmonic::centredGrid({wide, 20, 40}, spacing), 0);
  for (int k = 0; k < 40; ++k) {
    for (int j = 0; j < 20; ++j) {
      for (int i = 0; i < wide; ++i) {
        const bool bank = i < 6 || i >= 6 + between;
        labels(i, j, k) = k < 6 ? 1 : k < 34 ? (bank ? 1 : 2) : 0;
      }
    }
  }
  return labels;
}

// Banks of 13 voxels, with a sheet between them that no step may pass, along other axes of the grid
// than the world's; and tissue whose trajectories bend.
TEST(Correspondence, LongStepsComeToWhereThoseOfAVoxelDo) {
  Volume<Label> labels = banksThatTouch(27, {0.6, 0.9, 0.7});
  labels.grid.direction = Eigen::AngleAxisd(0.7, Vector(1, -2, 3).normalized()).toRotationMatrix() *
                          Vector(1, -1, 1).asDiagonal();
  Solved banks;
  banks.annulus = recoverSulci(harmonic::annulusFromLabels(labels, {{1}, {2}, {}, {}})).annulus;
  banks.interpolant = harmonic::solveInterpolant(banks.annulus);
  for (const Solved& s : {banks, eccentric(), spheroids()}) {
    const auto by = [&](const TraceOptions& trace) {
      CorrespondenceOptions options;
      options.trace = trace;
      return findCorrespondences(s.annulus, s.interpolant, options);
    };
    const auto close = by({.tolerance = 1e-6, .maxStep = 0.25});
    /// Mean way between boundary points, and the share of voxels where it is over a tenth of one.
    const auto apart = [&](const TraceOptions& trace) -> Eigen::Array2d {
      const auto found = by(trace);
      double sum = 0, far = 0;
      for (std::size_t n = 0; n < s.annulus.count(); ++n) {
        const double off = (found.innerPoint[n] - close.innerPoint[n]).norm() +
                           (found.outerPoint[n] - close.outerPoint[n]).norm();
        EXPECT_FALSE(std::isnan(off));
        sum += off;
        far += off > 0.1 * s.annulus.grid.spacing.minCoeff();
      }
      return Eigen::Array2d(sum, far) / static_cast<double>(s.annulus.count());
    };
    const Eigen::Array2d voxel = apart({}), grown = apart(CorrespondenceOptions().trace);
    std::printf("steps of a voxel: %.5f mm, %.5f far; longer: %.5f mm, %.5f far\n", voxel[0],
                voxel[1], grown[0], grown[1]);
    const double tolerance = TraceOptions().tolerance * s.annulus.grid.spacing.minCoeff();
    EXPECT_LE(grown[0], voxel[0] + tolerance);
    EXPECT_LE(grown[1], 1.1 * voxel[1]);
  }
}

TEST(Correspondence, DoesNotDependOnTheInstructionSet) {
  const Annulus cortex =
      recoverSulci(harmonic::annulusFromLabels(banksThatTouch(), {{1}, {2}, {}, {}})).annulus;
  const Solved shells = eccentric();
  const auto foundWith = [](std::int64_t targets, const Annulus& annulus, Method method) {
    hwy::SetSupportedTargetsForTest(targets);
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
    auto found =
        findCorrespondences(annulus, harmonic::solveInterpolant(annulus), with(method, {}));
    hwy::SetSupportedTargetsForTest(0);
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
    return found;
  };
  for (const Method method : {Method::Lagrangian, Method::Hybrid}) {
    for (const Annulus* annulus : {&cortex, &shells.annulus}) {
      const auto best = foundWith(0, *annulus, method);
      std::int64_t left = hwy::SupportedTargets();
      for (; left != 0; left &= left - 1) {
        const auto one = foundWith(left & -left, *annulus, method);
        EXPECT_TRUE(std::ranges::equal(best.innerPoint, one.innerPoint, sameBytes));
        EXPECT_TRUE(std::ranges::equal(best.outerPoint, one.outerPoint, sameBytes));
        EXPECT_EQ(best.traced, one.traced);
      }
    }
  }
}

TEST(Correspondence, EachTrajectoryGoesAsItWouldAlone) {
  const Annulus annulus =
      recoverSulci(harmonic::annulusFromLabels(banksThatTouch(), {{1}, {2}, {}, {}})).annulus;
  const Interpolant interpolant = harmonic::solveInterpolant(annulus);
  CorrespondenceOptions options;
  options.method = Method::Lagrangian;
  const Correspondence found = findCorrespondences(annulus, interpolant, options);
  const TrajectoryTracer tracer(annulus, interpolant, options.trace);
  const auto expectSame = [](double together, const Trace& alone) {
    EXPECT_EQ(std::isnan(together), !alone.reached);
    if (alone.reached) {
      EXPECT_EQ(together, static_cast<float>(alone.length));
    }
  };
  for (std::int32_t n = 0; n < static_cast<std::int32_t>(annulus.count()); ++n) {
    expectSame(found.innerDistance[n], tracer.trace(n, 0));
    expectSame(found.outerDistance[n], tracer.trace(n, 1));
  }
}

TEST(Sulci, TwoBanksThatTouchAreParted) {
  const Volume<Label> labels = banksThatTouch();
  for (const auto model : {harmonic::BoundaryModel::Subvoxel, harmonic::BoundaryModel::Embedding}) {
    const Annulus annulus =
        harmonic::annulusFromLabels(labels, {{1}, {2}, {}, {}}, {.boundary = model});
    const auto recovered = recoverSulci(annulus);
    EXPECT_GT(recovered.voxels.size(), 500U);
    const auto interpolant = harmonic::solveInterpolant(recovered.annulus);
    const auto found = findCorrespondences(recovered.annulus, interpolant);
    int seen = 0;
    for (std::int32_t n = 0; n < static_cast<std::int32_t>(recovered.annulus.count()); ++n) {
      const Vector index = recovered.annulus.index(n);
      if (index[2] < 16 || index[2] > 28) continue;
      ++seen;
      EXPECT_NEAR(found.thickness(n), 5.5, 0.25) << nameOf(model);
    }
    EXPECT_GT(seen, 500);
  }
}

TEST(Sulci, AConvexTissueHasNone) {
  const Solved s = spheroids();
  EXPECT_EQ(recoverSulci(s.annulus).voxels.size(), 0U);
}

TEST(Layers, EqualVolumeFollowsTheColumn) {
  // In a shell the column's volume below radius r is (r^3 - a^3) / (b^3 - a^3).
  const Solved s = solve(harmonic::exactShell(6, 12),
                         harmonic::centredGrid({40, 40, 40}, Vector::Constant(0.7)));
  const auto found = findCorrespondences(s.annulus, s.interpolant);
  const auto depth = depthOf(found);
  const auto share = volumeDepthOf(s.annulus, s.interpolant, found);
  for (std::int32_t n = 0; n < static_cast<std::int32_t>(s.annulus.count()); ++n) {
    const double r = s.annulus.world(n).norm();
    EXPECT_NEAR(depth[n], (r - 6) / 6, 0.01);
    EXPECT_NEAR(share[n], (r * r * r - 216) / (1728 - 216), 0.01);
  }
  const auto layers = layersOf(depth, 4);
  EXPECT_EQ(*std::min_element(layers.begin(), layers.end()), 1);
  EXPECT_EQ(*std::max_element(layers.begin(), layers.end()), 4);
}

/// A lump of voxels with folds of a few voxels, and three layers of tissue around it.
Volume<Label> crumpledLabels() {
  Grid grid;
  grid.size = {32, 32, 32};
  Volume<Label> labels(grid);
  const Vector middle = Vector::Constant(15.5);
  for (std::size_t v = 0; v < labels.size(); ++v) {
    const auto at = grid.subscripts(v);
    const double x = at[0], y = at[1], z = at[2];
    const double folds = std::sin(1.6 * x + 0.3 * y) * std::cos(1.28 * y + 0.5) +
                         std::sin(1.44 * y) * std::cos(1.76 * z) +
                         std::sin(1.52 * z) * std::cos(1.68 * x);
    labels[v] = (Vector(x, y, z) - middle).norm() + 1.5 * folds < 9.6 ? 1 : 0;
  }
  for (int layer = 0; layer < 3; ++layer) {
    const Volume<Label> before = labels;
    for (std::size_t v = 0; v < labels.size(); ++v) {
      const auto at = grid.subscripts(v);
      for (int axis = 0; axis < 3 && labels[v] == 0; ++axis) {
        for (const int step : {-1, 1}) {
          auto next = at;
          next[axis] += step;
          if (grid.contains(next[0], next[1], next[2]) && before(next[0], next[1], next[2]) != 0) {
            labels[v] = 2;
          }
        }
      }
    }
  }
  return labels;
}

/// The solution has no extremum within the tissue, so a walk that keeps rising arrives, however
/// rough the walls are; only ties are left.
TEST(Measurement, NextToNoVoxelOfCrumpledLabelsIsWithoutThickness) {
  harmonic::LabelRoles roles;
  roles.inner = {1};
  roles.tissue = {2};
  const Measurement measured =
      measure(harmonic::annulusFromLabels(crumpledLabels(), roles), MeasurementOptions());
  EXPECT_GT(measured.annulus.count(), 5000U);
  EXPECT_LE(measured.correspondence.missing, 5U);
}

TEST(Measurement, NoLayerIsRefusedBeforeAnyWork) {
  harmonic::LabelRoles roles;
  roles.inner = {1};
  roles.tissue = {2};
  MeasurementOptions options;
  options.layers.layers = 0;
  int parts = 0;
  EXPECT_THROW((void)measure(harmonic::annulusFromLabels(cutShell(Vector(1, 1, 1)), roles), options,
                             {}, [&](const std::string&, const Measurement&) { ++parts; }),
               InvalidInput);
  EXPECT_EQ(parts, 0);
}
