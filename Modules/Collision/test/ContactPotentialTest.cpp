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

}  // namespace
}  // namespace explica::collision
