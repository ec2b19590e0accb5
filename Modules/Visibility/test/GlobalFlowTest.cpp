// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Visibility/GlobalFlow.h"

#include "Explica/Core/Errors.h"
#include "Explica/Geometry/Fixtures.h"
#include "Explica/Testing/TaylorRemainder.h"
#include "Explica/Visibility/GlobalMeasures.h"
#include "Explica/Visibility/SphereView.h"

#include <gtest/gtest.h>

#include <cmath>

namespace explica::visibility {

namespace {

/// Greatest over least distance of the vertices from their mean.
double outOfRound(const TriangleMesh& mesh) {
  const Point centre = mesh.positions.colwise().mean();
  const Eigen::VectorXd r = (mesh.positions.rowwise() - centre.transpose()).rowwise().norm();
  return r.maxCoeff() / r.minCoeff();
}

double visibilityOf(const TriangleMesh& mesh) {
  return lookFromSphere(mesh, enclosingSphere(mesh, 64)).visibility;
}

}  // namespace

TEST(GlobalFlow, GradientsPassTheTaylorTest) {
  const TriangleMesh folded = geometry::makeFoldedSphere(2, 1.0, 0.4, 4);
  const auto at = [&](const Positions& x) { return TriangleMesh{x, folded.faces}; };
  const Point centre(0.1, -0.2, 0.05);
  EXPECT_NEAR(
      test::taylorSlope([&](const Positions& x) { return hiddenAreaValue(at(x), centre, 9).value; },
                        folded.positions, hiddenAreaValue(folded, centre, 9).gradient, 1e-2),
      2, 0.1);
  EXPECT_NEAR(
      test::taylorSlope([&](const Positions& x) { return softSelfOcclusion(at(x), 0.4).value; },
                        folded.positions, softSelfOcclusion(folded, 0.4).gradient, 1e-3),
      2, 0.2);
}

TEST(GlobalFlow, ItsMeasuresAreTheLimitsOfTheThesis) {
  const TriangleMesh folded = geometry::makeFoldedSphere(3, 1.0, 0.3, 5);
  const double hidden = hiddenAreaValue(folded, Point::Zero(), 9).value;
  EXPECT_NEAR(hiddenViewingArea(folded, Point::Zero(), 9) / hidden, 1, 0.05);
  const double exact = selfOcclusion(folded);
  double last = kInfinity;
  for (const double softness : {0.4, 0.1, 0.025}) {
    const double apart = std::abs(softSelfOcclusion(folded, softness).value / exact - 1);
    EXPECT_LT(apart, last) << softness;
    last = apart;
  }
  EXPECT_LT(last, 0.15);
  EXPECT_EQ(softSelfOcclusion(geometry::makeIcosphere(2)).value, 0);
}

TEST(GlobalFlow, OfTheHiddenAreaSmoothsAndDoesNotUnfold) {
  GlobalFlowOptions options;
  options.measure = GlobalMeasure::HiddenArea;
  options.maxIterations = 60;
  const GlobalFlow round = descendGlobalMeasure(geometry::makeIcosphere(3), options);
  EXPECT_LT(outOfRound(round.mesh), 1.01);  // curvature times a constant: a sphere stays one
  for (std::size_t k = 1; k < round.history.size(); ++k) {
    EXPECT_LT(round.history[k].measure, round.history[k - 1].measure);
  }
  options.maxIterations = 200;
  const TriangleMesh folded = geometry::makeFoldedSphere(3, 1.0, 0.4, 7);
  const GlobalFlow flow = descendGlobalMeasure(folded, options);
  EXPECT_LT(flow.history.back().area, 0.9 * flow.history.front().area);
  EXPECT_LT(flow.history.back().volume, flow.history.front().volume);
}

TEST(GlobalFlow, OfTheSelfOcclusionLosesTheAreaOfFolds) {
  GlobalFlowOptions options;
  options.maxIterations = 250;
  const TriangleMesh folded = geometry::makeFoldedSphere(2, 1.0, 0.4, 4);
  const GlobalFlow flow = descendGlobalMeasure(folded, options);
  EXPECT_LT(flow.history.back().measure, 0.1 * flow.history.front().measure);
  EXPECT_GT(visibilityOf(flow.mesh), visibilityOf(folded));
  EXPECT_LT(flow.history.back().area, 0.95 * flow.history.front().area);
}

TEST(GlobalFlow, RefusesNonsense) {
  const TriangleMesh sphere = geometry::makeIcosphere(1);
  EXPECT_THROW((void)softSelfOcclusion(sphere, 0), InvalidInput);
  EXPECT_THROW((void)hiddenAreaValue(sphere, Point::Zero(), 1), InvalidInput);
  EXPECT_THROW((void)descendGlobalMeasure(sphere, {.step = 2}), InvalidInput);
  const GlobalFlow nothing = descendGlobalMeasure(sphere);
  EXPECT_EQ(nothing.termination, Termination::Converged);
}

}  // namespace explica::visibility
