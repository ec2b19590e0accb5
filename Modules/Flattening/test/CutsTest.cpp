// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Flattening/Cuts.h"

#include "Explica/Core/Errors.h"
#include "Explica/Core/Parallel.h"
#include "Explica/Flattening/Flatten.h"
#include "Explica/Flattening/FoldDepth.h"
#include "Explica/Flattening/State.h"
#include "Explica/Geometry/Fixtures.h"
#include "Explica/Geometry/MeshMeasures.h"
#include "Explica/Geometry/MeshTopology.h"
#include "Explica/Geometry/SelfIntersection.h"
#include "Explica/Testing/Meshes.h"

#include <gtest/gtest.h>

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numeric>
#include <string>

namespace explica::flattening {
namespace {

/// A sphere about the origin, bent inwards along great half-circles through the poles: sulci at
/// known longitudes.
TriangleMesh sphereWithSulci(int levels, int sulci, double depth) {
  TriangleMesh mesh = geometry::makeIcosphere(levels, 30);
  for (Eigen::Index v = 0; v < mesh.vertexCount(); ++v) {
    const Point p = mesh.positions.row(v);
    const double longitude = std::atan2(p.y(), p.x());
    const double across = std::sin(longitude * sulci / 2.0) * std::hypot(p.x(), p.y()) / 30;
    mesh.positions.row(v) *= 1 - depth * std::exp(-across * across / 0.02);
  }
  return mesh;
}

/// Everything but the south pole's surroundings.
Disc withoutSouth(const TriangleMesh& mesh, double height = -26) {
  std::vector<bool> cortex(static_cast<std::size_t>(mesh.vertexCount()));
  for (Eigen::Index v = 0; v < mesh.vertexCount(); ++v) {
    cortex[v] = mesh.positions(v, 2) > height;
  }
  return discOf(mesh, facesWithoutWall(mesh, cortex));
}

Eigen::VectorXd depthOf(const TriangleMesh& mesh, const Disc& disc) {
  const Eigen::VectorXd whole = foldDepth(mesh);
  Eigen::VectorXd depth(disc.mesh.vertexCount());
  for (Eigen::Index v = 0; v < depth.size(); ++v) depth[v] = whole[disc.vertexOrigin[v]];
  return depth;
}

std::vector<CutPath> pathsOf(const CutPlan& plan) {
  std::vector<CutPath> paths;
  for (const Cut& cut : plan.cuts) paths.push_back(cut.path);
  return paths;
}

TEST(Opening, ACutDoublesItsVerticesButTheInnerEnd) {
  const Disc disc = withoutSouth(geometry::makeIcosphere(4, 30));
  const auto topology = geometry::buildTopology(disc.mesh.faces, disc.mesh.vertexCount());
  CutPath path = {disc.rim.front()};
  while (path.size() < 6) {  // upwards
    const auto near = topology.vertexVertices[path.back()];
    path.push_back(*std::max_element(near.begin(), near.end(), [&](auto a, auto b) {
      return disc.mesh.positions(a, 2) < disc.mesh.positions(b, 2);
    }));
  }
  const Disc opened = openedAlong(disc, std::vector<CutPath>{path});
  EXPECT_EQ(opened.mesh.vertexCount(), disc.mesh.vertexCount() + 5);
  EXPECT_EQ(opened.mesh.faceCount(), disc.mesh.faceCount());
  EXPECT_EQ(opened.rim.size(), disc.rim.size() + 10);
  EXPECT_TRUE(opened.holes.empty());
  EXPECT_TRUE(geometry::inspectMesh(opened.mesh).manifold());
  EXPECT_EQ(geometry::faceAreas(opened.mesh), geometry::faceAreas(disc.mesh));
  const auto second = secondCopies(opened);
  EXPECT_EQ(std::count(second.begin(), second.end(), true), 5);
}

TEST(Opening, ABranchedCutMakesThreeOfTheVertexWhereItBranches) {
  const Disc disc = discOf(geometry::makeRectangle(6, 6, 6, 6), [] {
    std::vector<std::int32_t> all(72);
    std::iota(all.begin(), all.end(), 0);
    return all;
  }());
  const auto at = [](int column, int row) { return row * 7 + column; };
  const CutPath trunk = {at(0, 3), at(1, 3), at(2, 3), at(3, 3), at(4, 3)};
  const CutPath branch = {at(2, 3), at(2, 2), at(2, 1)};
  const Disc opened = openedAlong(disc, std::vector<CutPath>{trunk, branch});
  EXPECT_EQ(opened.mesh.vertexCount(), disc.mesh.vertexCount() + 4 + 1 + 1);
  EXPECT_TRUE(geometry::inspectMesh(opened.mesh).manifold());
  EXPECT_TRUE(opened.holes.empty());
}

TEST(Opening, RefusesWhatIsNoPathOrTakesTheDiscApart) {
  const Disc disc = discOf(geometry::makeRectangle(4, 4, 4, 4), [] {
    std::vector<std::int32_t> all(32);
    std::iota(all.begin(), all.end(), 0);
    return all;
  }());
  EXPECT_THROW((void)openedAlong(disc, std::vector<CutPath>{{0, 12}}), InvalidInput);
  EXPECT_THROW((void)openedAlong(disc, std::vector<CutPath>{{10, 11, 12, 13, 14}}), InvalidInput);
}

TEST(MedialWall, IsTheLargestPartOffTheCortexAndWhatItEncloses) {
  const TriangleMesh mesh = geometry::makeIcosphere(4, 30);
  std::vector<bool> cortex(static_cast<std::size_t>(mesh.vertexCount()));
  for (Eigen::Index v = 0; v < mesh.vertexCount(); ++v) {
    const Point p = mesh.positions.row(v);
    const bool ring = p.z() < -20 && p.z() > -29;        // an island stays within it
    const bool spot = (p - Point(30, 0, 0)).norm() < 5;  // no wall
    cortex[v] = !ring && !spot;
  }
  const Disc disc = discOf(mesh, facesWithoutWall(mesh, cortex));
  EXPECT_TRUE(disc.holes.empty());
  EXPECT_GT(disc.mesh.positions.col(2).minCoeff(), -22);
  EXPECT_GT(disc.mesh.positions.col(0).maxCoeff(), 29.5);
  EXPECT_THROW((void)facesWithoutWall(mesh, std::vector<bool>(cortex.size(), true)), InvalidInput);
  EXPECT_THROW((void)facesWithoutWall(mesh, std::vector<bool>(cortex.size(), false)), InvalidInput);
}

TEST(FoldDepth, IsPositiveInSulciAndTheSameAtAnyScaleAndPlace) {
  const TriangleMesh mesh = sphereWithSulci(5, 4, 0.15);
  const Eigen::VectorXd depth = foldDepth(mesh);
  const double equator = 30;
  for (Eigen::Index v = 0; v < mesh.vertexCount(); ++v) {
    const Point p = mesh.positions.row(v);
    if (std::abs(p.z()) > 10) continue;
    const double off = std::abs(std::remainder(std::atan2(p.y(), p.x()), kPi / 2)) * equator;
    if (off < 1) {
      EXPECT_GT(depth[v], 1);
    } else if (off > 12) {
      EXPECT_LT(depth[v], 0.5);
    }
  }
  TriangleMesh moved = mesh;
  moved.positions = (mesh.positions * 0.125).eval();
  moved.positions.rowwise() += Eigen::RowVector3d(1000, -2000, 500);
  EXPECT_LT((foldDepth(moved) - depth).cwiseAbs().maxCoeff(), 1e-2);
}

TEST(FlattestPlace, IsTheLevelOne) {
  TriangleMesh mesh = geometry::makeFoldedSphere(5, 30, 0.2, 6);
  for (Eigen::Index v = 0; v < mesh.vertexCount(); ++v) {
    mesh.positions(v, 2) = std::max(mesh.positions(v, 2), -22.0);
  }
  const auto place = flattestPlace(mesh);
  const Eigen::VectorXd areas = geometry::vertexAreas(mesh);
  double inside = 0, all = 0;
  for (Eigen::Index v = 0; v < mesh.vertexCount(); ++v) {
    if (!place[v]) continue;
    all += areas[v];
    if (mesh.positions(v, 2) < -21.9) inside += areas[v];
  }
  EXPECT_NEAR(all, 0.025 * areas.sum(), 0.002 * areas.sum());
  EXPECT_GT(inside, 0.9 * all);
}

TEST(Cuts, RunAlongSulciAndReachTheStrainAskedFor) {
  const TriangleMesh mesh = sphereWithSulci(5, 4, 0.12);
  const Disc disc = withoutSouth(mesh);
  const Eigen::VectorXd depth = depthOf(mesh, disc);
  CutOptions options;
  options.edgeStrain = 0.12;
  const CutPlan plan = findCuts(disc, depth, options);
  ASSERT_GE(plan.cuts.size(), 1U);
  EXPECT_GT(plan.strainBefore, 0.2);
  EXPECT_LE(plan.edgeStrain, options.edgeStrain);
  for (const Cut& cut : plan.cuts) EXPECT_GT(cut.depth, 1);  // in sulci, a quarter of the area
  const Disc opened = openedAlong(disc, pathsOf(plan));
  EXPECT_TRUE(opened.holes.empty());
  FlattenOptions flat;
  flat.areaTolerance = 0.05;
  const FlatMap map = flatten(opened, flat);
  EXPECT_EQ(map.turnedOver, 0);
  EXPECT_EQ(map.rimCrossings, 0);
  TriangleMesh laid{Positions::Zero(opened.mesh.vertexCount(), 3), opened.mesh.faces};
  laid.positions.leftCols<2>() = map.positions;
  EXPECT_TRUE(geometry::findSelfIntersections(laid).empty());
}

TEST(Cuts, GoToTheFarPoleOfASphereByAMeridian) {
  const Disc disc = withoutSouth(geometry::makeIcosphere(5, 30));
  CutOptions options;
  options.edgeStrain = 0.001;
  options.most = 1;
  const CutPlan plan = findCuts(disc, Eigen::VectorXd::Zero(disc.mesh.vertexCount()), options);
  ASSERT_EQ(plan.cuts.size(), 1U);
  EXPECT_GT(disc.mesh.positions(plan.cuts[0].path.back(), 2), 29);
  // From 26 below the equator to the pole; along edges the way is up to a sixth longer.
  const double meridian = 30 * (kPi / 2 + std::asin(26.0 / 30));
  EXPECT_GT(plan.cuts[0].length, 0.95 * meridian);
  EXPECT_LT(plan.cuts[0].length, 1.16 * meridian);
  EXPECT_LT(plan.edgeStrain, 0.8 * plan.strainBefore);
}

TEST(Cuts, ThereAreNoneWhereNoneAreNeeded) {
  const Disc disc = withoutSouth(geometry::makeIcosphere(4, 30), 10);
  EXPECT_TRUE(findCuts(disc, Eigen::VectorXd::Zero(disc.mesh.vertexCount())).cuts.empty());
  CutOptions none;
  none.most = 0;
  const Disc sphere = withoutSouth(geometry::makeIcosphere(4, 30));
  EXPECT_TRUE(
      findCuts(sphere, Eigen::VectorXd::Zero(sphere.mesh.vertexCount()), none).cuts.empty());
}

TEST(Cuts, AreTheSameForAnyNumberOfThreadsAndAtAnyScale) {
  const TriangleMesh mesh = sphereWithSulci(5, 5, 0.12);
  TriangleMesh small = mesh;
  small.positions /= 64;
  const Disc disc = withoutSouth(mesh), tiny = withoutSouth(small, -26.0 / 64);
  const int before = threadCount();
  setThreadCount(1);
  const CutPlan one = findCuts(disc, depthOf(mesh, disc));
  setThreadCount(3);
  const CutPlan three = findCuts(disc, depthOf(mesh, disc));
  const CutPlan scaled = findCuts(tiny, depthOf(small, tiny));
  setThreadCount(before);
  EXPECT_EQ(pathsOf(one), pathsOf(three));
  EXPECT_EQ(pathsOf(one), pathsOf(scaled));
}

TEST(Cuts, RefuseOptionsOutOfRangeAndDepthsOfAnotherSurface) {
  const Disc disc = withoutSouth(geometry::makeIcosphere(3, 30));
  CutOptions options;
  options.edgeStrain = 0;
  const Eigen::VectorXd depth = Eigen::VectorXd::Zero(disc.mesh.vertexCount());
  EXPECT_THROW((void)findCuts(disc, depth, options), InvalidInput);
  EXPECT_THROW((void)findCuts(disc, depth.head(3)), InvalidInput);
}

TEST(Cuts, ASearchThatWasStoppedGoesOnToTheSameCuts) {
  const TriangleMesh mesh = sphereWithSulci(3, 5, 0.2);
  const Disc disc = withoutSouth(mesh);
  const Eigen::VectorXd depth = depthOf(mesh, disc);
  CutOptions options;
  options.edgeStrain = 0.1;
  int questions = 0;
  Monitor counting;
  counting.stopWanted = [&] { return ++questions < 0; };
  const CutPlan whole = findCuts(disc, depth, options, counting);
  ASSERT_EQ(whole.termination, Termination::TargetReached);
  ASSERT_GT(whole.cuts.size(), 1U);
  for (int n = 0; n < 3; ++n) {
    int asked = 0;
    Monitor stopping;
    stopping.stopWanted = [&] { return ++asked > n * questions / 3; };
    const CutPlan stopped = findCuts(disc, depth, options, stopping);
    EXPECT_EQ(stopped.termination, Termination::Interrupted);
    EXPECT_LE(stopped.cuts.size(), whole.cuts.size());
    EXPECT_NO_THROW((void)openedAlong(disc, pathsOf(stopped)));
    const CutPlan resumed = findCuts(disc, depth, options, {}, &stopped);
    EXPECT_EQ(resumed.termination, Termination::TargetReached);
    EXPECT_EQ(pathsOf(resumed), pathsOf(whole)) << n;
    EXPECT_EQ(resumed.strainBefore, whole.strainBefore);
    EXPECT_EQ(resumed.edgeStrain, whole.edgeStrain);
  }
}

/// Largest distance of a point of one set from the other.
double hausdorff(const Positions& a, const Positions& b) {
  double largest = 0;
  for (const auto& [from, to] : {std::pair{&a, &b}, std::pair{&b, &a}}) {
    for (Eigen::Index v = 0; v < from->rows(); ++v) {
      largest = std::max(largest, (to->rowwise() - from->row(v)).rowwise().norm().minCoeff());
    }
  }
  return largest;
}

// Two surfaces of other folds and vertices, one of them turned: their own cuts go to other places.
TEST(TemplateCuts, LieInTheSamePlacesOnSurfacesOfOtherFoldsAndVertices) {
  const TriangleMesh sphere = geometry::makeIcosphere(4);
  VertexKeys keys = VertexKeys::Zero(sphere.vertexCount());
  for (Eigen::Index v = 0; v < keys.size(); ++v) {
    const Point p = sphere.positions.row(v);
    if (std::abs(p.y()) < 0.06 && p.x() > 0.3) keys[v] = 2;                        // a meridian
    if (std::abs(p.z() - 0.2) < 0.06 && p.y() > 0.06 && p.x() > 0.3) keys[v] = 3;  // off it
    if (p.z() < -26.0 / 30) keys[v] = 1;
  }
  const auto lines = cutLines(sphere, keys, {{1, "wall"}, {2, "trunk"}, {3, "branch"}});
  ASSERT_EQ(lines.size(), 2U);
  EXPECT_GT(lines[0].points.bottomRows<1>()(2), 0.8);
  for (const auto& [levels, sulci, depth] : {std::tuple{5, 4, 0.12}, std::tuple{4, 7, 0.2}}) {
    const TriangleMesh mesh = sphereWithSulci(levels, sulci, depth);
    const Disc disc = withoutSouth(mesh);
    const Positions places = disc.mesh.positions.rowwise().normalized();
    const CutPlan plan = cutsAlong(disc, places, lines, depthOf(mesh, disc));
    ASSERT_EQ(plan.cuts.size(), 2U);
    for (std::size_t n = 0; n < 2; ++n) {
      const Positions along = places(plan.cuts[n].path, Eigen::all);
      EXPECT_EQ(plan.cuts[n].name, lines[n].name);
      EXPECT_LT(hausdorff(along, lines[n].points),
                0.15);  // half the line's width and an edge of the coarser
    }
    const Disc opened = openedAlong(disc, pathsOf(plan));
    EXPECT_TRUE(opened.holes.empty());
    EXPECT_TRUE(geometry::inspectMesh(opened.mesh).manifold());
  }
  keys = (keys.array() == 1).select(0, keys);
  EXPECT_THROW((void)cutLines(sphere, keys, {{2, "trunk"}}), InvalidInput);
}

TEST(Checkpoint, GivesBackCutsAndMap) {
  const TriangleMesh mesh = sphereWithSulci(4, 5, 0.2);
  const Disc disc = withoutSouth(mesh);
  Checkpoint kept;
  kept.uncut = sumOver(disc);
  kept.cuts = findCuts(disc, depthOf(mesh, disc));
  FlattenOptions options;
  options.frames = 2;
  Monitor atOnce;
  atOnce.stopWanted = [] { return true; };
  kept.map = flatten(openedAlong(disc, pathsOf(*kept.cuts)), options, atOnce).state;
  const auto path = std::filesystem::temp_directory_path() /
                    ("explica-flat-" + std::to_string(::getpid()) + ".state");
  writeCheckpoint(path, kept);
  const Checkpoint read = readCheckpoint(path);
  std::filesystem::remove(path);
  EXPECT_EQ(read.uncut, kept.uncut);
  ASSERT_TRUE(read.cuts);
  EXPECT_EQ(pathsOf(*read.cuts), pathsOf(*kept.cuts));
  EXPECT_EQ(read.cuts->found, kept.cuts->found);
  EXPECT_EQ(read.cuts->termination, kept.cuts->termination);
  EXPECT_EQ(read.map.disc, kept.map.disc);
  EXPECT_EQ(read.map.level, kept.map.level);
  EXPECT_EQ(read.map.positions, kept.map.positions);
  ASSERT_EQ(read.map.path.size(), kept.map.path.size());
  EXPECT_EQ(read.map.path.back().positions, kept.map.path.back().positions);
}

}  // namespace
}  // namespace explica::flattening
