// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Pipeline/FlatMarks.h"

#include "Explica/IO/VertexDataFile.h"
#include "Explica/Testing/Meshes.h"

#include <gtest/gtest.h>

namespace explica::pipeline {
namespace {

TEST(FlatMarks, DirectionsAreThoseInWhichTheMapGoes) {
  const TriangleMesh flat = geometry::makeRectangle(30, 20, 30, 20);
  Positions folded = flat.positions;
  folded.col(0).setZero();                                    // x does not change on the map
  folded.col(1) = -2 * flat.positions.col(0);                 // anterior is where u falls
  folded.col(2) = (9 * flat.positions.array().col(1)).sin();  // up and down many times
  report::FlatMarks marks;
  markDirections(folded, flat, marks);
  ASSERT_EQ(marks.directions.size(), 2u);
  EXPECT_EQ(marks.directions[0].second, "A");
  EXPECT_LT((marks.directions[0].first - Eigen::Vector2d(-1, 0)).norm(), 1e-9);
  EXPECT_EQ(marks.directions[1].second, "P");
  EXPECT_LT((marks.directions[1].first - Eigen::Vector2d(1, 0)).norm(), 1e-9);
}

TEST(FlatMarks, WhatIsNoRegionHasNoName) {
  const TriangleMesh flat = geometry::makeRectangle(30, 20, 30, 20);
  const Eigen::VectorX<Label> keys =
      (flat.positions.col(0).array() < 15)
          .select(Eigen::VectorX<Label>::Ones(flat.vertexCount()), 2);
  const io::LabelMap regions{"regions", keys, {{1, "V1", {1, 0, 0, 1}}, {2, "???", {0, 1, 0, 1}}}};
  report::FlatMarks marks;
  markRegions(regions, flat, marks);
  ASSERT_EQ(marks.names.size(), 1u);
  EXPECT_EQ(marks.names[0].second, "V1");
  EXPECT_FALSE(marks.lines.empty());
}

}  // namespace
}  // namespace explica::pipeline
