// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "../src/MeetingKernels.h"

#include "Explica/Collision/ContinuousCollision.h"
#include "Explica/Testing/InstructionSets.h"
#include "Samples.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

namespace explica::collision {
namespace {

using kernels::PairBatch;

/// Random pairs; every fourth of them flat, thin or with a point in common.
PairBatch randomBatch(std::mt19937& random, bool awkward) {
  PairBatch batch = {};
  for (int n = 0; n < PairBatch::kLanes; ++n) {
    FourPoints x = randomPoints(random), motion = randomPoints(random);
    if (awkward && n % 4 == 0) x[3] = x[2] + 1e-9 * (x[1] - x[2]);
    if (awkward && n % 4 == 1) x[3] = x[2] + (x[1] - x[0]);
    if (awkward && n % 4 == 2) x[3] = x[2];
    if (awkward && n % 4 == 3) x[1] = x[0];
    for (int i = 0; i < 3; ++i) {
      for (int k = 0; k < 3; ++k) {
        batch.at[i][k][n] = x[i + 1][k] - x[0][k];
        batch.motion[i][k][n] = motion[i + 1][k] - motion[0][k];
      }
    }
  }
  return batch;
}

FourPoints pointsOf(const double (&at)[3][3][PairBatch::kLanes], int n) {
  FourPoints x;
  x[0].setZero();
  for (int i = 0; i < 3; ++i) x[i + 1] = Point(at[i][0][n], at[i][1][n], at[i][2][n]);
  return x;
}

TEST(MeetingKernels, SeparationIsTheDistanceAndClosingBoundsItsFall) {
  std::mt19937 random(3);
  for (int round = 0; round < 500; ++round) {
    PairBatch batch = randomBatch(random, false);
    for (const PairKind kind : {PairKind::VertexFace, PairKind::EdgeEdge}) {
      kind == PairKind::VertexFace ? kernels::separateVertexFace(batch)
                                   : kernels::separateEdgeEdge(batch);
      for (int n = 0; n < PairBatch::kLanes; ++n) {
        const FourPoints x = pointsOf(batch.at, n), motion = pointsOf(batch.motion, n);
        ASSERT_NEAR(batch.separation[n], std::sqrt(squaredDistance(kind, x)), 1e-12);
        ASSERT_LE(batch.closing[n], approachBound(kind, motion));
        for (const double t : {0.1, 0.5, 1.0}) {
          ASSERT_GE(std::sqrt(squaredDistance(kind, moved(x, motion, t))),
                    batch.separation[n] - std::max(0.0, t * batch.closing[n]) - 1e-12);
        }
      }
    }
  }
}

TEST(MeetingKernels, DegenerateFeaturesAreNeverSeparatedFartherThanTheyAre) {
  std::mt19937 random(4);
  for (int round = 0; round < 500; ++round) {
    PairBatch batch = randomBatch(random, true);
    for (const PairKind kind : {PairKind::VertexFace, PairKind::EdgeEdge}) {
      kind == PairKind::VertexFace ? kernels::separateVertexFace(batch)
                                   : kernels::separateEdgeEdge(batch);
      for (int n = 0; n < PairBatch::kLanes; ++n) {
        const double distance = std::sqrt(squaredDistance(kind, pointsOf(batch.at, n)));
        if (distance < 1e-9) {
          ASSERT_FALSE(batch.separation[n] > 1e-9);
          continue;
        }
        ASSERT_LE(batch.separation[n], distance + 1e-12);
        ASSERT_GE(batch.separation[n], distance - 1e-6);
      }
    }
  }
}

TEST(MeetingKernels, TouchingPairsAreNeverFar) {
  PairBatch batch = {};
  for (int n = 0; n < PairBatch::kLanes; ++n) {
    batch.at[0][0][n] = -1;  // a face, or edges, through the first point
    batch.at[1][0][n] = 1;
    batch.at[1][1][n] = -1;
    batch.at[2][0][n] = 1;
    batch.at[2][1][n] = 1;
  }
  kernels::separateVertexFace(batch);
  for (const double s : batch.separation) EXPECT_FALSE(s > 0);
  PairBatch crossing = {};
  for (int n = 0; n < PairBatch::kLanes; ++n) {
    crossing.at[0][0][n] = 2;
    crossing.at[1][0][n] = crossing.at[2][0][n] = 1;
    crossing.at[1][1][n] = -1;
    crossing.at[2][1][n] = 1;
  }
  kernels::separateEdgeEdge(crossing);
  for (const double s : crossing.separation) EXPECT_FALSE(s > 0);
}

/// All that the kernels compute, with the present choice of instruction set.
std::vector<double> everything() {
  std::mt19937 random(5);
  std::vector<double> all;
  for (int round = 0; round < 200; ++round) {
    PairBatch batch = randomBatch(random, round % 2 == 1);
    for (int kind = 0; kind < 2; ++kind) {
      kind == 0 ? kernels::separateVertexFace(batch) : kernels::separateEdgeEdge(batch);
      all.insert(all.end(), batch.separation, batch.separation + PairBatch::kLanes);
      all.insert(all.end(), batch.closing, batch.closing + PairBatch::kLanes);
    }
  }
  return all;
}

TEST(MeetingKernels, EveryInstructionSetGivesTheSameBits) {
  const std::vector<double> widest = everything();
  testing::forEachNarrowerInstructionSet([&](std::int64_t target) {
    const std::vector<double> narrow = everything();
    ASSERT_EQ(narrow.size(), widest.size());
    EXPECT_EQ(std::memcmp(narrow.data(), widest.data(), sizeof(double) * widest.size()), 0)
        << target;
  });
}

}  // namespace
}  // namespace explica::collision
