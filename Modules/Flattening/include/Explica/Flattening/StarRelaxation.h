// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Flattening/MapEnergy.h"

#include <Eigen/LU>

#include <cmath>
#include <optional>
#include <vector>

// A vertex between neighbours that stay, in the plane and on the sphere.
namespace explica::flattening {

/// The part of a convex polygon, or of a convex cone given by its edges in order, in which `side`,
/// a linear function, is not negative.
template <class Place, class Side>
std::vector<Place> clipped(const std::vector<Place>& polygon, const Side& side) {
  std::vector<Place> kept;
  for (std::size_t n = 0; n < polygon.size(); ++n) {
    const Place &p = polygon[n], &q = polygon[(n + 1) % polygon.size()];
    const double sp = side(p), sq = side(q);
    if (sp >= 0) kept.push_back(p);
    if ((sp > 0 && sq < 0) || (sp < 0 && sq > 0)) kept.push_back(p + sp / (sp - sq) * (q - p));
  }
  return kept;
}

/// A place from which the ring is seen where the kernel is too thin for its corners to be computed:
/// beside the ring's place `centre`, along the bisector of the angle that the ring has there.  The
/// faces that join that vertex to the ring are positive, so near enough the ring is seen, though
/// the angle may be of more than 180 degrees.
/// @param wayTo  from the centre to a place of the ring, across the surface
/// @param turn   the angle from one such way to another
/// @param at     (way, angle, share): the place at that share of the way, turned by the angle
template <class Ring, class WayTo, class Turn, class At, class SeesRing>
auto placeBeside(const Ring& ring, std::size_t centre, const WayTo& wayTo, const Turn& turn,
                 const At& at, const SeesRing& seesRing)
    -> std::optional<typename Ring::value_type> {
  constexpr int kHalvings = 50;  // down to the rounding of the coordinates
  const auto way = [&](std::size_t n) { return wayTo(ring[(centre + n) % ring.size()]); };
  double angle = 0;
  for (std::size_t n = 1; n + 1 < ring.size(); ++n) angle += turn(way(n), way(n + 1));
  double share = 0.5;
  for (int n = 0; n < kHalvings; ++n, share /= 2) {
    const typename Ring::value_type tried = at(way(1), angle / 2, share);
    if (seesRing(tried)) return tried;
  }
  return {};
}

/// Value of the faces about a vertex, and derivatives by its two coordinates.
struct StarTerms {
  double value = 0;
  Eigen::Vector2d gradient = Eigen::Vector2d::Zero();
  Eigen::Matrix2d hessian = Eigen::Matrix2d::Zero();
};

/// Lowers the energy of the faces about a vertex by damped Newton steps.
/// @param termsAt  (place, with derivatives): StarTerms, of infinite value where a face has none
/// @param moved    (place, step, share)
template <class Place, class TermsAt, class Moved>
Place relaxedBySteps(Place place, const TermsAt& termsAt, const Moved& moved) {
  constexpr double kEnough = 1e-2;  // of the energy: neighbours will move the vertex again
  constexpr int kMostSteps = 10, kHalvings = 20;
  for (int n = 0; n < kMostSteps; ++n) {
    const StarTerms terms = termsAt(place, true);
    if (!std::isfinite(terms.value)) break;
    const Eigen::Vector2d step = -(terms.hessian.inverse() * terms.gradient);
    if (!(-terms.gradient.dot(step) > kEnough * terms.value)) break;
    double share = 1;
    bool lower = false;
    for (int halving = 0; halving < kHalvings && !lower; ++halving, share /= 2) {
      const Place tried = moved(place, step, share);
      if (!(termsAt(tried, false).value < terms.value)) continue;
      place = tried;
      lower = true;
    }
    if (!lower) break;
  }
  return place;
}

/// A face about a vertex that may move while the two others stay.
struct StarFace {
  RestFace rest;                  ///< gradient[0] is of the vertex that may move
  Eigen::Vector2d second, third;  ///< the others, counter-clockwise after it
};

/// Moves the vertex downhill by damped Newton steps that keep every face positive.
/// @param place  from where every face is positive
[[nodiscard]] Eigen::Vector2d relaxedPlace(const std::vector<StarFace>& star, double areaWeight,
                                           const Eigen::Vector2d& place);

}  // namespace explica::flattening
