// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Sphere/Average.h"

#include "Explica/Core/Errors.h"
#include "Explica/Geometry/Fixtures.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

namespace explica::sphere {
namespace {

/// A person whose folds are at `places` of a common pattern.
FoldingSphere personAt(const Positions& places) {
  FoldingSphere person;
  person.sphere = geometry::makeIcosphere(4, 100);
  const auto x = places.col(0).array(), y = places.col(1).array(), z = places.col(2).array();
  person.sulc = ((5 * x).sin() + (4 * y + z).cos() + 2 * x * z).matrix();
  person.curvature = ((9 * z + x).cos() + (7 * y - 5 * x).sin()).matrix();
  return person;
}

Positions shifted(double along) {
  Positions places = geometry::makeIcosphere(4).positions;
  places.col(2).array() += along * (1 - places.col(2).array().square());
  places.rowwise().normalize();
  return places;
}

AverageOptions quickAverage() {
  AverageOptions options;
  options.registration.level = 4;
  options.registration.smoothness = 0.2;
  return options;
}

TEST(SphereAverage, OfTwoOppositeDeformationsIsHalfwayWhoeverIsFirst) {
  const std::vector<FoldingSphere> people = {personAt(shifted(0.1)), personAt(shifted(-0.1))};
  const TriangleMesh grid = geometry::makeIcosphere(4, 100);
  const SphereAverage average = averageSpheres(people, grid, quickAverage());
  ASSERT_EQ(average.registered.size(), 2U);
  EXPECT_LT(average.deformation.back(), 0.1);
  EXPECT_GT(average.deformation.front(), 1);  // the first person lies that far from halfway
  const FoldingSphere halfway = personAt(grid.positions / 100);
  EXPECT_LT((average.folding.sulc - halfway.sulc).cwiseAbs().mean(), 0.05);
  // The people's spheres are where the template has their folds.
  const Eigen::VectorXd there = personAt(average.registered[0] / 100).sulc;
  EXPECT_LT((there - people[0].sulc).cwiseAbs().mean(), 0.05);
}

TEST(SphereAverage, DoesNotDependOnTheOrderOfThePeople) {
  const std::vector<FoldingSphere> people = {personAt(shifted(0.2)), personAt(shifted(-0.05)),
                                             personAt(shifted(0.1))};
  const TriangleMesh grid = geometry::makeIcosphere(4, 100);
  AverageOptions once = quickAverage();
  once.iterations = 1;
  once.registration.level = 3;
  once.registration.rotate = false;
  const SphereAverage one = averageSpheres(people, grid, once);
  const SphereAverage other = averageSpheres({people[2], people[0], people[1]}, grid, once);
  EXPECT_EQ(one.folding.sulc, other.folding.sulc);
  EXPECT_EQ(one.registered[0], other.registered[1]);
  EXPECT_EQ(one.registered[2], other.registered[0]);
}

TEST(MeanShape, OfTurnedAndMovedShapesIsTheShape) {
  const Positions shape = shifted(0.3) * 50;
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(0.7, Vector(1, 2, -1).normalized()).toRotationMatrix();
  Positions moved = shape * turn.transpose();
  moved.rowwise() += Eigen::RowVector3d(3, -4, 20);
  EXPECT_LT((meanShape({shape, moved}) - shape).cwiseAbs().maxCoeff(), 1e-9);
}

TEST(SphereAverage, RefusesOnePerson) {
  EXPECT_THROW(static_cast<void>(averageSpheres({personAt(shifted(0))},
                                                geometry::makeIcosphere(3, 100), quickAverage())),
               InvalidInput);
}

}  // namespace
}  // namespace explica::sphere
