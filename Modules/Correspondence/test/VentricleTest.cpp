// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Correspondence/Correspondence.h"

#include "Explica/Core/Errors.h"
#include "Explica/Harmonic/Phantoms.h"

#include <gtest/gtest.h>

#include <cmath>

using namespace explica;
using namespace explica::correspondence;

TEST(Ventricle, PhantomHasItsExactThicknessAwayFromTheBase) {
  const auto phantom = harmonic::makePhantom(harmonic::PhantomKind::Ventricle, {116, 1});
  const auto insulated = harmonic::maskOf(phantom.labels, {4});
  const auto annulus = harmonic::annulusFromLevels(
      phantom.innerLevel, phantom.outerLevel, {0, harmonic::LevelInside::Below}, {}, insulated);
  const auto interpolant = harmonic::solveInterpolant(annulus);
  const auto found = findCorrespondences(annulus, interpolant);
  std::size_t seen = 0;
  for (std::int32_t n = 0; n < static_cast<std::int32_t>(annulus.count()); ++n) {
    const Point x = annulus.world(n);
    if (x[2] > 3) continue;  // a wall's thickness below the base
    ++seen;
    ASSERT_NEAR(found.thickness(n), phantom.exact.answer(x).thickness(), 0.1);
  }
  EXPECT_GT(seen, 10000U);
}
