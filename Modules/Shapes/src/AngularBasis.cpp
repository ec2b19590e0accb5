// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "AngularBasis.h"

#include <cmath>

namespace explica::shapes {
namespace {

/// sinh(a x) / sinh(a) for x in [0, 1], without overflow.
double sinhRatio(double a, double x) {
  return std::exp(a * (x - 1)) * std::expm1(-2 * a * x) / std::expm1(-2 * a);
}

}  // namespace

int degreeOf(int dimension, int k) {
  if (dimension == 2) return (k + 1) / 2;
  return static_cast<int>(std::sqrt(static_cast<double>(k) + 0.5));
}

RadialFactors radialFactors(int dimension, int degree, double r, double r0, double r1) {
  const double whole = std::log(r1 / r0);
  const double x = std::log(r / r0) / whole;
  if (dimension == 2) {
    if (degree == 0) return {1 - x, x};
    return {sinhRatio(degree * whole, 1 - x), sinhRatio(degree * whole, x)};
  }
  const double a = (degree + 0.5) * whole;
  return {std::sqrt(r0 / r) * sinhRatio(a, 1 - x), std::sqrt(r1 / r) * sinhRatio(a, x)};
}

void angularBasis(int dimension, int order, const Vector& d, double* values) {
  if (dimension == 2) {
    const double angle = std::atan2(d.y(), d.x());
    values[0] = 1;
    for (int n = 1; n <= order; ++n) {
      values[2 * n - 1] = std::cos(n * angle);
      values[2 * n] = std::sin(n * angle);
    }
    return;
  }
  // Associated Legendre functions scaled to a mean square of 1 over the sphere, upward in l.
  const double z = d.z();
  const double s = std::hypot(d.x(), d.y());
  const double phi = s > 0 ? std::atan2(d.y(), d.x()) : 0;
  double diagonal = 1;  // P_mm
  for (int m = 0; m <= order; ++m) {
    if (m > 0) diagonal *= s * std::sqrt((2.0 * m + 1) / (2.0 * m)) * (m == 1 ? std::sqrt(2.0) : 1);
    const double cosine = std::cos(m * phi);
    const double sine = std::sin(m * phi);
    double before = 0;
    double at = diagonal;
    for (int l = m; l <= order; ++l) {
      if (l > m) {
        const double l2 = static_cast<double>(l) * l;
        const double m2 = static_cast<double>(m) * m;
        const double a = std::sqrt((4 * l2 - 1) / (l2 - m2));
        const double b =
            l - 1 > m ? std::sqrt(((l - 1.0) * (l - 1) - m2) / (4 * (l - 1.0) * (l - 1) - 1)) : 0;
        const double next = a * (z * at - b * before);
        before = at;
        at = next;
      }
      values[l * l + l + m] = at * cosine;
      if (m > 0) values[l * l + l - m] = at * sine;
    }
  }
}

}  // namespace explica::shapes
