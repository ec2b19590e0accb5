// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Collision/ContactPotential.h"

#include "Samples.h"

#include <gtest/gtest.h>

#include <cmath>

namespace explica::collision {
namespace {

TEST(ContactPotential, GradientPassesTheTaylorTestAlsoWhereParallelEdgesFade) {
  std::mt19937 random(13);
  std::uniform_real_distribution<double> uniform(-1, 1);
  int faded = 0;
  for (int n = 0; n < 400; ++n) {
    Positions x(4, 3), direction(4, 3);
    for (Eigen::Index i = 0; i < 12; ++i) {
      x.data()[i] = uniform(random);
      direction.data()[i] = uniform(random);
    }
    Contact contact{{0, 1, 2, 3}, n % 2 ? PairKind::VertexFace : PairKind::EdgeEdge, 1.2, 0};
    if (n % 4 == 0) {
      contact.parallelArea = 2;
      ++faded;
    }
    const std::vector<Contact> contacts = {contact};
    const auto forces = contactForces(contacts, x);
    Vector12 d;
    for (int i = 0; i < 4; ++i) d.segment<3>(3 * i) = direction.row(i).transpose();
    const double slope = forces[0].gradient.dot(d);
    EXPECT_GE(forces[0].curvature, 0);
    const double value = contactEnergy(contacts, x);
    double previous = 0;
    for (const double h : {1e-4, 1e-5}) {
      const double remainder = contactEnergy(contacts, x + h * direction) - value - h * slope;
      if (h < 1e-4) {
        EXPECT_LE(std::abs(remainder), 0.05 * std::abs(previous) + 1e-13);
      }
      previous = remainder;
    }
  }
  EXPECT_EQ(faded, 100);
}

TEST(ContactPotential, ContactIsInfinitelyHighAndFarPairsAreFree) {
  Positions x(4, 3);
  x << 0.25, 0.25, 0, 0, 0, 0, 1, 0, 0, 0, 1, 0;
  const std::vector<Contact> contacts = {{{0, 1, 2, 3}, PairKind::VertexFace, 0.5, 0}};
  EXPECT_TRUE(std::isinf(contactEnergy(contacts, x)));
  x(0, 2) = 0.6;
  EXPECT_EQ(contactEnergy(contacts, x), 0);
  EXPECT_EQ(contactForces(contacts, x)[0].gradient.norm(), 0);
}

/// Oracle: one after the other.
TEST(ContactPotential, ContactsWithinRangeAndTheirEnergyAreThoseOfOneByOne) {
  std::mt19937 random(17);
  std::uniform_real_distribution<double> uniform(-1, 1);
  constexpr int kCount = 3000;
  Positions x(4 * kCount, 3);
  for (Eigen::Index i = 0; i < x.size(); ++i) x.data()[i] = uniform(random);
  std::vector<Contact> contacts;
  for (int n = 0; n < kCount; ++n) {
    contacts.push_back({{4 * n, 4 * n + 1, 4 * n + 2, 4 * n + 3},
                        n % 700 < 300 ? PairKind::VertexFace : PairKind::EdgeEdge,
                        0.3 + 0.2 * uniform(random)});
  }
  std::vector<std::array<std::int32_t, 4>> near;
  double energy = 0;
  for (const Contact& c : contacts) {
    FourPoints p;
    for (int i = 0; i < 4; ++i) p[i] = x.row(c.vertices[i]).transpose();
    if (squaredDistance(c.kind, p) < c.range * c.range) near.push_back(c.vertices);
    energy += contactEnergy(std::vector<Contact>{c}, x);
  }
  EXPECT_GT(near.size(), 300u);
  EXPECT_LT(near.size(), 2700u);
  const auto found = contactsWithin(contacts, x);
  ASSERT_EQ(found.size(), near.size());
  for (std::size_t n = 0; n < near.size(); ++n) EXPECT_EQ(found[n].vertices, near[n]);
  EXPECT_NEAR(contactEnergy(contacts, x), energy, 1e-9 * energy);
}

}  // namespace
}  // namespace explica::collision
