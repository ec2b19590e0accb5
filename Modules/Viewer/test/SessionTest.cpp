// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Viewer/Session.h"

#include "Explica/Core/Errors.h"
#include "Explica/Geometry/Fixtures.h"
#include "Explica/Geometry/SelfIntersection.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <random>
#include <thread>

namespace explica::viewer {
namespace {

/// A folded ball of 30 mm, its region at the side that faces -x.
Choice sideChoice(const Session& session) {
  Choice choice;
  (session.surface().positions.rowwise() - Eigen::RowVector3d(-30, 0, 0))
      .rowwise()
      .norm()
      .minCoeff(&choice.centre);
  choice.radius = 12;
  choice.unfold.targetVisibility = 1;  // out of reach: it does not end while it is watched
  return choice;
}

void waitFor(const Session& session, std::size_t moments) {
  while (session.activity() == Activity::Running && session.momentCount() < moments) {
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
}

TEST(Session, PreviewFollowsTheChoice) {
  Session session(geometry::makeFoldedSphere(3, 30));
  EXPECT_EQ(session.regionWords(), "no centre is chosen") << "no zeros of what is not chosen";
  Choice choice = sideChoice(session);
  const std::size_t small = session.choose(choice).region.faces.size();
  EXPECT_TRUE(session.preview().problem.empty()) << session.preview().problem;
  EXPECT_GT(session.preview().visibility, 0);
  EXPECT_TRUE(session.regionWords().starts_with(std::to_string(small) + " faces, average"));
  choice.radius = 20;
  EXPECT_GT(session.choose(choice).region.faces.size(), small);
}

TEST(Session, RegionSeenFromBehindIsAProblem) {
  Session session(geometry::makeFoldedSphere(3, 30));
  Choice choice = sideChoice(session);
  choice.view.direction = Vector(1, 0, 0);
  EXPECT_LT(session.choose(choice).visibility, 0);
  EXPECT_NE(session.preview().problem.find("not positive"), std::string::npos);
  session.run();
  EXPECT_EQ(session.activity(), Activity::Choosing);
}

TEST(Session, RunsPausesGoesOnAndKeepsEveryState) {
  Session session(geometry::makeFoldedSphere(3, 30));
  Choice choice = sideChoice(session);
  choice.unfold.areaTolerance = 1e-14;  // never kept: it does not end before it is paused
  choice.unfold.maxIterations = unfolding::kMostIterations;
  session.choose(choice);
  session.run();
  waitFor(session, 4);
  session.pause();
  const std::size_t first = session.momentCount();
  ASSERT_GE(first, 4u);
  EXPECT_EQ(session.moment(0).positions, session.surface().positions);
  EXPECT_GT(session.moment(first - 1).record.visibility, session.moment(0).record.visibility);
  session.run();
  waitFor(session, first + 2);
  session.pause();
  EXPECT_GE(session.momentCount(), first + 1);
}

TEST(Session, StatesDoNotDependOnPauses) {
  const TriangleMesh ball = geometry::makeFoldedSphere(3, 30);
  Session once(ball), often(ball);
  once.choose(sideChoice(once));
  often.choose(sideChoice(often));
  once.run();
  waitFor(once, 6);
  once.pause();
  for (std::size_t n = 2; n <= 6; n += 2) {
    often.run();
    waitFor(often, n);
    often.pause();
  }
  ASSERT_GE(once.momentCount(), 6u);
  ASSERT_GE(often.momentCount(), 6u);
  for (std::size_t n = 0; n < 6; ++n)
    EXPECT_EQ(once.moment(n).positions, often.moment(n).positions);
}

/// A folded ball some of whose vertices at the side that faces -x were thrown out of place.
TriangleMesh crossingBall() {
  TriangleMesh ball = geometry::makeFoldedSphere(4, 30);
  std::mt19937 random(7);
  std::normal_distribution<double> normal(0, 2);
  for (Eigen::Index v = 0; v < ball.vertexCount(); v += 11) {
    if (ball.positions(v, 0) > -25) continue;
    ball.positions.row(v) += Eigen::RowVector3d(normal(random), normal(random), normal(random));
  }
  return ball;
}

TEST(Session, FacesThatCrossArePartedBeforeItBegins) {
  const TriangleMesh ball = crossingBall();
  const auto crossings = geometry::findSelfIntersections(ball);
  ASSERT_FALSE(crossings.empty());
  Session session(ball);
  Choice choice = sideChoice(session);
  choice.unfold.maxIterations = 2;
  session.choose(choice);
  EXPECT_FALSE(session.parting());
  session.run();
  waitFor(session, 100);
  ASSERT_EQ(session.momentCount(), 3u);
  const auto parting = session.parting();
  ASSERT_TRUE(parting);
  EXPECT_EQ(parting->crossings, crossings.size());
  EXPECT_EQ(parting->parted, crossings.size());
  EXPECT_GT(parting->moveMax, 0);
  for (std::size_t n = 0; n < 3; ++n) {
    const TriangleMesh now{session.moment(n).positions, ball.faces};
    EXPECT_TRUE(geometry::findSelfIntersections(now).empty()) << "state " << n;
  }
  session.reset();
  EXPECT_FALSE(session.parting());
}

TEST(Session, APauseBeforeTheFirstStateDropsTheStart) {
  const TriangleMesh ball = crossingBall();
  Session session(ball), other(ball);
  for (Session* each : {&session, &other}) {
    Choice choice = sideChoice(*each);
    choice.unfold.maxIterations = 3;
    each->choose(choice);
  }
  for (int n = 0; n < 5; ++n) {
    session.run();
    session.pause();
    EXPECT_NE(session.activity(), Activity::Running);
    EXPECT_EQ(session.activity() == Activity::Choosing, session.momentCount() == 0);
  }
  for (Session* each : {&session, &other}) {
    each->run();
    waitFor(*each, 100);
    ASSERT_EQ(each->momentCount(), 4u);
  }
  EXPECT_EQ(session.moment(3).positions, other.moment(3).positions);
}

TEST(Session, NewChoiceDropsTheStates) {
  Session session(geometry::makeFoldedSphere(3, 30));
  session.choose(sideChoice(session));
  session.run();
  waitFor(session, 2);
  session.pause();
  session.reset();
  EXPECT_EQ(session.momentCount(), 0u);
  EXPECT_EQ(session.activity(), Activity::Choosing);
}

TEST(Session, StopsByItselfWhereABatchRunWould) {
  Session session(geometry::makeFoldedSphere(3, 30));
  Choice choice = sideChoice(session);
  choice.unfold.maxIterations = 3;
  session.choose(choice);
  session.run();
  waitFor(session, 100);
  EXPECT_EQ(session.activity(), Activity::Over);
  EXPECT_EQ(session.termination(), Termination::MaxIterations);
  EXPECT_EQ(session.momentCount(), 4u);
  session.run();
  EXPECT_EQ(session.activity(), Activity::Over) << "what is over does not go on";
}

TEST(Session, ACheckpointContinuesToTheSameStates) {
  const TriangleMesh ball = geometry::makeFoldedSphere(3, 30);
  Session session(ball);
  Choice choice = sideChoice(session);
  choice.unfold.maxIterations = 6;
  session.choose(choice);
  session.run();
  waitFor(session, 100);
  ASSERT_EQ(session.momentCount(), 7u);
  const auto checkpoint = session.checkpoint(3);
  ASSERT_TRUE(checkpoint);
  EXPECT_EQ(checkpoint->state.positions, session.moment(3).positions);
  EXPECT_EQ(checkpoint->history.size(), 4u);
  const auto& region = session.preview().region;
  const auto view = visibility::viewpoint(unfolding::centroidOf(ball, region) +
                                          1000 * choice.view.direction.normalized());
  const auto result = unfolding::unfold(ball, region, view, choice.unfold, {}, &*checkpoint);
  EXPECT_EQ(result.mesh.positions, session.moment(6).positions);
}

TEST(Session, ShowsAnUnfoldingThatIsOver) {
  Session session(geometry::makeFoldedSphere(3, 30));
  Finished finished;
  finished.region = session.choose(sideChoice(session)).region;
  for (int n = 0; n < 3; ++n) {
    Moment moment;
    moment.positions = session.surface().positions * (1 + 0.1 * n);
    moment.record.visibility = 0.3 * (n + 1);
    finished.moments.push_back(std::move(moment));
  }
  finished.view = visibility::viewpoint(Point(1, 2, 300));
  session.open(finished);
  EXPECT_EQ(session.viewpoints().points.front(), Point(1, 2, 300)) << "those of the run";
  EXPECT_EQ(session.activity(), Activity::Over);
  ASSERT_EQ(session.momentCount(), 3u);
  EXPECT_EQ(session.moment(2).positions, finished.moments[2].positions);
  EXPECT_FALSE(session.checkpoint(2)) << "its solver's state is not known";
  finished.moments[1].positions.resize(5, 3);
  EXPECT_THROW(session.open(finished), InvalidInput);
}

TEST(Session, ARegionMayBeMarkedVertexByVertex) {
  Session session(geometry::makeFoldedSphere(3, 30));
  Choice choice;
  for (Eigen::Index v = 0; v < session.surface().vertexCount(); ++v) {
    choice.marked.push_back(session.surface().positions(v, 0) < -22);
  }
  choice.markedOptions = {{"label", "a.label.gii"}, {"label-key", "2"}};
  EXPECT_TRUE(session.choose(choice).problem.empty()) << session.preview().problem;
  EXPECT_GT(session.preview().region.faces.size(), 10u);
  EXPECT_EQ(session.batchOptions(1).front().first, "label");
}

TEST(Session, BatchOptionsNameEveryChoice) {
  Session session(geometry::makeFoldedSphere(3, 30));
  Choice choice = sideChoice(session);
  choice.radius = 12.3456789012345678;
  session.choose(choice);
  const auto options = session.batchOptions(17);
  double radius = 0;
  for (const auto& [name, value] : options) {
    if (name == "radius") radius = std::stod(value);
    if (name == "max-iterations") {
      EXPECT_EQ(value, "17");
    }
  }
  EXPECT_EQ(radius, choice.radius);
}

}  // namespace
}  // namespace explica::viewer
