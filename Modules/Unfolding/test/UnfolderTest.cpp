// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "../src/Contacts.h"
#include "../src/Motion.h"
#include "../src/PatchSetup.h"
#include "Flask.h"
#include "Meander.h"

#include "Explica/Core/Errors.h"
#include "Explica/Core/Parallel.h"
#include "Explica/Geometry/MeshMeasures.h"
#include "Explica/Geometry/SelfIntersection.h"
#include "Explica/Testing/InstructionSets.h"
#include "Explica/Testing/Meshes.h"
#include "Explica/Unfolding/Account.h"
#include "Explica/Unfolding/Continuation.h"
#include "Explica/Unfolding/Distortion.h"
#include "Explica/Unfolding/Summary.h"
#include "Explica/Unfolding/Unfold.h"
#include "Explica/Visibility/VisibleFraction.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <filesystem>
#include <limits>
#include <map>

namespace explica::unfolding {
namespace {

constexpr int kColumns = 48, kRows = 16;

struct Case {
  TriangleMesh mesh = makeMeander(kColumns, kRows);
  Region region = regionOfMarked(mesh, interiorOf(kColumns, kRows, 3));
  visibility::Viewpoints view = visibility::viewpoint(Point(8, 8, 1000));
};

UnfolderOptions with(Surround surround) {
  UnfolderOptions options;
  options.surround = surround;
  return options;
}

TEST(Unfolder, OverhangingFoldsOpenAndKeepTheirAreas) {
  const Case c;
  UnfoldOptions options;
  options.unfolder.surround = Surround::None;
  options.targetVisibility = 0.98;
  const UnfoldResult result = unfold(c.mesh, c.region, c.view, options);
  EXPECT_EQ(result.termination, Termination::TargetReached);
  EXPECT_LT(result.history.front().visibility, 0.4);
  EXPECT_GE(result.history.back().visibility, 0.98);
  const Distortion d = measureDistortion({c.mesh.positions, result.mesh.faces},
                                         result.mesh.positions, result.region.faces);
  EXPECT_LT(d.areaErrorMean, 0.003);
  EXPECT_LT(d.edgeStrainMean, 0.03);  // the sheet is developable: it can open without strain
}

TEST(Unfolder, NoAcceptedStepIntersectsAndNoObjectiveRises) {
  const Case c;
  for (const Surround surround : {Surround::Fixed, Surround::Elastic, Surround::None}) {
    Unfolder unfolder(c.mesh, c.region, c.view, with(surround));
    for (int n = 0; n < 40; ++n) {
      ASSERT_TRUE(unfolder.step());
      const IterationRecord& r = unfolder.record();
      ASSERT_LE(r.objectiveAfter, r.objectiveBefore) << n;
      ASSERT_TRUE(geometry::findSelfIntersections(unfolder.current()).empty())
          << nameOf(surround) << " iteration " << n;
    }
    EXPECT_GT(unfolder.record().visibility, 0.8) << nameOf(surround);
  }
}

TEST(Unfolder, SurroundingsMoveOnlyWhereTheyMay) {
  const Case c;
  Unfolder fixed(c.mesh, c.region, c.view, with(Surround::Fixed));
  UnfolderOptions collar = with(Surround::Elastic);
  collar.collarWidth = 2;
  Unfolder elastic(c.mesh, c.region, c.view, collar);
  EXPECT_GT(elastic.movingVertices().size(), fixed.movingVertices().size());
  for (Unfolder* unfolder : {&fixed, &elastic}) {
    for (int n = 0; n < 3; ++n) unfolder->step();
    std::vector<bool> moves(static_cast<std::size_t>(c.mesh.vertexCount()), false);
    for (const std::int32_t v : unfolder->movingVertices()) moves[v] = true;
    for (Eigen::Index v = 0; v < c.mesh.vertexCount(); ++v) {
      if (!moves[v]) {
        ASSERT_EQ(unfolder->state().positions.row(v), c.mesh.positions.row(v));
      }
    }
  }
}

TEST(Unfolder, ACollarIsAsWideOnARefinedSurface) {
  // The same sheet with edges of 1 and of 1/2: the area that moves agrees to a coarse face's width.
  std::array<double, 2> areas{};
  for (const int fine : {0, 1}) {
    const int columns = kColumns << fine, rows = kRows << fine;
    TriangleMesh mesh = makeMeander(columns, rows);
    if (fine) mesh.positions *= 0.5;
    const Region region = regionOfMarked(mesh, interiorOf(columns, rows, 6 << fine));
    UnfolderOptions options = with(Surround::Elastic);
    options.collarWidth = 3.01;
    const std::vector<bool> moves =
        movingFaces(mesh, region, visibility::viewpoint(Point(8, 8, 1000)), options);
    const Eigen::VectorXd faces = geometry::faceAreas(mesh);
    for (std::size_t f = 0; f < moves.size(); ++f) areas[fine] += moves[f] ? faces[f] : 0;
  }
  // A rim of 80 mm, times the half mm that faces across the width reach farther where coarse.
  EXPECT_NEAR(areas[0], areas[1], 60);
  EXPECT_GT(areas[0], areas[1]);
}

TEST(Unfolder, ACollarIsAsWideAsTheRegionOrAsItIsDeep) {
  constexpr double kWall = 12, kLean = 0.15;
  const Flask flask(kWall, kLean);
  const auto view = visibility::viewpoint(Point(0, 0, 1e6));
  const auto widthOf = [&](const std::vector<bool>& marked) {
    const Region region = regionOfMarked(flask.mesh, marked);
    const Unfolder unfolder(flask.mesh, region, view);
    double area = 0;
    const Eigen::VectorXd areas = geometry::faceAreas(flask.mesh);
    for (const std::int32_t f : region.faces) area += areas[f];
    return std::pair(unfolder.state().collarWidth, std::sqrt(area / kPi));
  };
  const double depth = Flask::profileAt(Flask::kBottom + kWall, kWall, kLean)[1];
  const auto [wide, radius] = widthOf(flask.bottom);
  ASSERT_GT(depth, radius);
  EXPECT_NEAR(wide, 0.6 * (depth + 0.1 * radius), 0.1);
  std::vector<bool> all(flask.bottom.size(), true);
  const auto [widest, whole] = widthOf(all);
  EXPECT_NEAR(widest, 0.6 * whole, 1e-9);
}

/// A narrow collar: the walls above it hold the region down, unless they are parted.
UnfoldOptions inTheFlask() {
  UnfoldOptions options;
  options.unfolder.collarWidth = 2.1;
  options.frames = 4;
  return options;
}

/// The bottom of a flask, unfolded once for all tests.
struct OutOfTheFlask {
  Flask flask = Flask(8, 0.4);
  Region region = regionOfMarked(flask.mesh, flask.bottom);
  visibility::Viewpoints view = visibility::viewpoint(Point(0, 0, 1000));
  UnfoldResult result = unfold(flask.mesh, region, view, inTheFlask());
};
const OutOfTheFlask& outOfTheFlask() {
  static const OutOfTheFlask once;
  return once;
}

TEST(Unfold, SurroundingsThatHoldTheRegionBelowArePartedFurther) {
  const auto& [flask, region, view, result] = outOfTheFlask();
  // Out of the flask, at the cost of a goal: that is said.
  const IterationRecord& end = result.history[static_cast<std::size_t>(result.iteration)];
  const double seen = visibility::seenShare(result.mesh, region.faces, view);
  const bool met = meetsGoals(kGoalVisibility, end.visibility, seen, end.edgeStrainMean);
  EXPECT_EQ(result.flag, met ? Flag::None : Flag::Held);
  EXPECT_EQ(reachedGoal(result.termination), met);
  EXPECT_GE(result.checkpoint.state.ways, 1);
  EXPECT_GT(result.checkpoint.state.collarWidth, 2.1);
  EXPECT_GT(result.history.back().visibility, 0.95);
  double lowest = kInfinity;
  for (const std::int32_t v : region.vertices) {
    lowest = std::min(lowest, result.mesh.positions(v, 2));
  }
  EXPECT_GT(lowest, 6);  // out of the pit
  EXPECT_TRUE(geometry::findSelfIntersections(result.mesh).empty());
}

TEST(Unfold, ResumesAcrossAPartingOfTheSurroundings) {
  const auto& [flask, region, view, whole] = outOfTheFlask();
  ASSERT_GE(whole.checkpoint.state.ways, 1);
  UnfoldOptions brief = inTheFlask();
  brief.maxIterations = 5;
  const UnfoldResult begun = unfold(flask.mesh, region, view, brief);
  brief.maxIterations = static_cast<int>(whole.history.size()) - 3;
  const UnfoldResult almost = unfold(flask.mesh, region, view, brief, {}, &begun.checkpoint);
  const UnfoldResult rest = unfold(flask.mesh, region, view, inTheFlask(), {}, &almost.checkpoint);
  EXPECT_EQ(whole.mesh.positions, rest.mesh.positions);
  ASSERT_EQ(whole.frames.size(), rest.frames.size());
  for (std::size_t n = 0; n < whole.frames.size(); ++n) {
    EXPECT_EQ(whole.frames[n].positions, rest.frames[n].positions);
  }
}

/// A sheet with a dome in its middle, which cannot be laid flat without strain.
TriangleMesh makeDome(double height) {
  TriangleMesh dome = geometry::makeRectangle(20, 20, 20, 20);
  for (Eigen::Index v = 0; v < dome.vertexCount(); ++v) {
    const double x = dome.positions(v, 0) - 10, y = dome.positions(v, 1) - 10;
    dome.positions(v, 2) = height * std::exp(-(x * x + y * y) / 30);
  }
  return dome;
}

TEST(Unfold, LengthsRecoverWhereMoreIsSeenThanNeeded) {
  const TriangleMesh dome = makeDome(9);
  const Region region = regionOfMarked(dome, interiorOf(20, 20, 0));
  UnfoldOptions options;
  options.unfolder.surround = Surround::None;
  options.unfolder.weights[Term::Spring] = 0.3;
  const auto view = visibility::viewpoint(Point(10, 10, 1000));
  const UnfoldResult result = unfold(dome, region, view, options);
  double strained = 0;  // at most, where areas are kept
  for (const IterationRecord& row : result.history) {
    if (row.areaErrorShare <= options.areaTolerance) {
      strained = std::max(strained, row.edgeStrainMean);
    }
  }
  const IterationRecord& end = result.history[static_cast<std::size_t>(result.iteration)];
  ASSERT_GT(strained, kGoalStrain);
  EXPECT_LT(result.checkpoint.state.drive, 1);
  EXPECT_LT(end.edgeStrainMean, strained - 0.002);
  EXPECT_GT(end.visibility, kGoalVisibility - 0.001);
}

TEST(Unfold, LengthsYieldFurtherWhereLessIsSeenThanPromised) {
  // Waves that stiff lengths would keep half closed.
  TriangleMesh waves = geometry::makeRectangle(24, 8, 24, 8);
  for (Eigen::Index v = 0; v < waves.vertexCount(); ++v) {
    waves.positions(v, 2) =
        0.7 * std::sin(kPi * waves.positions(v, 0) / 3) * std::sin(kPi * waves.positions(v, 1) / 3);
  }
  const Region region = regionOfMarked(waves, interiorOf(24, 8, 0));
  UnfoldOptions options;
  options.unfolder.surround = Surround::None;
  options.unfolder.weights[Term::Spring] = 300;
  const UnfoldResult result =
      unfold(waves, region, visibility::viewpoint(Point(12, 4, 1000)), options);
  const IterationRecord& end = result.history[static_cast<std::size_t>(result.iteration)];
  EXPECT_GT(result.checkpoint.state.drive, 1);
  EXPECT_GT(end.visibility, result.history[5].visibility + 0.01);  // before it is strengthened
  EXPECT_LT(end.edgeStrainMean, kGoalStrain + 0.001);
}

TEST(Unfold, OfTwoStatesTheOneThatLacksLessIsBetter) {
  IterationRecord state;
  const auto better = [&](double visibility, double strain, double other, double otherStrain) {
    state.visibility = visibility;
    state.edgeStrainMean = strain;
    return isBetter(state, {0, other, otherStrain, {}});
  };
  EXPECT_TRUE(better(0.986, 0.09, 0.99, 0.12));
  EXPECT_FALSE(better(0.99, 0.12, 0.986, 0.09));
  EXPECT_TRUE(better(0.995, 0.06, 0.99, 0.03));
  EXPECT_TRUE(better(0.984, 0.08, 0.982, 0.03));  // strained little: more is seen
  EXPECT_TRUE(better(0.97, 0.10, 0.96, 0.05));
  EXPECT_FALSE(better(0.97, 0.15, 0.96, 0.05));
  state.visibility = 0.991;
  state.edgeStrainMean = 0.2;
  EXPECT_TRUE(isBetter(state, {0, 0.99, 0.05, {}}, true)) << "on the way to a target seeing counts";
}

TEST(Unfold, AStateOfWhichTooLittleIsSeenIsNoBetterThanThatLacks) {
  EXPECT_NEAR(merit(0.99, 0.05, 0.95), -0.03, 1e-12);
  EXPECT_NEAR(merit(0.97, 0.05, 0.95), -0.03, 1e-12);
  EXPECT_DOUBLE_EQ(merit(0.94, 0.05, 0.95), merit(0.94, 0.05)) << "the visibility lacks more";
  EXPECT_DOUBLE_EQ(merit(0.99, 0.05, 0.98), merit(0.99, 0.05)) << "enough is seen";
  IterationRecord state;
  state.visibility = 0.982;
  state.edgeStrainMean = 0.08;
  EXPECT_TRUE(isBetter(state, {0, 0.99, 0.05, {}, 0.95}, false, 0.97));
  EXPECT_FALSE(isBetter(state, {0, 0.981, 0.08, {}, 0.97}, false, 0.95));
}

/// A floor with low waves, one seventh of the region under a lid high above, which stays.
struct UnderALid {
  TriangleMesh mesh;
  Region region;
  UnfoldOptions options;

