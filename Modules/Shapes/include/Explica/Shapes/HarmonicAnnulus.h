// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Types.h"

namespace explica::shapes {

/// Where a point lies with respect to an annulus.
enum class AnnulusSide {
  Enclosed,  ///< within the inner boundary
  Inside,    ///< between both
  Beyond     ///< outside the outer boundary
};

/// The annulus between two concentric circles (dimension 2, in the plane z = 0) or spheres, and the
/// harmonic functions on it that a finite number of boundary values determines.
struct HarmonicAnnulus {
  int dimension = 3;             ///< 2 or 3
  Point centre = Point::Zero();  ///< mm
  double innerRadius = 0;        ///< mm, > 0
  double outerRadius = 0;        ///< mm
  int order = 0;                 ///< highest angular frequency of a boundary's values

  /// Coefficients of one boundary: 2 order + 1 in the plane, (order + 1)^2 in space.
  [[nodiscard]] int perBoundary() const {
    return dimension == 2 ? 2 * order + 1 : (order + 1) * (order + 1);
  }
};

/// A shape: the 1/2 level of u = sum_j alpha_j u_j, [Thesis, Eq. 3.5].
///
/// Instead of one function per grid point of a boundary, u_j is the harmonic function that equals
/// an angular function Y_j on one boundary and 0 on the other, which is known in closed form: in
/// the plane Y = 1, cos t, sin t, cos 2t, sin 2t, ... ; in space the real spherical harmonics by
/// degree l and order m = -l .. l, scaled to a mean square of 1.  Linear as (3.5) is: averages and
/// convex combinations are those of the coefficients.
struct HarmonicShape {
  HarmonicAnnulus annulus;
  Eigen::VectorXd inner;  ///< values on the inner boundary, by Y_j; below 1/2 everywhere on it
  Eigen::VectorXd outer;  ///< values on the outer boundary, by Y_j; above 1/2 everywhere on it
};

/// True if harmonic functions of both have the same meaning: their coefficients may be added.
[[nodiscard]] bool sameAnnulus(const HarmonicAnnulus& a, const HarmonicAnnulus& b);

/// Where a point lies.
[[nodiscard]] AnnulusSide sideOf(const HarmonicAnnulus& annulus, const Point& point);

/// Distance between the boundaries, mm.
[[nodiscard]] double widthOf(const HarmonicAnnulus& annulus);

/// Throws unless the annulus makes sense.
/// @throws InvalidInput  names the member, what was found and what is needed
void requireUsable(const HarmonicAnnulus& annulus);

/// Basis functions at points: P x 2 perBoundary(), inner ones first.  Points off the annulus take
/// the value of the nearest boundary.
[[nodiscard]] Eigen::MatrixXd basisAt(const HarmonicAnnulus& annulus, const Positions& points);

/// u at points; threaded.
[[nodiscard]] Eigen::VectorXd valuesAt(const HarmonicShape& shape, const Positions& points);

using SampleRows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Angular functions on a lattice of directions, `perOrder` times `order` of them on each great
/// circle through the poles: S x perBoundary().
[[nodiscard]] SampleRows boundarySamples(const HarmonicAnnulus& annulus, int perOrder);

/// A lower bound of 1/2 - u on the inner and u - 1/2 on the outer boundary, whichever is less.
///
/// Positive means: u < 1/2 on all of the inner and u > 1/2 on all of the outer boundary, not only
/// at samples (between the samples of a function of bounded frequency its range can grow by a
/// known factor only [Ehlich1964]).  Then the maximum principle makes {u < 1/2} and {u > 1/2}
/// connected, each with its boundary, so that the 1/2 level is one closed curve or surface; and the
/// same holds for every convex combination, whose boundary values lie on the same sides.
[[nodiscard]] double boundaryMargin(const HarmonicShape& shape);

}  // namespace explica::shapes
