// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Describe.h"
#include "Explica/Core/Monitor.h"
#include "Explica/Core/Termination.h"
#include "Explica/Core/TriangleMesh.h"
#include "Explica/Sphere/OneToOne.h"

namespace explica::sphere {

/// A spherical mesh with what is known of the folds at its vertices.
struct FoldingSphere {
  TriangleMesh sphere;
  Eigen::VectorXd sulc, curvature;      ///< V
  Eigen::VectorXd sulcSd, curvatureSd;  ///< V, of a template's people; empty if not known
};

/// How spheres are brought together.
struct RegisterOptions {
  double smoothness = 4.5;  ///< a of registerSphere()
  double maxAreal = 2;      ///< m of MapWeights
  int level = 6;            ///< of the finest icosphere, 10 * 4^level + 2 vertices
  bool rotate = true;       ///< start from rotations, too
};

template <class Visitor>
void describe(RegisterOptions& options, Visitor&& visit) {
  visit(Field{"smoothness", "", "weight of kept areas and angles against agreement of folds",
              kAboveZero, 1e6},
        options.smoothness);
  visit(Field{"max-areal", "log2", "largest change of areas allowed, in doublings", 0.1, 20},
        options.maxAreal);
  visit(
      Field{"level", "", "finest icosphere on which the map is moved: 10 * 4^N + 2 vertices", 3, 7},
      options.level);
  visit(
      Field{"rotate", "", "start from rotations among all, not only from the spheres as they are"},
      options.rotate);
}

/// Correlation of folding maps over the sphere's area.
struct FoldingCorrelation {
  double sulc = kNaN, curvature = kNaN;
};

/// A sphere on another's.
struct SphereRegistration {
  Positions positions;              ///< V x 3, mm, single precision: the moving sphere's vertices
  Eigen::VectorXd arealLog2;        ///< V: log2 of the map's areas after over before
  Eigen::VectorXd sulc, curvature;  ///< V: the target's folds where the vertices have come to
  FoldingCorrelation before, after;
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();  ///< nearest to the map
  OneToOne rounding;
  int iterations = 0;
  Termination termination = Termination::NotRun;
};

/// Brings a sphere onto another's by the folds, one to one.
///
/// The vertices x_i of an icosphere in the target's frame move to places y_i of the moving sphere
/// that lower
///
///     sum_i A_i sum_maps (s(y_i) - t(x_i))^2 / v(x_i)  +  a * energy of MapWeights
///
/// A the mean of a place's shares of both spheres, so that the inverse map has the same energy,
/// s and t the maps of both, each of mean 0 and variance 1, v the template's variance over its mean
/// or 1; by Gauss-Newton steps on icospheres from coarse to fine, maps smoothed alike.  They start
/// from the identity and from the rotations, among ones spread evenly over all [Alexa2022], after
/// which the folds agree best; on each level those of least energy go on.  Coarse levels are
/// searched from both sides, and the inverses of what is found from the other side go on beside
/// the own maps, so that both directions come to rest in one place.  (The best rotation alone
/// can be a fold off: how well folds agree is known only once they have moved.)  Faces keep
/// their sides and areas change by less than `maxAreal` doublings there, so that the map is one to
/// one.  The moving sphere's vertices follow by its inverse, linear on faces; the few faces that
/// this turns over, needles over a bend, are mended by makeOneToOne().
[[nodiscard]] SphereRegistration registerSphere(const FoldingSphere& moving,
                                                const FoldingSphere& target,
                                                const RegisterOptions& options = {},
                                                const Monitor& monitor = {});

/// The sphere mirrored at x = 0, faces outwards again: a left one as if it were a right one.
[[nodiscard]] TriangleMesh mirrored(TriangleMesh sphere);

}  // namespace explica::sphere
