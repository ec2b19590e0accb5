// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Planar/Curve.h"

namespace explica::planar {

/// A polygon with a folded region and the viewpoint from which it is to be seen.
struct PolygonPhantom {
  Curve curve;    ///< counter-clockwise, simple; pixels
  int first = 0;  ///< the region's first vertex
  int last = 0;   ///< the region's last vertex
  Point2 viewpoint{0, 0};
};

/// An intricate region of 19 edges, of the kind of [Thesis, Fig. 4.17]: about 416 pixels long,
/// average visibility about 0.21, flux variance about 0.39.
[[nodiscard]] PolygonPhantom makePolygon19();

/// A highly convoluted region of 34 edges, of the kind of [Thesis, Fig. 4.18]: about 724 pixels
/// long, average visibility about 0.17, flux variance about 0.69.
[[nodiscard]] PolygonPhantom makePolygon34();

}  // namespace explica::planar
