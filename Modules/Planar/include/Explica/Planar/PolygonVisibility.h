// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Planar/Curve.h"

#include <utility>
#include <vector>

namespace explica::planar {

/// From where a curve is looked at: points with weights that sum to 1.
///
/// One point is the thesis's viewpoint; a line of viewpoints (thesis chapter 6) is its quadrature.
/// The plane's twin of visibility::Viewpoints.
struct Viewpoints {
  std::vector<Point2> points;   ///< mm
  std::vector<double> weights;  ///< > 0, sum 1

  Viewpoints() = default;
  template <class Derived>
  Viewpoints(const Eigen::MatrixBase<Derived>& point) : points{Point2(point)}, weights{1.0} {}
  Viewpoints(double x, double y) : Viewpoints(Point2(x, y)) {}
  Viewpoints(std::vector<Point2> p, std::vector<double> w)
      : points(std::move(p)), weights(std::move(w)) {}

  [[nodiscard]] bool operator==(const Viewpoints& other) const = default;
};

/// Average flux of a region and how it changes with the vertices.
struct PolygonVisibility {
  double average = 0;        ///< E, in [-1, 1]: total flux over length, [Thesis, Eq. 4.10]
  double variance = 0;       ///< of the flux along the region, (1/L) integral f^2 ds - E^2
  double length = 0;         ///< L, mm
  Eigen::VectorXd edgeFlux;  ///< mean flux of each region edge, in [-1, 1], in the region's order
  Positions2 gradient;       ///< V x 2, 1/mm, of the average: [Thesis, Eq. 4.14]
};

/// Total flux of one edge, [Thesis, Eq. 4.11], mm, and its gradients.
struct EdgeFlux {
  double flux = 0;        ///< integral over the edge of f = (x - P)/|x - P| . N, N to the left
  double squareFlux = 0;  ///< integral of f^2
  Point2 byStart = Point2::Zero();
  Point2 byEnd = Point2::Zero();
};

/// Flux through the edge from a to b of rays from `viewpoint`.  With h the signed distance of the
/// viewpoint to the edge's line and r0, r1 those to its ends,
///
///     flux = h ln((r0 + r1 + |C|) / (r0 + r1 - |C|)),
///
/// which equals [Thesis, Eq. 4.11] and keeps its digits when the viewpoint lies near the line.
[[nodiscard]] EdgeFlux edgeFlux(const Point2& a, const Point2& b, const Point2& viewpoint);

/// Average visibility of a region from a viewpoint with its exact gradient.
///
/// The gradient ascends.  [Thesis, Eq. 53] prints gamma/|C|^2 where gamma/|C| is right; derivatives
/// here are of the form above and agree with the corrected equation.
/// Of several viewpoints all members are the weighted means of theirs; the variance is that within
/// the views, not between them.
/// @throws InvalidInput  empty region, or no viewpoint
[[nodiscard]] PolygonVisibility polygonVisibility(const Curve& curve, const Region& region,
                                                  const Viewpoints& view);

}  // namespace explica::planar
