// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Volume.h"
#include "Explica/Planar/Curve.h"

#include <vector>

namespace explica::planar {

/// A plane in the world and axes in it, by which its points have two coordinates in millimetres.
///
/// Axis x is the right-left axis laid into the plane (anterior-posterior where the plane stands
/// across it), and the origin is the plane's point nearest to the world's; so in an axial slice the
/// coordinates are RAS x and y themselves.
struct PlaneFrame {
  Point origin = Point::Zero();    ///< RAS, mm
  Vector axisX = Vector::UnitX();  ///< unit
  Vector axisY = Vector::UnitY();  ///< unit, across axisX
  [[nodiscard]] Point toWorld(const Point2& p) const {
    return origin + p.x() * axisX + p.y() * axisY;
  }
  [[nodiscard]] Point2 toPlane(const Point& world) const {
    return {axisX.dot(world - origin), axisY.dot(world - origin)};
  }
};

/// Frame of slice k of a grid.
[[nodiscard]] PlaneFrame frameOfSlice(const Grid& grid, int k);

struct ContourOptions {
  double smoothing = 0.6;  ///< Gaussian deviation, in voxels, that anti-aliases a label's mask
};

/// Closed contours of a scalar slice at a level, by linear interpolation on cell edges.
///
/// Counter-clockwise in the slice's plane frame around values above the level, clockwise around
/// holes; sorted by area, largest first.  Values beyond the grid's rim count as far below the
/// level, so that every contour closes.
[[nodiscard]] std::vector<Curve> contoursOfSlice(const Volume<float>& field, int k, double level);

/// Contours of a label in a slice: the 1/2 level of its smoothed mask, sub-pixel.
/// @throws InvalidInput  slice out of range, or label absent from it (says where it is)
[[nodiscard]] std::vector<Curve> contoursOfLabel(const Volume<Label>& labels, Label label, int k,
                                                 const ContourOptions& options = {});

/// The slice that holds most voxels of the label; -1 if none does.
[[nodiscard]] int largestSlice(const Volume<Label>& labels, Label label);

/// The closed curve by `edges` edges of equal arc length along the given one.
[[nodiscard]] Curve resampled(const Curve& curve, int edges);

}  // namespace explica::planar
