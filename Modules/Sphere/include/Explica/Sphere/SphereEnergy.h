// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Flattening/MapEnergy.h"
#include "Explica/Geometry/FaceSystem.h"

#include <Eigen/Geometry>

#include <vector>

namespace explica::sphere {

using flattening::RestFace;

/// What a map of a surface onto the unit sphere costs, per area:
///
///     psi = |J|^2 / (2 d)  +  w sqrt(((d - 1 / d) / 2)^2 + e^2)  -  b log(1 - (log2(d) / m)^2),
///
/// J the linear map of a face onto its flat image, d its signed ratio of areas.  The first term is
/// least, 1, for maps that keep angles, the second, w e, for maps that keep areas; both are
/// infinite at d = 0.  With e = 1 the second is w (d + 1 / d) / 2, and all areas give way a little;
/// with a small e it is w |d - 1 / d| / 2, and most are kept while few give way.  The last is
/// infinite where areas change by m doublings.
struct MapWeights {
  double balance = 1;            ///< w > 0
  double mostAreal = kInfinity;  ///< m > 0
  double barrier = 0;            ///< b >= 0
  double whole = 1;              ///< factor of the sum over faces
  bool symmetric = false;        ///< (1 + d) / 2 times psi: of the inverse map it is the same
  double corner = 1;             ///< e > 0
};

/// psi and its derivatives by S = |J|^2 and by d.
struct SphereDensity {
  double value = 0;
  double dS = 0, dD = 0;
  double dSD = 0, dDD = 0;  ///< psi is linear in S
};

/// @return value +infinity where psi has none
[[nodiscard]] SphereDensity sphereDensity(double squaredJacobian, double areaRatio,
                                          const MapWeights& weights);

/// The bend by d with which psi is convex in (J, d): its own, or the least.
[[nodiscard]] double convexDD(const SphereDensity& psi, double squaredJacobian);

/// A face's |J|^2 and d = det(y0, y1, y2) / (2 area), which is the ratio of areas up to the square
/// of the face's angle, and their derivatives by its corners.
struct SphereFace {
  double squaredJacobian = 0;
  double areaRatio = 0;
  std::array<Vector, 3> gradientS, gradientD;
};
[[nodiscard]] SphereFace sphereFace(const RestFace& rest, const std::array<Point, 3>& corners);

/// Two unit vectors across a direction, as columns.
using TangentFrame = Eigen::Matrix<double, 3, 2>;
[[nodiscard]] TangentFrame tangentFrame(const Vector& unit);

/// Sum over faces of their share of the area times psi, of unit vectors at the vertices.
class SphereEnergy {
 public:
  /// @param rest  F, of total area 4 pi
  SphereEnergy(Faces faces, std::vector<RestFace> rest, const MapWeights& weights);

  /// +infinity if a face is turned over or beyond its bound.
  [[nodiscard]] double value(const Positions& sphere) const;

  /// Gradient and a positive semi-definite approximation of the Hessian by the tangent coordinates
  /// of a face's corners.
  ///
  /// convexDD() keeps it convex in (J, d).  The bend of d, by which it fails to be convex in the
  /// corners, is split as d = |p|^2 - |q|^2, |J|^2 = 2 |p|^2 + 2 |q|^2 (z -> p z + q conj(z)), and
  /// only the part that is convex under the sign of psi_d stays [Shtengel2017].
  [[nodiscard]] geometry::FaceSystem::Term term(const Positions& sphere,
                                                const std::vector<TangentFrame>& frames,
                                                Eigen::Index face) const;

  /// Largest share in (0, 1] of a step that leaves every face a fifth of what it has to lose.
  [[nodiscard]] double largestStep(const Positions& sphere, const Positions& step) const;

  [[nodiscard]] const Faces& faces() const { return faces_; }
  [[nodiscard]] const std::vector<RestFace>& rest() const { return rest_; }
  [[nodiscard]] const MapWeights& weights() const { return weights_; }

 private:
  Faces faces_;
  std::vector<RestFace> rest_;
  std::vector<double> share_;  ///< of each face in the area
  MapWeights weights_;
};

/// Rest shapes of faces scaled to the total area 4 pi; needles get a thousandth of the mean edge
/// length as height.
[[nodiscard]] std::vector<RestFace> restOnUnitSphere(const flattening::IntrinsicMesh& mesh);

}  // namespace explica::sphere
