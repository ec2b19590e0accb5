// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Planar/PolygonUnfolding.h"

#include "Explica/Core/Errors.h"
#include "Explica/Planar/AngularSweep.h"
#include "Explica/Planar/PolygonPhantoms.h"
#include "Explica/Planar/PolygonVisibility.h"

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include <cmath>
#include <limits>
#include <random>
#include <string>
#include <utility>

namespace explica::planar {
namespace {

struct Case {
  PolygonPhantom phantom;
  int edges;
  double length;
  double visibility;
  double variance;
};

std::vector<Case> cases() {
  return {{makePolygon19(), 19, 416, 0.21, 0.39}, {makePolygon34(), 34, 724, 0.17, 0.69}};
}

Region regionOf(const PolygonPhantom& phantom) {
  return regionBetween(phantom.curve, phantom.first, phantom.last);
}

PolygonUnfolding unfold(const PolygonPhantom& phantom,
                        const PolygonUnfoldingOptions& options = {}) {
  return unfoldPolygon(phantom.curve, regionOf(phantom), phantom.viewpoint, options);
}

/// Average and variance of the cosine between normal and direction to the viewpoint, by midpoints.
std::pair<double, double> cosinesByQuadrature(const PolygonPhantom& phantom) {
  constexpr int kPoints = 2000;  // an edge
  double length = 0, sum = 0, squares = 0;
  const auto& positions = phantom.curve.positions;
  for (int v = phantom.first; v < phantom.last; ++v) {
    const Eigen::RowVector2d along = positions.row(v + 1) - positions.row(v);
    const double step = along.norm() / kPoints;
    const Eigen::RowVector2d outward(along.y() / along.norm(), -along.x() / along.norm());
    for (int k = 0; k < kPoints; ++k) {
      const Eigen::RowVector2d at = positions.row(v) + (k + 0.5) / kPoints * along;
      const double cosine = outward.dot((phantom.viewpoint.transpose() - at).normalized());
      length += step;
      sum += step * cosine;
      squares += step * cosine * cosine;
    }
  }
  const double average = sum / length;
  return {average, squares / length - average * average};
}

TEST(PolygonPhantoms, AreOfTheThesisKind) {
  for (const Case& c : cases()) {
    const Region region = regionOf(c.phantom);
    EXPECT_EQ(region.edgeCount, c.edges);
    const PolygonVisibility v = polygonVisibility(c.phantom.curve, region, c.phantom.viewpoint);
    EXPECT_NEAR(v.length, c.length, 1);
    EXPECT_NEAR(v.average, c.visibility, 0.005);
    EXPECT_NEAR(v.variance, c.variance, 0.005);
    const auto [average, variance] = cosinesByQuadrature(c.phantom);
    EXPECT_NEAR(v.average, average, 1e-6);
    EXPECT_NEAR(v.variance, variance, 1e-6);
    EXPECT_TRUE(intersectingEdges(c.phantom.curve).empty());
    EXPECT_GT(signedArea(c.phantom.curve.positions), 0);
  }
}

TEST(PolygonUnfolding, MakesBothRegionsVisibleAtTheirLengths) {
  for (const Case& c : cases()) {
    const PolygonUnfolding result = unfold(c.phantom);
    EXPECT_EQ(result.termination, Termination::TargetReached);
    const PolygonIteration& end = result.history.back();
    EXPECT_GE(end.visibility, 0.99);
    EXPECT_LE(end.variance, 0.01);
    EXPECT_LT(end.lengthError, 1e-6);
    EXPECT_TRUE(result.intersectionsFinal.empty());
    EXPECT_GE(visiblePart(result.curve, result.region, c.phantom.viewpoint).fraction, 0.99);
    // Vertices outside the region have not moved.
    for (int v = c.phantom.last + 1; v < result.curve.vertexCount(); ++v) {
      EXPECT_EQ(result.curve.positions.row(v), c.phantom.curve.positions.row(v));
    }
  }
}

TEST(PolygonUnfolding, NoStateOnTheWayCrossesItself) {
  for (const Case& c : cases()) {
    for (const PolygonKnot knot : {PolygonKnot::AllPairs, PolygonKnot::Tree, PolygonKnot::Off}) {
      PolygonUnfoldingOptions options;
      options.knot = knot;
      const PolygonUnfolding result = unfold(c.phantom, options);
      for (std::size_t k = 0; k < result.path.size(); ++k) {
        Curve at = result.curve;
        at.positions = result.path[k].positions;
        ASSERT_TRUE(intersectingEdges(at).empty()) << "iteration " << k;
      }
      for (const PolygonIteration& row : result.history) EXPECT_LT(row.lengthError, 1e-6);
      EXPECT_GE(result.history.back().visibility, 0.99) << nameOf(knot);
    }
  }
}

TEST(PolygonUnfolding, ElasticAndAbsentSurroundsUnfoldToo) {
  for (const PolygonSurround surround : {PolygonSurround::Elastic, PolygonSurround::None}) {
    for (const Case& c : cases()) {
      PolygonUnfoldingOptions options;
      options.surround = surround;
      const PolygonUnfolding result = unfold(c.phantom, options);
      EXPECT_GE(result.history.back().visibility, 0.99) << nameOf(surround);
      EXPECT_LT(result.history.back().lengthError, 1e-6);
      EXPECT_TRUE(result.intersectionsFinal.empty());
    }
  }
}

// [Thesis, Fig. 4.19].
TEST(PolygonUnfolding, WithoutLengthTheRegionCollapses) {
  const PolygonPhantom phantom = makePolygon34();
  for (const PolygonMethod method : {PolygonMethod::Implicit, PolygonMethod::Thesis}) {
    PolygonUnfoldingOptions options;
    options.noLength = true;
    options.method = method;
    const PolygonUnfolding result = unfold(phantom, options);
    EXPECT_GE(result.history.back().visibility, 0.99) << nameOf(method);
    EXPECT_LT(result.history.back().length, result.history.front().length / 3) << nameOf(method);
    EXPECT_GT(result.verticesMerged, 0) << nameOf(method);
    for (const PolygonState& state : result.path) {
      ASSERT_TRUE(intersectingEdges({state.positions, true}).empty()) << nameOf(method);
    }
  }
}

// [Thesis, Fig. 4.20].
TEST(PolygonUnfolding, WithoutTopologyEdgesCrossWithinAHundredIterations) {
  const PolygonPhantom phantom = makePolygon34();
  for (const PolygonMethod method : {PolygonMethod::Implicit, PolygonMethod::Thesis}) {
    PolygonUnfoldingOptions options;
    options.noTopology = true;
    options.method = method;
    options.maxIterations = 400;
    options.explicitStep = 0.1;
    const PolygonUnfolding result = unfold(phantom, options);
    EXPECT_GT(result.firstCrossing, 0) << nameOf(method);
    EXPECT_LE(result.firstCrossing, 100) << nameOf(method);
  }
}

TEST(PolygonUnfolding, ThesisFlowUnfoldsTheFirstPolygonToFirstOrderInLength) {
  PolygonUnfoldingOptions options;
  options.method = PolygonMethod::Thesis;
  const PolygonUnfolding result = unfold(makePolygon19(), options);
  EXPECT_GE(result.history.back().visibility, 0.98);
  EXPECT_LT(std::abs(result.history.back().length / result.history.front().length - 1), 0.02);
  EXPECT_TRUE(result.intersectionsFinal.empty());
}

TEST(PolygonUnfolding, FlatChainFacingTheViewpointStays) {
  Curve chain;
  chain.closed = false;
  chain.positions.resize(11, 2);
  for (int k = 0; k <= 10; ++k) chain.positions.row(k) << -k, 0;
  const PolygonUnfolding result = unfoldPolygon(chain, wholeRegion(chain), {-5, 1e5}, {});
  EXPECT_EQ(result.termination, Termination::TargetReached);
  EXPECT_EQ(result.history.size(), 1U);
}

TEST(PolygonUnfolding, IsTheSameAfterRigidMotion) {
  const PolygonPhantom phantom = makePolygon19();
  const Eigen::Matrix2d turn = Eigen::Rotation2Dd(0.5 * kPi).toRotationMatrix();
  PolygonPhantom moved = phantom;
  for (int v = 0; v < moved.curve.vertexCount(); ++v) {
    moved.curve.positions.row(v) = (turn * phantom.curve.point(v)).transpose();
  }
  moved.viewpoint = turn * phantom.viewpoint;
  const PolygonUnfolding a = unfold(phantom);
  const PolygonUnfolding b = unfold(moved);
  EXPECT_NEAR(a.history.back().visibility, b.history.back().visibility, 5e-3);
  EXPECT_GE(b.history.back().visibility, 0.99);
}

TEST(PolygonUnfolding, RandomFoldedChainsNeverCross) {
  // Chains grown at random without crossings, seen from above.
  std::mt19937 random(2026);
  std::uniform_real_distribution<double> uniform(-1, 1);
  int unfolded = 0;
  int trials = 0;
  while (trials < 12) {
    Curve chain;
    chain.closed = false;
    chain.positions = Positions2::Zero(1, 2);
    double heading = kPi;
    for (int tries = 0; tries < 4000 && chain.vertexCount() < 26; ++tries) {
      Curve longer = chain;
      longer.positions.conservativeResize(chain.vertexCount() + 1, 2);
      const double angle = heading + 1.9 * uniform(random);
      longer.positions.row(chain.vertexCount()) =
          chain.positions.row(chain.vertexCount() - 1) +
          (1.3 + uniform(random)) * Eigen::RowVector2d(std::cos(angle), std::sin(angle));
      if (!intersectingEdges(longer).empty()) continue;
      heading = 0.7 * angle + 0.3 * kPi;
      chain = longer;
    }
    if (chain.vertexCount() < 26) continue;
    const Point2 viewpoint(0, 500);
    const Region region = wholeRegion(chain);
    if (polygonVisibility(chain, region, viewpoint).average <= 0.02) continue;
    ++trials;
    const PolygonUnfolding result = unfoldPolygon(chain, region, viewpoint);
    for (const PolygonState& state : result.path) {
      Curve at = chain;
      at.positions = state.positions;
      ASSERT_TRUE(intersectingEdges(at).empty()) << "trial " << trials << ", seed 2026";
    }
    EXPECT_LT(result.history.back().lengthError, 1e-6);
    unfolded += result.history.back().visibility >= 0.99;
  }
  EXPECT_EQ(unfolded, 12);
}

void expectSame(const PolygonUnfolding& a, const PolygonUnfolding& b, const std::string& what) {
  ASSERT_EQ(a.history.size(), b.history.size()) << what;
  EXPECT_EQ(a.curve.positions, b.curve.positions) << what;
  EXPECT_EQ(a.termination, b.termination) << what;
  EXPECT_EQ(a.verticesMerged, b.verticesMerged) << what;
  EXPECT_EQ(a.firstCrossing, b.firstCrossing) << what;
  for (std::size_t k = 0; k < a.history.size(); ++k) {
    EXPECT_EQ(a.path[k].positions, b.path[k].positions) << what << ", iteration " << k;
    EXPECT_EQ(a.history[k].visibility, b.history[k].visibility) << what;
    EXPECT_EQ(a.history[k].lengthError, b.history[k].lengthError) << what;
  }
}

TEST(PolygonUnfolding, ResumedIsBitByBitTheUninterruptedRun) {
  const PolygonPhantom phantom = makePolygon34();
  std::vector<std::pair<std::string, PolygonUnfoldingOptions>> runs(5);
  runs[0].first = "implicit";
  runs[1].first = "no length: vertices are merged on the way";
  runs[1].second.noLength = true;
  runs[2].first = "no topology";
  runs[2].second.noTopology = true;
  runs[3].first = "elastic";
  runs[3].second.surround = PolygonSurround::Elastic;
  runs[4].first = "thesis";
  runs[4].second.method = PolygonMethod::Thesis;
  runs[4].second.maxIterations = 120;
  for (const auto& [what, options] : runs) {
    const PolygonUnfolding whole = unfold(phantom, options);
    for (const int stop : {0, 1, 17}) {
      PolygonUnfoldingOptions first = options;
      first.maxIterations = stop;
      const PolygonUnfolding part = unfold(phantom, first);
      ASSERT_EQ(part.termination, Termination::MaxIterations) << what;
      expectSame(unfoldPolygon(phantom.curve, regionOf(phantom), phantom.viewpoint, options, {},
                               &part.checkpoint),
                 whole, what + ", stopped after " + std::to_string(stop));
    }
  }
}

TEST(PolygonUnfolding, StateOfAnotherRunIsRefused) {
  const PolygonPhantom phantom = makePolygon19();
  PolygonUnfoldingOptions options;
  options.maxIterations = 2;
  const PolygonCheckpoint state = unfold(phantom, options).checkpoint;
  const Region region = regionOf(phantom);
  const auto resumed = [&](const Curve& curve, const Region& where, const Point2& viewpoint) {
    (void)unfoldPolygon(curve, where, viewpoint, options, {}, &state);
  };
  EXPECT_NO_THROW(resumed(phantom.curve, region, phantom.viewpoint));
  EXPECT_THROW(resumed(phantom.curve, region, phantom.viewpoint + Point2(1, 0)), InvalidInput);
  EXPECT_THROW(resumed(phantom.curve, {0, 18}, phantom.viewpoint), InvalidInput);
  Curve other = phantom.curve;
  other.positions(0, 0) += 1e-9;
  EXPECT_THROW(resumed(other, region, phantom.viewpoint), InvalidInput);
  options.method = PolygonMethod::Thesis;
  EXPECT_THROW(resumed(phantom.curve, region, phantom.viewpoint), InvalidInput);
}

TEST(PolygonUnfolding, ALineOfViewpointsIsItsQuadrature) {
  const PolygonPhantom phantom = makePolygon19();
  const Region region = regionOf(phantom);
  const Point2 a = phantom.viewpoint - Point2(3000, 0);
  const Point2 b = phantom.viewpoint + Point2(3000, 0);
  const Viewpoints view({a, b}, {0.25, 0.75});
  const PolygonVisibility both = polygonVisibility(phantom.curve, region, view);
  const PolygonVisibility fromA = polygonVisibility(phantom.curve, region, a);
  const PolygonVisibility fromB = polygonVisibility(phantom.curve, region, b);
  EXPECT_NEAR(both.average, 0.25 * fromA.average + 0.75 * fromB.average, 1e-15);
  EXPECT_NEAR(both.variance, 0.25 * fromA.variance + 0.75 * fromB.variance, 1e-15);
  EXPECT_LT((both.gradient - 0.25 * fromA.gradient - 0.75 * fromB.gradient).cwiseAbs().maxCoeff(),
            1e-15);
  EXPECT_NEAR(visiblePart(phantom.curve, region, view).fraction,
              0.25 * visiblePart(phantom.curve, region, a).fraction +
                  0.75 * visiblePart(phantom.curve, region, b).fraction,
              1e-15);
  // From a short line the region opens as from its middle; from a wide one it cannot face all.
  PolygonUnfoldingOptions options;
  options.targetVisibility = 0.99;
  const Viewpoints line({phantom.viewpoint - Point2(200, 0), phantom.viewpoint + Point2(200, 0)},
                        {0.5, 0.5});
  const PolygonUnfolding opened = unfoldPolygon(phantom.curve, region, line, options);
  EXPECT_EQ(opened.termination, Termination::TargetReached);
  EXPECT_TRUE(opened.intersectionsFinal.empty());
}

TEST(PolygonUnfolding, WrongInputIsRefused) {
  PolygonPhantom phantom = makePolygon19();
  const Region region = regionOf(phantom);
  EXPECT_THROW((void)unfoldPolygon(phantom.curve, region, {50, -4000}), InvalidInput)
      << "seen from behind, the average visibility is negative";
  Curve clockwise = phantom.curve;
  clockwise.positions = clockwise.positions.colwise().reverse().eval();
  EXPECT_THROW((void)unfoldPolygon(clockwise, region, phantom.viewpoint), InvalidInput);
  PolygonUnfoldingOptions options;
  options.explicitStep = 0;
  EXPECT_THROW((void)unfold(phantom, options), InvalidInput);
  Curve crossed = phantom.curve;
  crossed.positions.row(3).swap(crossed.positions.row(9));
  EXPECT_THROW((void)unfoldPolygon(crossed, region, phantom.viewpoint), InvalidInput);
}

TEST(PolygonUnfolding, StopsWhenAsked) {
  Monitor monitor;
  int asked = 0;
  monitor.stopWanted = [&] { return ++asked > 20; };
  const PolygonPhantom phantom = makePolygon34();
  const PolygonUnfolding result =
      unfoldPolygon(phantom.curve, regionOf(phantom), phantom.viewpoint, {}, monitor);
  EXPECT_EQ(result.termination, Termination::Interrupted);
  EXPECT_GE(result.history.size(), 2U);
  EXPECT_LE(result.history.size(), 21U);  // at least one look an iteration
  EXPECT_EQ(result.path.size(), result.history.size());
}

/// An iteration on many edges takes seconds: it asks while it sums, and what it began is given up.
TEST(PolygonUnfolding, AStopWithinAnIterationLeavesTheStateBeforeIt) {
  Curve circle;
  circle.positions.resize(5000, 2);
  for (Eigen::Index v = 0; v < circle.positions.rows(); ++v) {
    const double t =
        2 * kPi * static_cast<double>(v) / static_cast<double>(circle.positions.rows());
    circle.positions.row(v) << 10 * std::cos(t), 10 * std::sin(t);
  }
  const Region region = regionBetween(circle, 800, 1700);
  PolygonUnfoldingOptions options;
  Monitor monitor;
  int asked = 0, end = std::numeric_limits<int>::max();
  monitor.stopWanted = [&] { return ++asked >= end; };
  options.maxIterations = 1;
  const PolygonUnfolding once = unfoldPolygon(circle, region, Point2(0, 1000), options, monitor);
  EXPECT_GT(asked, 10) << "in one iteration";
  const int first = asked;
  options.maxIterations = 2;
  end = 3 * first / 2;
  asked = 0;
  const PolygonUnfolding stopped = unfoldPolygon(circle, region, Point2(0, 1000), options, monitor);
  EXPECT_EQ(stopped.termination, Termination::Interrupted);
  EXPECT_LE(asked, end + 2);
  EXPECT_EQ(stopped.curve.positions, once.curve.positions);
  const PolygonUnfolding whole = unfoldPolygon(circle, region, Point2(0, 1000), options);
  const PolygonUnfolding resumed =
      unfoldPolygon(circle, region, Point2(0, 1000), options, {}, &stopped.checkpoint);
  EXPECT_EQ(resumed.curve.positions, whole.curve.positions);
}

}  // namespace
}  // namespace explica::planar
