// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Maps/Parcellation.h"

#include "Explica/Core/Errors.h"
#include "Explica/Maps/Icosphere.h"

#include <gtest/gtest.h>

#include <cmath>

namespace explica::maps {
namespace {

/// Key 1 where z > level, else 0, folded in waves of x that are moved by `shift`.
LabelledSphere halves(int size, double level, double shift) {
  LabelledSphere atlas{fsaverageSphere(size), {}, {}};
  atlas.keys = (atlas.sphere.positions.col(2).array() > level).cast<Label>();
  atlas.folding = (0.15 * (atlas.sphere.positions.col(0).array() - shift)).sin();
  return atlas;
}

TEST(Parcellation, OfOneAtlasIsItsLabelsWithDoubtAtBordersOnly) {
  const TriangleMesh person = fsaverageSphere(3);
  const Parcellation found = parcellate(person, {}, {halves(5, 10, 0)});
  for (Eigen::Index v = 0; v < person.vertexCount(); ++v) {
    const double z = person.positions(v, 2);
    if (std::abs(z - 10) < 20) continue;
    EXPECT_EQ(found.keys[v], z > 10 ? 1 : 0);
    EXPECT_EQ(found.doubt[v], 0);
  }
  EXPECT_GT(found.doubt.maxCoeff(), 0.1);
  EXPECT_LE(found.doubt.maxCoeff(), 0.5);
}

TEST(Parcellation, TheMajorityWins) {
  const TriangleMesh person = fsaverageSphere(4);
  const Parcellation found =
      parcellate(person, {}, {halves(4, -40, 0), halves(4, 20, 0), halves(4, 20, 0)});
  for (Eigen::Index v = 0; v < person.vertexCount(); ++v) {
    const double z = person.positions(v, 2);
    EXPECT_EQ(found.keys[v], z > 20 ? 1 : 0);
    EXPECT_NEAR(found.doubt[v], z > -40 && z <= 20 ? 1.0 / 3 : 0, 1e-9);
  }
}

TEST(Parcellation, WhoIsFoldedAlikeOutvotesTheOthers) {
  const LabelledSphere alike = halves(4, -40, 0), other = halves(4, 20, 21);
  const Parcellation found = parcellate(alike.sphere, alike.folding, {other, alike, other});
  EXPECT_EQ(found.keys, alike.keys);
  EXPECT_LT(found.doubt.maxCoeff(), 0.2);
}

TEST(Parcellation, RefusesWhatDoesNotFit) {
  LabelledSphere atlas = halves(3, 0, 0);
  EXPECT_THROW((void)parcellate(atlas.sphere, {}, {}), InvalidInput);
  atlas.keys.conservativeResize(5);
  EXPECT_THROW((void)parcellate(fsaverageSphere(2), {}, {atlas}), InvalidInput);
}

}  // namespace
}  // namespace explica::maps
