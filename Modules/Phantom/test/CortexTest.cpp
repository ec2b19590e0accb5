// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Phantom/Cortex.h"

#include "Explica/Core/Errors.h"
#include "Explica/Core/Parallel.h"

#include <gtest/gtest.h>

namespace explica::phantom {
namespace {

CortexOptions small() {
  CortexOptions options;
  options.size = 40;
  return options;
}

TEST(CortexPhantom, LabelsFollowTheDistance) {
  const Cortex cortex = makeCortex(small());
  for (std::size_t v = 0; v < cortex.level.size(); ++v) {
    const bool grey = cortex.level[v] > 0 && cortex.level[v] <= cortex.thickness;
    ASSERT_EQ(cortex.labels[v] == Cortex::kGrey, grey);
    ASSERT_EQ(cortex.labels[v] == Cortex::kWhite, cortex.level[v] <= 0);
  }
}

TEST(CortexPhantom, DistanceChangesByAtMostTheWay) {
  const Cortex cortex = makeCortex(small());
  const Grid& grid = cortex.level.grid;
  for (std::size_t v = 0; v < cortex.level.size(); ++v) {
    const auto [i, j, k] = grid.subscripts(v);
    if (i + 1 >= grid.size[0]) continue;
    ASSERT_LE(std::abs(cortex.level(i + 1, j, k) - cortex.level(i, j, k)), 1 + 1e-4);
  }
}

TEST(CortexPhantom, DoesNotDependOnThreads) {
  setThreadCount(1);
  const Cortex one = makeCortex(small());
  setThreadCount(4);
  const Cortex four = makeCortex(small());
  setThreadCount(0);
  EXPECT_EQ(one.image.data, four.image.data);
}

TEST(CortexPhantom, VentricleIsFluidAndNothingElseChanges) {
  CortexOptions options = small();
  options.noise = options.bias = 0;
  const Cortex without = makeCortex(options);
  options.ventricle = 4;
  const Cortex with = makeCortex(options);
  const Grid& grid = with.image.grid;
  for (std::size_t v = 0; v < with.image.size(); ++v) {
    const auto [i, j, k] = grid.subscripts(v);
    const double r = grid.toWorld(Vector(i, j, k)).norm();
    if (r > 4.5) {
      EXPECT_EQ(with.image[v], without.image[v]);
    }
    if (r < 3.5) {
      EXPECT_NEAR(with.image[v], 35, 1e-3);
      EXPECT_EQ(with.labels[v], Cortex::kCsf);
    }
  }
  options.ventricle = 15;
  EXPECT_THROW((void)makeCortex(options), InvalidInput);
}

TEST(CortexPhantom, DuraIsASheetInTheFluid) {
  CortexOptions options = small();
  options.noise = options.bias = 0;
  const Cortex without = makeCortex(options);
  options.dura = 1;
  options.duraGap = 1;
  const Cortex with = makeCortex(options);
  EXPECT_EQ(with.labels.data, without.labels.data);
  int bright = 0;
  for (std::size_t v = 0; v < with.image.size(); ++v) {
    const double beyond = with.level[v] - options.thickness;
    if (beyond > 1 && beyond < 2) {
      EXPECT_GT(with.image[v], without.image[v]);
      bright += std::abs(beyond - 1.5) < 0.01 ? std::abs(with.image[v] - 70) < 1 : 0;
    }
    if (beyond < 0.4) {
      EXPECT_EQ(with.image[v], without.image[v]);
    }
  }
  EXPECT_GT(bright, 0);
  options.duraGap = 2.5;
  EXPECT_THROW((void)makeCortex(options), InvalidInput) << "beyond the fluid";
}

TEST(CortexPhantom, RefusesARibbonWithoutRoom) {
  CortexOptions options = small();
  options.thickness = 20;
  EXPECT_THROW((void)makeCortex(options), InvalidInput);
}

}  // namespace
}  // namespace explica::phantom
