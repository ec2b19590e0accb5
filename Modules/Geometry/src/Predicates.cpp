// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Geometry/Predicates.h"

#include "Expansion.h"

#include <cmath>
#include <limits>

namespace explica::geometry {
namespace {

// Half a unit in the last place of 1, and the forward error bounds of the two determinants as they
// are evaluated below [Shewchuk1997, Eq. 26 and table 3].
constexpr double kRounding = std::numeric_limits<double>::epsilon() / 2;
constexpr double kPlaneBound = (3.0 + 16.0 * kRounding) * kRounding;
constexpr double kSpaceBound = (7.0 + 56.0 * kRounding) * kRounding;

int signOf(double value) {
  return value > 0 ? 1 : (value < 0 ? -1 : 0);
}

/// a d - b c, exactly.
auto exactMinor(const Expansion<2>& a, const Expansion<2>& b, const Expansion<2>& c,
                const Expansion<2>& d) {
  return exactSum(exactProduct(a, d), negated(exactProduct(b, c)));
}

int exactOrientation(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c) {
  return exactMinor(exactDifference(a.x(), c.x()), exactDifference(a.y(), c.y()),
                    exactDifference(b.x(), c.x()), exactDifference(b.y(), c.y()))
      .sign();
}

int exactOrientation(const Point& a, const Point& b, const Point& c, const Point& d) {
  Expansion<2> rows[3][3];
  const Point* const points[3] = {&a, &b, &c};
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) rows[i][j] = exactDifference((*points[i])[j], d[j]);
  }
  Expansion<192> sum;
  for (int i = 0; i < 3; ++i) {
    const auto& p = rows[(i + 1) % 3];
    const auto& q = rows[(i + 2) % 3];
    sum.add(exactProduct(exactMinor(p[0], p[1], q[0], q[1]), rows[i][2]));
  }
  return -sum.sign();
}

}  // namespace

int orientation(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c) {
  const double left = (a.x() - c.x()) * (b.y() - c.y());
  const double right = (a.y() - c.y()) * (b.x() - c.x());
  const double determinant = left - right;
  const double magnitude = std::abs(left) + std::abs(right);
  if (std::abs(determinant) > kPlaneBound * magnitude) return signOf(determinant);
  if (magnitude == 0) return 0;
  return exactOrientation(a, b, c);
}

int orientation(const Point& a, const Point& b, const Point& c, const Point& d) {
  const Vector u = a - d;
  const Vector v = b - d;
  const Vector w = c - d;
  const double vxwy = v.x() * w.y(), wxvy = w.x() * v.y();
  const double wxuy = w.x() * u.y(), uxwy = u.x() * w.y();
  const double uxvy = u.x() * v.y(), vxuy = v.x() * u.y();
  const double determinant = u.z() * (vxwy - wxvy) + v.z() * (wxuy - uxwy) + w.z() * (uxvy - vxuy);
  const double magnitude = (std::abs(vxwy) + std::abs(wxvy)) * std::abs(u.z()) +
                           (std::abs(wxuy) + std::abs(uxwy)) * std::abs(v.z()) +
                           (std::abs(uxvy) + std::abs(vxuy)) * std::abs(w.z());
  // The determinant of (a - d, b - d, c - d) is positive below the plane: its sign is turned.
  if (std::abs(determinant) > kSpaceBound * magnitude) return -signOf(determinant);
  if (magnitude == 0) return 0;
  return exactOrientation(a, b, c, d);
}

}  // namespace explica::geometry
