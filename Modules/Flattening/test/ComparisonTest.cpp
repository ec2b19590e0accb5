// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Flattening/Comparison.h"

#include "Explica/Flattening/PatchTable.h"
#include "Explica/Flattening/Seen.h"
#include "Explica/Geometry/Fixtures.h"
#include "Explica/Testing/Meshes.h"
#include "Explica/Testing/Selections.h"

#include <gtest/gtest.h>

#include <cmath>

namespace explica::flattening {
namespace {

using testing::everyFace;

TEST(DistancePairs, AreGreatCirclesOnASphere) {
  const double radius = 20;
  const TriangleMesh sphere = geometry::makeIcosphere(5, radius);
  DistanceOptions options;
  options.sources = 10;
  options.pairs = 2000;
  options.localLimit = 15;
  const DistancePairs pairs = drawPairs(sphere, everyFace(sphere), options);
  EXPECT_GT(pairs.all.size(), 1900U);
  double worst = 0, mean = 0;
  for (const auto& pair : pairs.all) {
    const double cosine =
        sphere.positions.row(pair.from).dot(sphere.positions.row(pair.to)) / (radius * radius);
    const double exact = radius * std::acos(std::clamp(cosine, -1.0, 1.0));
    worst = std::max(worst, std::abs(pair.distance / exact - 1));
    mean += pair.distance / static_cast<double>(pairs.all.size());
  }
  EXPECT_LT(worst, 0.01);
  EXPECT_NEAR(mean, radius * kPi / 2, 0.05 * mean);  // of all pairs of points of a sphere
  for (const auto& pair : pairs.local) EXPECT_LE(pair.distance, 15);
}

TEST(DistanceError, IsNothingForAPlaneAtAnyScale) {
  const TriangleMesh plane = geometry::makeRectangle(20, 20, 40, 40);
  TriangleMesh larger = plane;
  larger.positions *= 1.7;
  const auto pairs = drawPairs(plane, everyFace(plane));
  for (const auto kind : {DistanceKind::Straight, DistanceKind::Surface}) {
    const DistanceError error = distanceError(pairs.all, larger, everyFace(plane), kind);
    EXPECT_LT(error.error, 1e-9);
    EXPECT_NEAR(error.scale, 1 / 1.7, 1e-9);
  }
}

TEST(DistanceError, OfAStretchIsItsMeanOverDirections) {
  const TriangleMesh plane = geometry::makeRectangle(60, 60, 60, 60);
  TriangleMesh stretched = plane;
  stretched.positions.col(0) *= 1.2;
  DistanceOptions options;
  options.localLimit = 12;
  options.pairs = 40000;
  const auto pairs = drawPairs(plane, everyFace(plane), options);
  const auto error =
      distanceError(pairs.local, stretched, everyFace(plane), DistanceKind::Straight);
  // Quadrature over directions: r = sqrt(1.44 cos^2 + sin^2), its mean |s r - 1| at the best s.
  double best = kInfinity;
  for (double s = 0.8; s < 1; s += 0.0005) {
    double sum = 0;
    constexpr int kCount = 2000;
    for (int n = 0; n < kCount; ++n) {
      const double t = kPi * n / kCount;
      sum += std::abs(s * std::hypot(1.2 * std::cos(t), std::sin(t)) - 1) / kCount;
    }
    best = std::min(best, sum);
  }
  EXPECT_NEAR(error.error, best, 0.04 * best);
}

TEST(TurnedOver, CountsFacesAgainstTheMajority) {
  TriangleMesh plane = geometry::makeRectangle(4, 4, 4, 4);
  EXPECT_EQ(turnedOver(plane, everyFace(plane)), 0);
  plane.positions.row(12) << 4.5, 2, 0;  // the middle vertex beyond the rim
  EXPECT_GT(turnedOver(plane, everyFace(plane)), 0);
  const TriangleMesh sphere = geometry::makeIcosphere(2);
  EXPECT_EQ(turnedOver(sphere, everyFace(sphere)), 0);
}

TEST(SeenShare, IsAllOfAConvexSurfaceAndNothingOfWhatLiesInside) {
  EXPECT_GT(seenShare(geometry::makeIcosphere(3)), 0.999);
  EXPECT_GT(seenShare(geometry::makeRectangle(5, 5, 1, 1)), 0.999);
  const auto nested =
      geometry::joined(geometry::makeIcosphere(3, 2), geometry::makeIcosphere(3, 1));
  EXPECT_NEAR(seenShare(nested), 0.8, 0.001);  // areas as 4 to 1
}

TEST(SeenShare, IsTheSameWhicheverWayFacesRun) {
  for (TriangleMesh mesh : {geometry::makeIcosphere(3), geometry::makeRectangle(5, 5, 1, 1)}) {
    const double asked = seenShare(mesh);
    mesh.faces.col(1).swap(mesh.faces.col(2));
    EXPECT_EQ(seenShare(mesh), asked);
  }
}

TEST(PatchTable, HasAreasAndWeightedMeansByRegion) {
  const TriangleMesh plane = geometry::makeRectangle(10, 10, 10, 10);
  VertexKeys regions(plane.vertexCount());
  Eigen::VectorXd x = plane.positions.col(0);
  for (Eigen::Index v = 0; v < plane.vertexCount(); ++v) regions[v] = x[v] > 4.5 ? 7 : 0;
  x[0] = kNaN;
  const std::string table =
      patchTable(plane, 2 * plane.positions, {{regions, {{7, "right"}}}}, {{"x", x}});
  EXPECT_NE(table.find("all\tn/a\t121\t200\t100\t400\t"), std::string::npos) << table;
  // From 5 to 10, rim vertices half as heavy: mean 7.5 but for the first column's half faces.
  EXPECT_NE(table.find("right\t7\t66\t100\t50\t200\t"), std::string::npos) << table;
  EXPECT_EQ(table.find("nan"), std::string::npos);
}

TEST(Outlines, RunHalfWayBetweenRegions) {
  const TriangleMesh plane = geometry::makeRectangle(10, 10, 10, 10);
  VertexKeys regions(plane.vertexCount());
  for (Eigen::Index v = 0; v < plane.vertexCount(); ++v) {
    regions[v] = plane.positions(v, 0) > 4.5 ? 2 : 1;
  }
  double length = 0;
  for (const auto& piece : outlines(plane.faces, plane.positions, regions)) {
    EXPECT_NEAR(piece.from.x(), 4.5, 1e-12);
    // Seen from above, what lies left of the line is named first.
    const bool upwards = piece.to.y() > piece.from.y();
    EXPECT_EQ(piece.sides, (upwards ? std::array<Label, 2>{1, 2} : std::array<Label, 2>{2, 1}));
    length += (piece.to - piece.from).norm();
  }
  EXPECT_NEAR(length, 10, 1e-12);
  const auto places = regionPlaces(plane, regions);
  EXPECT_LT(places.at(1).x(), 4);
  EXPECT_GT(places.at(2).x(), 5);
}

TEST(Outlines, MeetWhereThreeRegionsDo) {
  const TriangleMesh face{Positions{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, Faces{{0, 1, 2}}};
  const VertexKeys regions = VertexKeys{{4, 5, 6}};
  const auto pieces = outlines(face.faces, face.positions, regions);
  ASSERT_EQ(pieces.size(), 3u);
  for (const auto& piece : pieces) {
    EXPECT_NEAR((piece.from - Point(1, 1, 0) / 3).norm(), 0, 1e-12);
    const Vector along = piece.to - piece.from, left(-along.y(), along.x(), 0);
    const auto cornerOf = [&](Label key) -> Point { return face.positions.row(key - 4); };
    EXPECT_GT(left.dot(cornerOf(piece.sides[0]) - piece.from), 0);
    EXPECT_LT(left.dot(cornerOf(piece.sides[1]) - piece.from), 0);
  }
}

}  // namespace
}  // namespace explica::flattening
