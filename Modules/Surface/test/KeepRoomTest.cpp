// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "../src/KeepRoom.h"

#include "../src/MoveTogether.h"
#include "Explica/Geometry/Fixtures.h"
#include "Explica/Geometry/MeshMeasures.h"
#include "Explica/Geometry/MeshTopology.h"
#include "Explica/Geometry/SelfIntersection.h"
#include "Explica/Testing/Meshes.h"
#include "NearestToItself.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace explica::surface {
namespace {

TriangleMesh stored(TriangleMesh mesh) {
  for (Eigen::Index v = 0; v < mesh.vertexCount(); ++v) {
    mesh.positions.row(v) = asStored(mesh.positions.row(v));
  }
  return mesh;
}

/// Two waving sheets of n x n vertices, 1 mm apart, `between` mm from each other.
TriangleMesh banks(int n, double between) {
  TriangleMesh lower = geometry::makeRectangle(n - 1, n - 1, n - 1, n - 1), upper = lower;
  for (Eigen::Index v = 0; v < lower.vertexCount(); ++v) {
    const double height = 0.3 * std::sin(lower.positions(v, 0) + 0.5 * lower.positions(v, 1));
    lower.positions(v, 2) = height;
    upper.positions(v, 2) = height + between;
  }
  return stored(geometry::joined(lower, upper));
}

/// A closed thread along z, `sides` vertices around it, with caps.
TriangleMesh thread(int sides, int rings, double radius, double spacing) {
  TriangleMesh mesh;
  mesh.positions.resize(sides * rings + 2, 3);
  mesh.faces.resize(2 * sides * rings, 3);
  Eigen::Index f = 0;
  for (int r = 0; r < rings; ++r) {
    for (int s = 0; s < sides; ++s) {
      const double angle = 2 * std::numbers::pi * s / sides;
      mesh.positions.row(r * sides + s) << radius * std::cos(angle), radius * std::sin(angle),
          r * spacing;
      const int next = (s + 1) % sides, at = r * sides;
      if (r + 1 == rings) continue;
      mesh.faces.row(f++) << at + s, at + next, at + sides + s;
      mesh.faces.row(f++) << at + next, at + sides + next, at + sides + s;
    }
  }
  const int bottom = sides * rings, top = bottom + 1;
  mesh.positions.row(bottom) << 0, 0, -spacing;
  mesh.positions.row(top) << 0, 0, rings * spacing;
  for (int s = 0; s < sides; ++s) {
    const int next = (s + 1) % sides, last = (rings - 1) * sides;
    mesh.faces.row(f++) << bottom, next, s;
    mesh.faces.row(f++) << top, last + s, last + next;
  }
  return stored(mesh);
}

double farthestMove(const TriangleMesh& a, const TriangleMesh& b) {
  return (a.positions - b.positions).rowwise().norm().maxCoeff();
}

TEST(KeepRoom, BanksThatAlmostTouchPartByTheGap) {
  constexpr double kGap = 0.05;
  for (const double between : {1e-4, 0.01, 0.04}) {
    const TriangleMesh before = banks(16, between);
    TriangleMesh mesh = before;
    const Cramped left = keepRoom(mesh, {kGap, 0});
    EXPECT_EQ(left.pairs, 0) << between;
    EXPECT_GE(nearestToItself(mesh), kGap) << between;
    EXPECT_LE(farthestMove(mesh, before), 1.01 * kGap) << between;
    EXPECT_TRUE(geometry::findSelfIntersections(mesh).empty());
    EXPECT_EQ(mesh.faces, before.faces);
  }
}

TEST(KeepRoom, AThinThreadGetsFacesOfTheLeastArea) {
  constexpr double kLeast = 0.02;
  for (const int sides : {3, 4, 6}) {
    TriangleMesh mesh = thread(sides, 12, 0.06, 0.2);
    ASSERT_TRUE(geometry::inspectMesh(mesh).closedManifold());
    ASSERT_GT(geometry::enclosedVolume(mesh), 0);
    ASSERT_LT(geometry::faceAreas(mesh).minCoeff(), kLeast);
    const Cramped left = keepRoom(mesh, {0.02, kLeast});
    EXPECT_EQ(left.faces, 0) << sides;
    EXPECT_EQ(left.pairs, 0) << sides;
    EXPECT_GE(geometry::faceAreas(mesh).minCoeff(), kLeast) << sides;
    EXPECT_TRUE(geometry::findSelfIntersections(mesh).empty());
  }
}

TEST(KeepRoom, WhatHasRoomStaysToTheBit) {
  const TriangleMesh before =
      stored(geometry::joined(geometry::makeIcosphere(3, 10), geometry::makeIcosphere(3, 10.2)));
  TriangleMesh mesh = before;
  const Cramped left = keepRoom(mesh, {0.05, 0.02});
  EXPECT_EQ(left.pairs + left.faces, 0);
  EXPECT_EQ(mesh.positions, before.positions);
}

}  // namespace
}  // namespace explica::surface
