// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Ventricle/Slices.h"

#include <Eigen/Core>

#include <vector>

namespace explica::ventricle {

/// True where slices are so much thicker than pixels (three times and more) that thickness and axis
/// are found slice by slice.
[[nodiscard]] bool hasThickSlices(const Grid& grid);

/// How far each slice was moved within its plane, mm along i and j, one per plane of constant k;
/// empty: not at all.
using SliceShifts = std::vector<Eigen::Vector2d>;

/// The left ventricle's long axis, in a stack whose slices are put straight.
struct LongAxis {
  Point centre = Point::Zero();        ///< of the cavity, RAS mm
  Vector direction = Vector(0, 0, 1);  ///< towards the apex, RAS, unit
  double base = 0, apex = 0;           ///< ends of the cavity along it, from the centre, mm
  double stackAngleDeg = 0;            ///< between it and the normal of the slices
  double spreadMm = 0;                 ///< root mean square distance of the centroids from it
  Grid grid;                           ///< of the slices
  SliceShifts shift;

  /// How far the slice of a point was moved, RAS mm.
  [[nodiscard]] Vector shiftAt(const Point& x) const;

  [[nodiscard]] double length() const { return apex - base; }
  /// Share of the way from base to apex: 0 to 1 within the cavity.
  [[nodiscard]] double share(const Point& x) const {
    return ((x - shiftAt(x) - centre).dot(direction) - base) / length();
  }
  /// Point of the axis at the height of x, moved as the slice of x.
  [[nodiscard]] Point foot(const Point& x) const {
    const Vector moved = shiftAt(x);
    return centre + (x - moved - centre).dot(direction) * direction + moved;
  }
};

/// The line through the centroids of slabs of the cavity across the line itself, found by
/// iteration; it begins with the centroids of closed rings where slices are thick, else with the
/// cavity's longest extent.  (Centroids of oblique slices of an ellipsoid do not lie on its axis.)
/// The apex is at the end to which the cavity tapers.
/// @throws InvalidInput  no cavity
[[nodiscard]] LongAxis findLongAxis(const Volume<Label>& heart, const SliceShifts& shift = {});

/// The ends of another frame's cavity along a given axis, the rest as it is.
[[nodiscard]] LongAxis withEndsOf(LongAxis axis, const Volume<Label>& heart);

}  // namespace explica::ventricle