  explicit UnderALid(bool lidded = true) {
    constexpr int kSteps = 20;
    mesh = geometry::makeRectangle(kSteps, kSteps, 10, 10);
    for (Eigen::Index v = 0; v < mesh.vertexCount(); ++v) {
      mesh.positions(v, 2) = 0.05 * std::sin(kPi * mesh.positions(v, 0));
    }
    std::vector<bool> marked = interiorOf(kSteps, kSteps, 2);
    if (lidded) {
      TriangleMesh lid = geometry::makeRectangle(1, 1, 3, 3);
      lid.positions.rowwise() += Eigen::RowVector3d(6, 3.5, kHeight);
      mesh = geometry::joined(mesh, lid);
      marked.resize(static_cast<std::size_t>(mesh.vertexCount()), false);
    }
    region = regionOfMarked(mesh, marked);
    options.unfolder.surround = Surround::Fixed;
    options.unfolder.weights[Term::Lift] = 0;
  }
  /// From so far aside that the lid's shadow is shifted by `shift` mm.
  static visibility::Viewpoints view(double shift = 0) {
    return visibility::viewpoint(Point(5 - shift * 1e6 / kHeight, 5, 1e6));
  }
  static constexpr double kHeight = 20;
};

/// Where the continuation ends a run whose view slides by `slide` mm of shadow each time.
UnfoldState endUnderALid(double slide) {
  const UnderALid c;
  Unfolder unfolder(c.mesh, c.region, UnderALid::view(), solverOptions(c.options));
  const Continuation continuation(c.options);
  std::vector<IterationRecord> history = {unfolder.record()};
  while (history.size() < 60 && continuation.next(unfolder, history) == Termination::NotRun) {
    unfolder.setViewpoints(UnderALid::view(slide * static_cast<double>(history.size())));
    unfolder.step();
    history.push_back(unfolder.record());
    if (unfolder.state().look.iteration >= 0) unfolder.look();  // as a run does, for its best state
  }
  return unfolder.state();
}

TEST(Continuation, GoesOnAsLongAsMoreAndMoreIsSeen) {
  const UnderALid open(false);
  const UnfoldResult bare = unfold(open.mesh, open.region, UnderALid::view(), open.options);
  ASSERT_EQ(bare.termination, Termination::Converged);
  const int first = bare.history.back().iteration;
  EXPECT_EQ(bare.checkpoint.state.look.iteration, first) << "one look where enough is seen";
  EXPECT_DOUBLE_EQ(bare.checkpoint.state.look.seen, 1);
  const UnfoldState held = endUnderALid(0);
  EXPECT_GT(held.drive, 1.5 * bare.checkpoint.state.drive) << "raised, as too little is seen";
  EXPECT_LT(held.iteration, first + 20) << "... and that has an end";
  EXPECT_NEAR(held.look.seen, 1 - 9.0 / 64, 0.01);
  const UnfoldState more = endUnderALid(0.2);
  EXPECT_GT(more.iteration, held.iteration) << "more at every look";
  EXPECT_GE(more.look.seen, kGoalSeen);
}

/// What a run says that ends with a goal missed.
std::vector<std::string> warningsOf(const TriangleMesh& mesh, const Region& region,
                                    const visibility::Viewpoints& view,
                                    const UnfoldOptions& options, UnfoldResult& result) {
  std::vector<std::string> said;
  Monitor monitor;
  monitor.onWarning = [&](const std::string& text) { said.push_back(text); };
  result = unfold(mesh, region, view, options, monitor);
  return said;
}

TEST(Unfold, IsNotCalledConvergedWhereTooLittleIsSeen) {
  const UnderALid c;
  UnfoldResult result;
  const auto said = warningsOf(c.mesh, c.region, UnderALid::view(), c.options, result);
  EXPECT_EQ(result.termination, Termination::Stalled);
  EXPECT_EQ(result.flag, Flag::Held) << "0.12 short";
  ASSERT_EQ(said.size(), 1u);
  EXPECT_NE(said[0].find("can be seen from the viewpoint, 0."), std::string::npos) << said[0];
  EXPECT_NE(said[0].find("short of its goal of 0.98"), std::string::npos) << said[0];
}

TEST(Unfold, IsCalledConvergedOnlyWhereEveryGoalIsReachedAndSaysWhichIsNot) {
  // A steep dome cannot be laid flat without more strain than the goal allows.
  const Case sheet;
  const TriangleMesh dome = makeDome(13);
  const Region whole = regionOfMarked(dome, interiorOf(20, 20, 0));
  UnfoldOptions alone;
  alone.unfolder.surround = Surround::None;
  UnfoldResult inReach, outOfReach;
  EXPECT_TRUE(warningsOf(sheet.mesh, sheet.region, sheet.view, alone, inReach).empty());
  EXPECT_EQ(inReach.termination, Termination::Converged);
  const auto said =
      warningsOf(dome, whole, visibility::viewpoint(Point(10, 10, 1000)), alone, outOfReach);
  EXPECT_FALSE(outOfReach.termination == Termination::Converged);
  const IterationRecord& end = outOfReach.history[static_cast<std::size_t>(outOfReach.iteration)];
  ASSERT_LT(end.visibility, kGoalVisibility);
  ASSERT_GT(end.edgeStrainMean, kGoalStrain);
  ASSERT_EQ(said.size(), 2u);
  EXPECT_NE(said[0].find("the visibility is 0.9"), std::string::npos) << said[0];
  EXPECT_NE(said[0].find("short of its goal of 0.98"), std::string::npos) << said[0];
  EXPECT_NE(said[1].find("beyond their goal of 9 %"), std::string::npos) << said[1];
}

TEST(Unfold, AMissOfAnyGoalIsNotGreen) {
  EXPECT_TRUE(meetsGoals(0.98, 0.98, 0.98, 0.09));
  EXPECT_FALSE(meetsGoals(0.98, 0.979, 0.99, 0.05));
  EXPECT_FALSE(meetsGoals(0.98, 0.99, 0.979, 0.05));
  EXPECT_FALSE(meetsGoals(0.98, 0.99, 0.99, 0.0901));
  EXPECT_TRUE(meetsGoals(0.9, 0.91, 0.905, 0.09)) << "a target that asks for less";
  // What files say is judged by itself, whatever the run thought of it.
  for (const auto& [visibility, seen, strain, verdict] :
       {std::tuple{0.981, 0.99, 0.08, Judgement::Good},
        {0.979, 0.99, 0.08, Judgement::Doubt},
        {0.981, 0.975, 0.08, Judgement::Doubt},
        {0.981, 0.99, 0.095, Judgement::Doubt}}) {
    UnfoldSummary summary;
    summary.visibility = {0.3, visibility};
    summary.seen = {0.5, seen};
    summary.distortion.edgeStrainMean = strain;
    Results results;
    describe(results, summary);
    Judgement worst = Judgement::Good;
    for (const char* key : {"visibility_final", "seen_final", "edge_strain_mean"}) {
      worst = std::max(worst, results.find(key)->judgement().value_or(Judgement::Good));
    }
    EXPECT_EQ(worst, verdict) << visibility << ' ' << seen << ' ' << strain;
  }
}

TEST(Unfold, NeverEndsWorseThanTheBestStateSeen) {
  const Case c;
  // Lengths that outweigh everything: from an open state back to the folded one.
  UnfoldOptions options;
  options.unfolder.surround = Surround::None;
  const UnfoldResult open = unfold(c.mesh, c.region, c.view, options);
  Checkpoint back = open.checkpoint;
  options.unfolder.weights[Term::Spring] = 1e4;
  options.unfolder.weights[Term::Lift] = 0;
  options.targetVisibility = 1;
  options.maxIterations = static_cast<int>(open.history.size()) + 5;
  back.state.drive = 1e-9;
  const UnfoldResult result = unfold(c.mesh, c.region, c.view, options, {}, &back);
  ASSERT_LT(result.history.back().visibility, open.history.back().visibility - 0.01);
  EXPECT_LT(result.iteration, result.history.back().iteration);
  EXPECT_EQ(result.iteration, back.best.iteration);
  EXPECT_GE(result.history[static_cast<std::size_t>(result.iteration)].visibility,
            open.history.back().visibility - 0.001);
}

TEST(Unfold, ARunThatNeverGetsBetterGivesBackItsStartAndSaysSo) {
  const Case c;
  UnfoldOptions options;
  options.unfolder.method = Method::Thesis;
  options.unfolder.surround = Surround::Fixed;
  options.unfolder.knot = repulsion::KnotMethod::Tree;
  options.unfolder.weights[Term::Knot] = -1;  // draws folds together
  options.maxIterations = 3;
  int warnings = 0;
  Monitor monitor;
  monitor.onWarning = [&](const std::string& text) {
    warnings += text.find("no state is better than the start") != std::string::npos;
  };
  const UnfoldResult result = unfold(c.mesh, c.region, c.view, options, monitor);
  ASSERT_LT(result.history.back().visibility, result.history.front().visibility);
  EXPECT_EQ(result.flag, Flag::Worse);
  EXPECT_EQ(warnings, 1);
  EXPECT_EQ(result.mesh.positions, c.mesh.positions);
}

TEST(Unfold, ALiftBringsARegionOutOfAPit) {
  const Flask flask;
  const Region region = regionOfMarked(flask.mesh, flask.bottom);
  const auto view = visibility::viewpoint(Point(0, 0, 1000));
  std::array<double, 2> lowest{};
  for (const int lifted : {0, 1}) {
    UnfoldOptions options;
    if (!lifted) options.unfolder.weights[Term::Lift] = 0;
    const UnfoldResult result = unfold(flask.mesh, region, view, options);
    EXPECT_TRUE(geometry::findSelfIntersections(result.mesh).empty());
    lowest[lifted] = kInfinity;
    for (const std::int32_t v : region.vertices) {
      lowest[lifted] = std::min(lowest[lifted], result.mesh.positions(v, 2));
    }
  }
  const double lip = Flask::profileAt(Flask::kBottom + 6, 6, 0.15)[1];
  EXPECT_GT(lowest[1], lip);
  EXPECT_LT(lowest[0], lip);
}

TEST(Unfolder, ACollarThatFollowsLetsARegionGoFurtherThanFixedWalls) {
  const TriangleMesh mesh = makeMeander(kColumns, kRows, 2.1, 3);
  const Region region = regionOfMarked(mesh, interiorOf(kColumns, kRows, 4));
  const auto view = visibility::viewpoint(Point(8, 8, 1000));
  std::array<UnfoldResult, 2> ends;
  for (const int follows : {0, 1}) {
    UnfoldOptions options;
    options.unfolder.surround = follows ? Surround::Elastic : Surround::Fixed;
    options.unfolder.collarWidth = 3;
    int warnings = 0;
    Monitor monitor;
    monitor.onWarning = [&](const std::string& text) {
      warnings += text.find("fixed surroundings leave") != std::string::npos;
    };
    ends[follows] = unfold(mesh, region, view, options, monitor);
    const bool held = !follows && ends[follows].history.back().visibility < kGoalVisibility;
    EXPECT_EQ(warnings, held ? 1 : 0);
    // The account is of the region, whatever the collar does.
    const Distortion d = measureDistortion(mesh, ends[follows].mesh.positions, region.faces);
    EXPECT_NEAR(ends[follows].history.back().edgeStrainMean, d.edgeStrainMean, 1e-12);
    EXPECT_NEAR(ends[follows].history.back().areaErrorMean, d.areaErrorMean, 1e-12);
    const Eigen::VectorXd areas = geometry::faceAreas(mesh)(region.faces);
    EXPECT_NEAR(ends[follows].history.back().areaErrorShare,
                (d.areaRatio.array() - 1).abs().matrix().dot(areas) / areas.sum(), 1e-12);
    EXPECT_TRUE(geometry::findSelfIntersections(ends[follows].mesh).empty());
  }
  EXPECT_GT(ends[1].history.back().visibility, ends[0].history.back().visibility);
  EXPECT_LT(ends[1].history.back().edgeStrainMean, ends[0].history.back().edgeStrainMean);
}

TEST(Unfold, AGoalOutOfReachEndsSoonAndSaysSo) {
  const Case c;
  UnfoldOptions options;
  options.targetVisibility = 1;
  options.unfolder.surround = Surround::Fixed;
  const UnfoldResult result = unfold(c.mesh, c.region, c.view, options);
  EXPECT_EQ(result.termination, Termination::Stalled);
  EXPECT_LT(result.history.size(), 200u);
  EXPECT_GT(result.history.back().visibility, 0.97);
}

TEST(Unfold, ACollarTooNarrowGivesWayWhichIsSaid) {
  const TriangleMesh ball = geometry::makeFoldedSphere(4, 30.0);
  RegionOptions where;
  where.center = Point(0, 0, 30);
  where.radius = 20;
  UnfoldOptions options;
  options.unfolder.collarWidth = 0.5;
  const UnfoldResult result =
      unfold(ball, selectRegion(ball, where), visibility::viewpoint(Point(0, 0, 1000)), options);
  EXPECT_GT(result.history.back().collarStretchMax, kCollarMost);
  EXPECT_GT(result.history.back().collarStretchMean, kCollarMean);
  EXPECT_EQ(result.flag, Flag::Stretched);
  EXPECT_EQ(result.termination, Termination::Stalled);
}

TEST(Unfold, AMissedGoalIsSaidThoughAreasAreNeverKept) {
  const TriangleMesh mesh = makeMeander(kColumns, kRows, 2.1, 3);
  UnfoldOptions options;
  options.areaTolerance = 1e-4;
  options.unfolder.surround = Surround::Fixed;
  UnfoldResult result;
  const auto said = warningsOf(mesh, regionOfMarked(mesh, interiorOf(kColumns, kRows, 4)),
                               visibility::viewpoint(Point(8, 8, 1000)), options, result);
  EXPECT_EQ(result.termination, Termination::Stalled);
  EXPECT_EQ(result.flag, Flag::Held);
  EXPECT_LT(result.history.size(), 200u);
  ASSERT_FALSE(said.empty());
  EXPECT_TRUE(said.back().starts_with("areas are off by")) << said.back();
}

/// The mesh with every `step`-th of the listed faces cut in three, one of them a needle on its
/// first edge.
TriangleMesh withNeedles(TriangleMesh mesh, std::span<const std::int32_t> faces, std::size_t step) {
  for (std::size_t n = 0; n < faces.size(); n += step) {
    const Eigen::Index v = mesh.vertexCount(), f = mesh.faceCount();
    const std::int32_t a = mesh.faces(faces[n], 0), b = mesh.faces(faces[n], 1),
                       c = mesh.faces(faces[n], 2), p = static_cast<std::int32_t>(v);
    const Point place =
        0.4995 * (mesh.positions.row(a) + mesh.positions.row(b)) + 0.001 * mesh.positions.row(c);
    mesh.positions.conservativeResize(v + 1, 3);
    mesh.positions.row(v) = place;
    mesh.faces.conservativeResize(f + 2, 3);
    mesh.faces.row(faces[n]) << a, b, p;
    mesh.faces.row(f) << b, c, p;
    mesh.faces.row(f + 1) << c, a, p;
  }
  return mesh;
}

TEST(Unfold, NeedlesDoNotDecideWhetherAreasAreKept) {
  const Case c;
  const TriangleMesh mesh = withNeedles(c.mesh, c.region.faces, 20);
  std::vector<bool> inside(static_cast<std::size_t>(mesh.vertexCount()), true);
  for (Eigen::Index v = 0; v < c.mesh.vertexCount(); ++v) inside[v] = false;
  for (const std::int32_t v : c.region.vertices) inside[v] = true;
  UnfoldOptions options;
  options.unfolder = with(Surround::None);
  const UnfoldResult result = unfold(mesh, regionOfMarked(mesh, inside), c.view, options);
  const IterationRecord& end = result.history.back();
  EXPECT_EQ(result.termination, Termination::Converged);
  EXPECT_LE(end.areaErrorShare, options.areaTolerance);
  EXPECT_GT(end.areaErrorMean, options.areaTolerance);
}

/// The case's sheet and, at the middle of one of the region's faces, the tip of a small fixed face
/// on each side asked for, `gap` mm off, as pial surfaces have them.
TriangleMesh touched(const Case& c, const std::vector<double>& sides, double gap = 3e-8) {
  const TriangleMesh& sheet = c.mesh;
  const std::int32_t face = c.region.faces[c.region.faces.size() / 2];
  const Point middle = (sheet.corner(face, 0) + sheet.corner(face, 1) + sheet.corner(face, 2)) / 3;
  const Vector up = (sheet.corner(face, 1) - sheet.corner(face, 0))
                        .cross(sheet.corner(face, 2) - sheet.corner(face, 0))
                        .normalized();
  TriangleMesh mesh = sheet;
  for (const double side : sides) {
    const Eigen::Index first = mesh.vertexCount(), last = mesh.faceCount();
    mesh.positions.conservativeResize(first + 3, 3);
    mesh.faces.conservativeResize(last + 1, 3);
    mesh.positions.row(first) = (middle + side * gap * up).transpose();
    mesh.positions.row(first + 1) = (middle + side * 0.05 * up + Vector(0.02, 0, 0)).transpose();
    mesh.positions.row(first + 2) = (middle + side * 0.05 * up + Vector(0, 0.02, 0)).transpose();
    for (int k = 0; k < 3; ++k) mesh.faces(last, k) = static_cast<std::int32_t>(first + k);
  }
  return mesh;
}

TEST(Motion, APairThatAlmostTouchesBlocksAWayTowardsItself) {
  const Case c;
  const TriangleMesh mesh = touched(c, {1});
  const PatchSetup setup = setUpPatch(mesh, c.region, c.view, with(Surround::Fixed));
  const Contacts contacts(setup, with(Surround::Fixed));
  const std::int32_t tip = static_cast<std::int32_t>(c.mesh.vertexCount());
  const Eigen::Index face = c.region.faces[c.region.faces.size() / 2];
  Motion motion;
  motion.by = Positions::Zero(mesh.vertexCount(), 3);
  const Point middle = (mesh.corner(face, 0) + mesh.corner(face, 1) + mesh.corner(face, 2)) / 3;
  for (int k = 0; k < 3; ++k) {
    motion.by.row(mesh.faces(face, k)) = mesh.positions.row(tip) - middle.transpose();
  }
  findSafeStep(contacts, mesh.positions, motion);
  EXPECT_LT(motion.safe, kBlocked);
  EXPECT_GT(motion.safe, 0.1);
}

TEST(Motion, HoweverOftenAPairIsPressedItDoesNotCrossInSinglePrecision) {
  const Case c;
  TriangleMesh mesh = touched(c, {1}, 1e-3);
  mesh.positions.rowwise() += Eigen::RowVector3d(70, -50, 60);
  const PatchSetup setup = setUpPatch(mesh, c.region, c.view, with(Surround::Fixed));
  const Contacts contacts(setup, with(Surround::Fixed));
  const auto tip = static_cast<std::int32_t>(c.mesh.vertexCount());
  const Eigen::Index face = c.region.faces[c.region.faces.size() / 2];
  double gap = 0;
  for (int step = 0; step < 100; ++step) {
    const Point middle = (mesh.corner(face, 0) + mesh.corner(face, 1) + mesh.corner(face, 2)) / 3;
    const Vector way = 2 * (mesh.positions.row(tip).transpose() - middle);
    Motion motion;
    motion.by = Positions::Zero(mesh.vertexCount(), 3);
    for (int k = 0; k < 3; ++k) motion.by.row(mesh.faces(face, k)) = way.transpose();
    findSafeStep(contacts, mesh.positions, motion);
    mesh.positions += motion.safe * motion.by;
    gap = way.norm() * (0.5 - motion.safe);
  }
  EXPECT_GT(gap, 70 * std::numeric_limits<float>::epsilon());
  EXPECT_LT(gap, 1e-4);
  mesh.positions = roundedToSingle(mesh.positions);
  EXPECT_TRUE(geometry::findSelfIntersections(mesh).empty());
}

/// Triangles one over the other, such that the lowest, on its way up by 1, is stopped by the next
/// at a quarter of it, both together by the third at a quarter of theirs, and so on; and one far
/// off.
TriangleMesh stacked(int count) {
  TriangleMesh mesh;
  mesh.positions.resize(3 * count, 3);
  mesh.faces.resize(count, 3);
  double height = 0;
  for (int n = 0; n < count; ++n) {
    const double z = n + 1 < count ? height : 10;
    mesh.positions.middleRows(3 * n, 3) << 0, 0, z, 1, 0, z, 0, 1, z;
    mesh.faces.row(n) << 3 * n, 3 * n + 1, 3 * n + 2;
    height += 0.25 / (n + 1);
  }
  return mesh;
}

TEST(Motion, AJamHoldsUpNothingButItself) {
  const int count = 24;
  const TriangleMesh mesh = stacked(count);
  const Region region = regionOfMarked(mesh, std::vector<bool>(3 * count, true));
  const PatchSetup setup =
      setUpPatch(mesh, region, visibility::viewpoint(Point(0, 0, 1000)), with(Surround::None));
  const Contacts contacts(setup, with(Surround::None));
  Motion motion;
  motion.by = Positions::Zero(mesh.vertexCount(), 3);
  motion.by.topRows(3).col(2).setConstant(1);
  motion.by.bottomRows(3).col(2).setConstant(1);
  const Positions asked = motion.by, gradient = -motion.by;
  findSafeStep(contacts, mesh.positions, motion);
  ASSERT_LT(motion.safe, kBlocked);
  clearWay(contacts, mesh.positions, setup.unknown, gradient, motion);
  EXPECT_GE(motion.safe, kBlocked);
  EXPECT_EQ(motion.by.bottomRows(3), asked.bottomRows(3));
  EXPECT_GT(motion.by(0, 2), 0.2);
  EXPECT_LT(motion.descent, 0);
}

TEST(Unfolder, APairThatStartsInContactHoldsUpNoStep) {
  const Case c;
  // One that can open, and a face held from both sides, which cannot.
  for (const std::vector<double>& sides : {std::vector<double>{1}, std::vector<double>{1, -1}}) {
    const TriangleMesh mesh = touched(c, sides);
    ASSERT_TRUE(geometry::findSelfIntersections(mesh).empty());
    Unfolder unfolder(mesh, c.region, c.view, with(Surround::Fixed));
    const double start = unfolder.record().visibility;
    for (int n = 0; n < 25; ++n) ASSERT_TRUE(unfolder.step()) << n;
    EXPECT_GT(unfolder.record().visibility, start + 0.2) << sides.size();
    EXPECT_TRUE(geometry::findSelfIntersections(unfolder.current()).empty());
  }
}

/// The case's sheet with a hair in place of an inner vertex, as surfaces between two others have
/// them where these touch: rings of its neighbours' number, thinner and thinner, `tip` at the end.
TriangleMesh withHair(const Case& c, std::int32_t tip) {
  constexpr int kRings = 7;
  TriangleMesh mesh = c.mesh;
  const Point root = mesh.positions.row(tip).transpose();
  std::map<std::int32_t, std::int32_t> next;  // around the vertex, and the face there
  std::vector<Eigen::Index> fan;
  Vector up = Vector::Zero();
  for (Eigen::Index f = 0; f < mesh.faceCount(); ++f) {
    for (int k = 0; k < 3; ++k) {
      if (mesh.faces(f, k) != tip) continue;
      next[mesh.faces(f, (k + 1) % 3)] = mesh.faces(f, (k + 2) % 3);
      fan.push_back(f);
      up += (mesh.corner(f, 1) - mesh.corner(f, 0)).cross(mesh.corner(f, 2) - mesh.corner(f, 0));
    }
  }
  std::vector<std::int32_t> below = {next.begin()->first};
  while (below.size() < next.size()) below.push_back(next.at(below.back()));
  const std::vector<std::int32_t> foot = below;
  const auto around = static_cast<int>(foot.size());
  for (int n = 0; n < kRings; ++n) {
    const auto first = static_cast<std::int32_t>(mesh.vertexCount());
    const Eigen::Index faces = mesh.faceCount();
    mesh.positions.conservativeResize(first + around, 3);
    mesh.faces.conservativeResize(faces + 2 * around, 3);
    std::vector<std::int32_t> ring;
    for (int i = 0; i < around; ++i) {
      ring.push_back(first + i);
      const Vector aside = mesh.positions.row(foot[i]).transpose() - root;
      mesh.positions.row(first + i) =
          (root + 0.05 * std::pow(0.4, n) * aside + 0.3 * n * up.normalized()).transpose();
    }
    for (int i = 0; i < around; ++i) {
      const int j = (i + 1) % around;
      mesh.faces.row(faces + 2 * i) << below[i], below[j], ring[j];
      mesh.faces.row(faces + 2 * i + 1) << below[i], ring[j], ring[i];
    }
    below = ring;
  }
  mesh.positions.row(tip) = (root + 0.3 * kRings * up.normalized()).transpose();
  for (int i = 0; i < around; ++i) mesh.faces.row(fan[i]) << tip, below[i], below[(i + 1) % around];
  return mesh;
}

struct Hairy {
  Case bare;
  std::int32_t root = 2 * (kColumns + 1) + kColumns / 2;  ///< in its place, beside the region
  TriangleMesh mesh = withHair(bare, root);
};

TEST(Contacts, AHairStartsFreeOfForces) {
  const Hairy c;
  ASSERT_TRUE(geometry::findSelfIntersections(c.mesh).empty());
  const UnfolderOptions options = with(Surround::Elastic);
  const PatchSetup setup = setUpPatch(c.mesh, c.bare.region, c.bare.view, options);
  Contacts contacts(setup, options);
  // Its end is thinner than 0.002 of an edge: there all is of one piece.
  const Eigen::Index thin = c.bare.mesh.vertexCount() + 4 * 6;
  const auto ofHair = [&](std::int32_t v) { return v == c.root || v >= thin; };
  for (const collision::Contact& contact : contacts.within(c.mesh.positions)) {
    const double distance = std::sqrt(squaredDistance(contact, c.mesh.positions));
    const bool inside = std::all_of(contact.vertices.begin(), contact.vertices.end(), ofHair);
    EXPECT_FALSE(inside && contact.range > 0.01)
        << distance << " to be parted to " << contact.range;
  }
}

TEST(Unfold, AHairOfTheCollarIsNeitherBlownUpNorInTheWay) {
  const Hairy c;
  const UnfoldResult bare = unfold(c.bare.mesh, c.bare.region, c.bare.view);
  const UnfoldResult result = unfold(c.mesh, c.bare.region, c.bare.view);
  const IterationRecord& end = result.history[static_cast<std::size_t>(result.iteration)];
  EXPECT_LE(end.collarStretchMax, kCollarMost);
  EXPECT_NEAR(end.visibility, bare.history.back().visibility, 0.005);
  EXPECT_LT(result.history.size(), 2.5 * static_cast<double>(bare.history.size()));
  EXPECT_TRUE(geometry::findSelfIntersections(result.mesh).empty());
}

TEST(Unfolder, AFlatDiscStaysPut) {
  const TriangleMesh flat = geometry::makeRectangle(12, 12, 12, 12);
  const Region region = regionOfMarked(flat, interiorOf(12, 12, 0));
  // So far away that rays through the disc are parallel to 1e-8.
  Unfolder unfolder(flat, region, visibility::viewpoint(Point(6, 6, 1e9)), with(Surround::None));
  for (int n = 0; n < 5; ++n) unfolder.step();
  EXPECT_LT((unfolder.state().positions - flat.positions).cwiseAbs().maxCoeff(), 1e-6);
  EXPECT_NEAR(unfolder.record().visibility, 1, 1e-9);
}

TEST(Unfolder, ThreadsDoNotChangeAnyBit) {
  const Case c;
  std::vector<Positions> ends;
  for (const int threads : {1, 2, 4}) {
    setThreadCount(threads);
    Unfolder unfolder(c.mesh, c.region, c.view, with(Surround::Fixed));
    for (int n = 0; n < 15; ++n) unfolder.step();
    ends.push_back(unfolder.state().positions);
  }
  setThreadCount(0);
  EXPECT_EQ(ends[0], ends[1]);
  EXPECT_EQ(ends[0], ends[2]);
}

TEST(Unfolder, InstructionSetsDoNotChangeAnyBit) {
  const Case c;
  const auto after = [&] {
    Unfolder unfolder(c.mesh, c.region, c.view, with(Surround::Elastic));
    for (int n = 0; n < 15; ++n) unfolder.step();
    return unfolder.state().positions;
  };
  const Positions widest = after();
  testing::forEachNarrowerInstructionSet(
      [&](std::int64_t target) { EXPECT_EQ(after(), widest) << target; });
}

TEST(ThesisMethod, LosesAreasWithoutTheirProjectionAndIntersectsWithoutRepulsion) {
  const TriangleMesh mesh = makeMeander(kColumns, kRows, 2.1);
  const Region region = regionOfMarked(mesh, interiorOf(kColumns, kRows, 3));
  const auto view = visibility::viewpoint(Point(8, 8, 1000));
  const auto areaErrorAfter = [&](bool keepAreas, bool* intersects) {
    UnfolderOptions options = with(Surround::Fixed);
    options.method = Method::Thesis;
    options.keepAreas = keepAreas;
    Unfolder unfolder(mesh, region, view, options);
    const double before = unfolder.record().visibility;
    for (int n = 0; n < 120; ++n) unfolder.step();
    EXPECT_GT(unfolder.record().visibility, before + 0.1);
    if (intersects) *intersects = !geometry::findSelfIntersections(unfolder.current()).empty();
    return measureDistortion(mesh, unfolder.state().positions, region.faces).areaErrorMean;
  };
  bool intersects = false;
  EXPECT_LT(areaErrorAfter(true, &intersects), 0.05);
  EXPECT_TRUE(intersects);                          // [Thesis, Fig. 4.20] in three dimensions
  EXPECT_GT(areaErrorAfter(false, nullptr), 0.15);  // [Thesis, Fig. 4.19]
}

TEST(ThesisMethod, TheKnotEnergyPushesApart) {
  // Erratum 3 of Eq. 5.46: its sign as printed would pull the folds together.
  const TriangleMesh mesh = makeMeander(24, 6, 2.1, 1);
  const Region region = regionOfMarked(mesh, interiorOf(24, 6, 1));
  std::array<double, 3> ends{};
  for (const int sign : {-1, 0, 1}) {  // as printed, hardly there, as it has to be
    UnfolderOptions options = with(Surround::None);
    options.method = Method::Thesis;
    options.knot = repulsion::KnotMethod::Tree;
    options.weights[Term::Knot] = sign == 0 ? 1e-12 : 0.05 * sign;
    Unfolder unfolder(mesh, region, visibility::viewpoint(Point(8, 3, 1000)), options);
    for (int n = 0; n < 5; ++n) ASSERT_TRUE(unfolder.step());
    ends[sign + 1] = unfolder.record().energies[Term::Knot] / options.weights[Term::Knot];
  }
  EXPECT_LT(ends[2], ends[1]);
  EXPECT_LT(ends[1], ends[0]);
}

TEST(Unfolder, KnotEnergyMayTakePart) {
  const TriangleMesh mesh = makeMeander(24, 6, 2.1, 1);
  UnfolderOptions options = with(Surround::None);
  options.knot = repulsion::KnotMethod::AllPairs;
  Unfolder unfolder(mesh, regionOfMarked(mesh, interiorOf(24, 6, 1)),
                    visibility::viewpoint(Point(8, 3, 1000)), options);
  for (int n = 0; n < 2; ++n) {
    ASSERT_TRUE(unfolder.step());
    EXPECT_LE(unfolder.record().objectiveAfter, unfolder.record().objectiveBefore);
  }
  EXPECT_GT(unfolder.record().energies[Term::Knot], 0);
}

TEST(Unfold, ResumedRunsEqualUninterruptedOnesToTheLastBit) {
  const Case c;
  UnfoldOptions options;
  options.maxIterations = 24;
  options.frames = 5;
  const UnfoldResult whole = unfold(c.mesh, c.region, c.view, options);
  options.maxIterations = 11;
  const UnfoldResult part = unfold(c.mesh, c.region, c.view, options);
  EXPECT_EQ(part.termination, Termination::MaxIterations);
  const auto path = std::filesystem::temp_directory_path() / "explica-checkpoint-test.state";
  writeCheckpoint(path, part.checkpoint);
  const Checkpoint read = readCheckpoint(path);
  options.maxIterations = 24;
  const UnfoldResult rest = unfold(c.mesh, c.region, c.view, options, {}, &read);
  EXPECT_EQ(whole.mesh.positions, rest.mesh.positions);
  EXPECT_EQ(whole.checkpoint.state.multipliers, rest.checkpoint.state.multipliers);
  ASSERT_EQ(whole.history.size(), rest.history.size());
  for (std::size_t n = 0; n < whole.history.size(); ++n) {
    EXPECT_EQ(whole.history[n].objectiveAfter, rest.history[n].objectiveAfter) << n;
  }
  ASSERT_EQ(whole.frames.size(), rest.frames.size());
  for (std::size_t n = 0; n < whole.frames.size(); ++n) {
    EXPECT_EQ(whole.frames[n].positions, rest.frames[n].positions);
  }

  std::filesystem::resize_file(path, std::filesystem::file_size(path) - 5);
  EXPECT_THROW((void)readCheckpoint(path), IOError);
  std::filesystem::remove(path);
  EXPECT_THROW((void)readCheckpoint(path), IOError);
}

TEST(Unfold, FramesAreEvenlySpacedInVisibilityAndFreeOfIntersections) {
  const Case c;
  UnfoldOptions options;
  options.frames = 9;
  options.targetVisibility = 0.8;
  options.areaTolerance = 1;
  const UnfoldResult result = unfold(c.mesh, c.region, c.view, options);
  ASSERT_EQ(result.frames.size(), 9u);
  const double step = (result.frames[8].visibility - result.frames[0].visibility) / 8;
  for (int n = 1; n < 9; ++n) {
    EXPECT_NEAR(result.frames[n].visibility - result.frames[n - 1].visibility, step, 1e-4);
    EXPECT_TRUE(
        geometry::findSelfIntersections({result.frames[n].positions, result.mesh.faces}).empty());
  }
  EXPECT_EQ(result.frames[0].positions, c.mesh.positions);
  EXPECT_EQ(result.frames[8].positions, result.mesh.positions);
}

TEST(Unfold, StopsWhenAskedAndSaysSo) {
  const Case c;
  int calls = 0;
  Monitor monitor;
  monitor.stopWanted = [&] { return ++calls > 4; };
  const UnfoldResult stopped = unfold(c.mesh, c.region, c.view, {}, monitor);
  EXPECT_EQ(stopped.termination, Termination::Interrupted);
  EXPECT_EQ(stopped.history.back().iteration, 4);
}

TEST(Unfold, RefusesWhatItCannotUnfold) {
  const Case c;
  const auto below = visibility::viewpoint(Point(8, 8, -1000));
  EXPECT_THROW((void)unfold(c.mesh, c.region, below), InvalidInput);
  UnfoldOptions bad;
  bad.maxIterations = 0;
  EXPECT_THROW((void)unfold(c.mesh, c.region, c.view, bad), InvalidInput);
  bad = {};
  bad.targetVisibility = 1.5;
  EXPECT_THROW((void)unfold(c.mesh, c.region, c.view, bad), InvalidInput);
  TriangleMesh needle = c.mesh;
  needle.positions.row(needle.faces(c.region.faces[0], 1)) =
      needle.positions.row(needle.faces(c.region.faces[0], 0));
  EXPECT_THROW((void)Unfolder(needle, c.region, c.view), InvalidInput);
}

}  // namespace
}  // namespace explica::unfolding
