// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Planar/Curve.h"

#include <complex>
#include <vector>

namespace explica::shapes {

/// Where a point lies with respect to the annulus between two polygons.
enum class AnnulusSide {
  Enclosed,  ///< within the inner polygon
  Inside,    ///< between both
  Beyond     ///< outside the outer polygon
};

/// The conformal map w of the annulus between two polygons onto one between two concentric circles.
///
/// Harmonic functions stay harmonic under conformal maps: those of the given annulus are those of
/// the circular one, which are known in closed form, at w(z).  With a point c that the inner
/// polygon encloses,
///
///     w = (z - c) exp f(z),    f analytic and single-valued,
///
/// and ln|z - c| + Re f is constant on either polygon: R on the outer one, an unknown r on the
/// inner.  f is linear on each piece of an edge and obeys Cauchy's integral formula, whose
/// integrals over such pieces are exact [Hromadka1984]; its imaginary part at the nodes and r are
/// unknown, a system of second kind with a dense matrix.  The error falls with the square of the
/// pieces' length, and less fast beside inward corners of the annulus.
///
/// R is the radius of the circle of the outer polygon's area, and the mean of Im f on the outer
/// polygon is 0: two concentric circles are mapped by the translation that brings their centre to
/// 0.
class AnnulusMap {
 public:
  /// @param inner, outer  simple polygons, either orientation, mm; inner lies within outer
  /// @param pieces        of each boundary, at least; edges are divided so that none is much longer
  ///                      than the boundary's length over this number
  /// @throws InvalidInput  a polygon that is unusable or crosses itself, polygons that meet, or an
  ///                       inner one that is not enclosed
  AnnulusMap(const planar::Curve& inner, const planar::Curve& outer, int pieces = 400);

  [[nodiscard]] const planar::Curve& inner() const { return inner_; }
  [[nodiscard]] const planar::Curve& outer() const { return outer_; }
  [[nodiscard]] double innerRadius() const { return innerRadius_; }  ///< r, mm
  [[nodiscard]] double outerRadius() const { return outerRadius_; }  ///< R, mm

  /// Twice the area over the length of both boundaries: the distance between concentric circles.
  [[nodiscard]] double meanWidth() const;

  [[nodiscard]] AnnulusSide sideOf(const planar::Point2& point) const;

  /// w; of a point that is not inside, that of the boundary's nearest point.
  [[nodiscard]] planar::Point2 operator()(const planar::Point2& point) const;

 private:
  using Complex = std::complex<double>;

  /// Edges from one node to the next of either closed boundary.
  struct Piece {
    int from = 0;
    int to = 0;
    Complex inverse;  ///< of the step from one to the other
  };

  /// Coefficients by f(from) and f(to) of the integral of f / (zeta - z) over a piece, less the
  /// difference f(to) - f(from), which sums to zero around a boundary.
  struct Weights {
    Complex from;
    Complex to;
    [[nodiscard]] Complex sum() const { return from + to; }
  };
  /// ln((b - z)/(a - z)) of the piece from a to b, its imaginary part the angle it is seen under.
  [[nodiscard]] Complex logarithmOf(const Piece& piece, Complex z) const;
  [[nodiscard]] Weights weightsOf(const Piece& piece, Complex z) const;

  void addBoundary(const planar::Curve& curve, int pieces, bool reversed);
  void solve();
  [[nodiscard]] Complex nearestValue(Complex z, Complex& nearest) const;

  planar::Curve inner_;
  planar::Curve outer_;
  double innerRadius_ = 0;
  double outerRadius_ = 0;
  Complex centre_;
  std::size_t outerNodes_ = 0;  ///< the outer boundary's nodes and pieces come first
  std::vector<Complex> nodes_;  ///< the annulus lies to the left of the pieces
  std::vector<Piece> pieces_;
  std::vector<Complex> values_;  ///< f at the nodes
};

}  // namespace explica::shapes
