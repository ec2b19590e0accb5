// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Describe.h"
#include "Explica/Planar/Curve.h"

#include <array>
#include <cstddef>
#include <vector>

namespace explica::planar {

/// Double integral of 1/|x - y| over two edges with its gradients, mm; no unit for gradients.
struct EdgePairIntegral {
  double value = 0;
  std::array<Point2, 4> gradient = {Point2::Zero(), Point2::Zero(), Point2::Zero(),
                                    Point2::Zero()};  ///< by a, b, c, d
};

/// Edges (a, b) and (c, d) without a common point.  With x = O + s u, y = O + t w, O where their
/// lines meet and R = |x - y|, G = s ln(t - s u.w + R) + t ln(s - t u.w + R) has the mixed
/// derivative 1/R, so the integral is G differenced at the four ends: exact.  Where the lines are
/// so nearly parallel that O is far and digits would cancel, one integral is taken exactly and the
/// other by Gauss rules on panels that shrink toward the other edge.
/// Infinite if the edges touch along a line, large but finite if they touch in a point.
[[nodiscard]] EdgePairIntegral apartEdgesIntegral(const Point2& a, const Point2& b, const Point2& c,
                                                  const Point2& d);

/// The same by panels alone: slower, for any position of the edges; the closed form's check.
[[nodiscard]] EdgePairIntegral apartEdgesQuadrature(const Point2& a, const Point2& b,
                                                    const Point2& c, const Point2& d);

/// Edges (a, b) and (b, d) that share b.  With S, T their lengths and R = |d - a|,
///
///     integral = S ln((S + T + R)/(R + S - T)) + T ln((S + T + R)/(R + T - S)),
///
/// finite unless the edges fold onto each other.  gradient: by a, b, (zero), d.
[[nodiscard]] EdgePairIntegral joinedEdgesIntegral(const Point2& a, const Point2& b,
                                                   const Point2& d);

/// Knot energy and how it changes with the vertices.
struct PolygonKnotValue {
  double value = 0;       ///< mm
  Positions2 gradient;    ///< V x 2, no unit; zero rows at vertices that do not move
  std::size_t pairs = 0;  ///< edge pairs integrated one by one
};

/// How the repulsive (knot) energy is evaluated.
enum class PolygonKnot {
  Auto,      ///< every pair up to four million, the tree beyond, whose time grows as n log n
  Tree,      ///< far clusters by charge and second moments; errs by about openingRatio^3
  AllPairs,  ///< every pair of edges, exactly
  Off        ///< no knot energy
};
constexpr auto enumWords(PolygonKnot) {
  using enum PolygonKnot;
  return std::to_array<EnumWord<PolygonKnot>>(
      {{Auto, "auto"}, {Tree, "tree"}, {AllPairs, "all-pairs"}, {Off, "off"}});
}

/// Self-repulsion of a polygon, [Thesis, Eq. 4.19] with the weight of its first sum corrected:
///
///     E = sum_i (|C_i| ln|C_i| - |C_i|) + 1/2 sum_{i != j} integral integral 1/|x - y|,
///
/// of which the terms count that have an edge with a moving vertex: what the rest adds is constant.
/// The finite part of (1/2) integral integral 1/|x - y| gives the first sum the weight 1; printed
/// is 2.  With 1, splitting an edge leaves E unchanged, as it must; with 2 it does not.
///
/// To be minimised: motion descends the gradient.  The plane's twin of repulsion::KnotEnergy.
/// Results do not depend on the number of threads.
class PolygonKnotEnergy {
 public:
  /// @param moving        V flags
  /// @param openingRatio  tree only: cluster radius over distance below which it is taken as a
  ///                      whole
  /// @throws InvalidInput  flags of another size, opening ratio not in (0, 1)
  PolygonKnotEnergy(PolygonKnot method, const Curve& curve, std::vector<bool> moving,
                    double openingRatio = 0.25);

  /// @param positions  V x 2; vertices that do not move must be where they were at construction
  /// @return all 0 for Off
  [[nodiscard]] PolygonKnotValue evaluate(const Positions2& positions) const;

 private:
  PolygonKnot method_;
  bool closed_;
  std::vector<bool> moving_;
  double openingRatio_ = 0;  ///< 0: every pair by itself
};

}  // namespace explica::planar
