// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "../src/Guide.h"
#include "../src/PatchSetup.h"
#include "../src/Room.h"
#include "Meander.h"

#include "Explica/Geometry/Fixtures.h"
#include "Explica/Geometry/SelfIntersection.h"
#include "Explica/Testing/Meshes.h"
#include "Explica/Unfolding/Unfold.h"
#include "Explica/Visibility/VisibleFraction.h"

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include <numeric>

namespace explica::unfolding {
namespace {

Region wholeOf(const TriangleMesh& mesh) {
  return regionOfMarked(mesh,
                        std::vector<bool>(static_cast<std::size_t>(mesh.vertexCount()), true));
}

UnfolderOptions guidedFrom(int faces) {
  UnfolderOptions options;
  options.surround = Surround::None;
  options.guideFaces = faces;
  return options;
}

/// A flat ribbon wound once and a tenth about the z axis: from above, all of it looks up, and one
/// end hides the other.
TriangleMesh makeRamp() {
  constexpr int kAlong = 60, kAcross = 4;
  TriangleMesh mesh = geometry::makeRectangle(kAlong, kAcross, kAlong, kAcross);
  for (Eigen::Index v = 0; v < mesh.vertexCount(); ++v) {
    const double angle = 2.2 * kPi * mesh.positions(v, 0) / kAlong;
    const double radius = 12 - mesh.positions(v, 1);
    mesh.positions.row(v) << radius * std::cos(angle), radius * std::sin(angle), 0.6 * angle;
  }
  return mesh;
}

/// Share of a surface that is seen from above.
double seen(const TriangleMesh& mesh) {
  return visibility::visibleFraction(mesh, visibility::viewpoint(Point(0, 0, 1e4))).total;
}

TEST(Guide, IsTheRegionItselfWhereThatIsFlatWhateverWayItIsTurned) {
  const Eigen::Matrix3d turn = Eigen::Quaterniond(0.3, -0.5, 0.7, 0.2).normalized().matrix();
  TriangleMesh mesh = geometry::makeRectangle(24, 16, 24, 16);
  mesh.positions = (mesh.positions * turn.transpose()).eval();
  mesh.positions.rowwise() += Eigen::RowVector3d(30, -10, 5);
  const Region region = wholeOf(mesh);
  const Vector axis = turn.col(2);
  const auto view = visibility::viewpoint(mesh.positions.colwise().mean().transpose() + 1e6 * axis);
  const PatchGuide guide = makeGuide(mesh, region, findRoom(mesh, region, view));
  ASSERT_EQ(guide.vertices.size(), static_cast<std::size_t>(mesh.vertexCount()));
  const Eigen::Matrix3d across = Eigen::Matrix3d::Identity() - axis * axis.transpose();
  const Positions standing = mesh.positions(guide.vertices, Eigen::all) * across;
  // The map is made on some of the vertices and not lowered to the last digit.
  EXPECT_LT((guide.places - standing).rowwise().norm().maxCoeff(), 0.02 * guide.radius);
  const auto sum = std::accumulate(guide.weights.begin(), guide.weights.end(), 0.0);
  EXPECT_NEAR(sum, 24 * 16, 1e-9);
}

TEST(Guide, ThereIsNoneWhereNoFlatMapIs) {
  const TriangleMesh sphere = geometry::makeIcosphere(2, 5);
  Region region;
  region.faces.resize(static_cast<std::size_t>(sphere.faceCount()));
  std::iota(region.faces.begin(), region.faces.end(), 0);
  PatchRoom room;
  room.height = 6;
  room.radius = 5;
  EXPECT_TRUE(makeGuide(sphere, region, room).vertices.empty());
  const TriangleMesh flat = geometry::makeRectangle(4, 4, 4, 4);
  room.height = -kInfinity;  // looked at from all sides
  EXPECT_TRUE(makeGuide(flat, wholeOf(flat), room).vertices.empty());
}

TEST(Guide, LargeRegionsAloneHaveOne) {
  const TriangleMesh mesh = makeMeander(24, 8);
  const Region region = wholeOf(mesh);
  const auto view = visibility::viewpoint(Point(8, 8, 1000));
  const auto guided = [&](const UnfolderOptions& options) {
    return !setUpPatch(mesh, region, view, options).patch.guide.vertices.empty();
  };
  const auto faces = static_cast<int>(mesh.faceCount());
  EXPECT_TRUE(guided(guidedFrom(faces)));
  EXPECT_FALSE(guided(guidedFrom(faces + 1)));
  UnfolderOptions options = guidedFrom(0);
  options.surround = Surround::Elastic;
  EXPECT_FALSE(guided(options));
  options = guidedFrom(0);
  options.weights[Term::Guide] = 0;
  EXPECT_FALSE(guided(options));
}

TEST(Guide, BringsOutWhatLiesOverOneAnother) {
  const TriangleMesh ramp = makeRamp();
  ASSERT_LT(seen(ramp), 0.95);
  const auto after = [&](int guideFaces) {
    Unfolder unfolder(ramp, wholeOf(ramp), visibility::viewpoint(Point(0, 0, 1e4)),
                      guidedFrom(guideFaces));
    for (int n = 0; n < 60; ++n) {
      if (!unfolder.step()) break;
    }
    EXPECT_TRUE(geometry::findSelfIntersections(unfolder.current()).empty());
    EXPECT_LT(unfolder.record().areaErrorMean, 0.02);
    return seen(unfolder.current());
  };
  EXPECT_LT(after(1000000), 0.95);  // every face looks up: nothing else tells
  EXPECT_GT(after(0), 0.995);
}

TEST(Guide, AGuidedRunGoesOnToTheLastBit) {
  const TriangleMesh mesh = makeMeander(24, 8);
  const Region region = wholeOf(mesh);
  const auto view = visibility::viewpoint(Point(8, 8, 1000));
  UnfoldOptions options;
  options.unfolder = guidedFrom(0);
  options.maxIterations = 16;
  const UnfoldResult whole = unfold(mesh, region, view, options);
  EXPECT_GT(whole.history[1].energies[Term::Guide], 0);
  options.maxIterations = 7;
  const UnfoldResult part = unfold(mesh, region, view, options);
  options.maxIterations = 16;
  const UnfoldResult rest = unfold(mesh, region, view, options, {}, &part.checkpoint);
  EXPECT_EQ(whole.mesh.positions, rest.mesh.positions);
}

TEST(Guide, IsLaidAnewWhereTheViewpointMoves) {
  const TriangleMesh mesh = makeMeander(24, 8);
  const Region region = wholeOf(mesh);
  PatchRoom room = findRoom(mesh, region, visibility::viewpoint(Point(8, 8, 1000)));
  const PatchGuide first = makeGuide(mesh, region, room);
  room = findRoom(mesh, region, visibility::viewpoint(Point(500, 8, 900)));
  PatchGuide moved = first;
  layGuide(mesh, room, moved);
  EXPECT_EQ(moved.places, makeGuide(mesh, region, room).places);
  EXPECT_LT((moved.places * room.axis).norm(), 1e-9 * moved.places.norm());
  EXPECT_GT((moved.places - first.places).norm(), 1);
}

}  // namespace
}  // namespace explica::unfolding
