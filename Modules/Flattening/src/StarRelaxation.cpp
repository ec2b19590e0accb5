// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Flattening/StarRelaxation.h"

#include <algorithm>

namespace explica::flattening {
namespace {

using Complex = std::complex<double>;
using Plane = Eigen::Vector2d;

Plane rowOf(Complex weight, Complex direction) {
  const Complex w = weight * std::conj(direction);
  return {w.real(), -w.imag()};
}

/// Value and, if wanted, derivatives by the moving vertex; each face's Hessian made positive by
/// leaving out what is negative on the diagonal.
StarTerms evaluate(const std::vector<StarFace>& star, double areaWeight, const Plane& place,
                   bool derivatives) {
  StarTerms terms;
  for (const StarFace& face : star) {
    const std::array<Complex, 3> z = {Complex(place.x(), place.y()),
                                      Complex(face.second.x(), face.second.y()),
                                      Complex(face.third.x(), face.third.y())};
    Complex p = 0, q = 0;
    for (int k = 0; k < 3; ++k) {
      p += z[k] * std::conj(face.rest.gradient[k]) / 2.0;
      q += z[k] * face.rest.gradient[k] / 2.0;
    }
    const double sizeP = std::abs(p), sizeQ = std::abs(q), w = face.rest.area;
    const Density d = mapDensity(sizeP, sizeQ, areaWeight);
    terms.value += w * d.value;
    if (!derivatives) continue;
    const Complex alongP = sizeP > 0 ? p / sizeP : Complex(1, 0);
    const Complex alongQ = sizeQ > 0 ? q / sizeQ : Complex(1, 0);
    const Complex ofP = std::conj(face.rest.gradient[0]) / 2.0, ofQ = face.rest.gradient[0] / 2.0;
    const Plane radialP = rowOf(ofP, alongP), radialQ = rowOf(ofQ, alongQ);
    const Plane turnP = rowOf(ofP, Complex(0, 1) * alongP);
    const Plane turnQ = rowOf(ofQ, Complex(0, 1) * alongQ);
    terms.gradient += w * (d.dP * radialP + d.dQOverQ * sizeQ * radialQ);
    // |dPQ| on both diagonals is above the mixed term.
    const double mixed = std::abs(d.dPQ);
    const auto add = [&](double factor, const Plane& row) {
      if (factor > 0) terms.hessian += w * factor * row * row.transpose();
    };
    const bool convex = d.dPP > 0 && d.dQQ > 0 && d.dPP * d.dQQ > d.dPQ * d.dPQ;
    if (convex) {
      add(d.dPP, radialP);
      add(d.dQQ, radialQ);
      terms.hessian += w * d.dPQ * (radialP * radialQ.transpose() + radialQ * radialP.transpose());
    } else {
      add(d.dPP + mixed, radialP);
      add(d.dQQ + mixed, radialQ);
    }
    add(d.dP / sizeP, turnP);
    add(d.dQOverQ, turnQ);
  }
  return terms;
}

}  // namespace

RestFace restFace(const std::array<double, 3>& lengths, double smallestHeight, bool* raised) {
  // The longest edge lies on the real axis, so that the height is the smallest one.
  int longest = 0;
  for (int k = 1; k < 3; ++k) {
    if (lengths[k] > lengths[longest]) longest = k;
  }
  const double a = std::max(lengths[longest], smallestHeight);
  const double b = lengths[(longest + 1) % 3], c = lengths[(longest + 2) % 3];
  const double x = std::clamp((a * a + c * c - b * b) / (2 * a), 0.0, a);
  double height = std::sqrt(std::max(0.0, c * c - x * x));
  if (raised) *raised = height < smallestHeight;
  height = std::max(height, smallestHeight);
  RestFace face;
  face.area = a * height / 2;
  const std::array<Complex, 3> at = {Complex(0, 0), Complex(a, 0), Complex(x, height)};
  for (int k = 0; k < 3; ++k) {
    face.gradient[(longest + k) % 3] =
        Complex(0, 1) * (at[(k + 2) % 3] - at[(k + 1) % 3]) / (2 * face.area);
  }
  return face;
}

Plane relaxedPlace(const std::vector<StarFace>& star, double areaWeight, const Plane& place) {
  return relaxedBySteps(
      place,
      [&](const Plane& at, bool derivatives) {
        return evaluate(star, areaWeight, at, derivatives);
      },
      [](const Plane& from, const Plane& step, double share) -> Plane {
        return from + share * step;
      });
}

}  // namespace explica::flattening
