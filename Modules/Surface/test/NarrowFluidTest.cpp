// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "../src/NarrowFluid.h"

#include "Explica/Core/Errors.h"
#include "Explica/Surface/CorticalSurface.h"

#include <gtest/gtest.h>

#include <cmath>

namespace explica::surface {
namespace {

/// Brightness at a place beside the middle of a layer of fluid, 0, in tissue, 1, seen through a
/// Gaussian.
double seen(double place, double width, double deviation) {
  const auto below = [&](double x) { return 0.5 * std::erfc(-x / (std::sqrt(2.0) * deviation)); };
  return 1 - (below(place + 0.5 * width) - below(place - 0.5 * width));
}

TEST(NarrowFluid, LevelIsThatAtTheLayersBorder) {
  for (const double deviation : {0.4, 0.8}) {
    for (const double width : {0.2, 0.5, 1.0, 2.0, 4.0}) {
      const double darkest = seen(0, width, deviation);
      const double border = seen(0.5 * width, width, deviation);
      EXPECT_NEAR(darkest + levelBesideFluid(1 - darkest) * (1 - darkest), border, 1e-4)
          << width << " " << deviation;
    }
  }
}

TEST(NarrowFluid, LevelRisesToOneHalf) {
  double before = 0;
  for (int k = 1; k <= 40; ++k) {
    const double level = levelBesideFluid(0.05 * k);
    EXPECT_GE(level, before);
    EXPECT_LE(level, 0.5 + 1e-3);
    before = level;
  }
  EXPECT_NEAR(levelBesideFluid(2), 0.5, 1e-3);
  EXPECT_GT(levelBesideFluid(-1), 0);
}

TEST(NarrowFluid, BrightnessOfFluidMustBeOne) {
  CorticalTissue tissue;
  tissue.hasGrey = true;
  for (const double fluid : {-0.1, 11.0, std::nan("")}) {
    SurfaceOptions options;
    options.fluid = fluid;
    EXPECT_THROW((void)buildSurfaces(tissue, options), InvalidInput) << fluid;
  }
}

}  // namespace
}  // namespace explica::surface
