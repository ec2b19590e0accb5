// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Describe.h"
#include "Explica/Core/Monitor.h"
#include "Explica/Core/Termination.h"
#include "Explica/Core/TriangleMesh.h"
#include "Explica/Sphere/OneToOne.h"

#include <string_view>
#include <vector>

namespace explica::sphere {

/// How a closed surface is brought onto a sphere.
struct SphereMapOptions {
  double balance = 0.75;    ///< w of MapWeights: areas against angles
  double tolerance = 1e-4;  ///< a level ends where a step promises less, of the energy
  int maxIterations = 100;  ///< of the finest level
};

template <class Visitor>
void describe(SphereMapOptions& options, Visitor&& visit) {
  visit(Field{"balance", "", "weight of kept areas against kept angles", kAboveZero, 1e6},
        options.balance);
  visit(Field{"tolerance", "",
              "an iteration that promises to lower the energy by less than this share is the last",
              kAboveZero, 1},
        options.tolerance);
  visit(Field{"max-iterations", "", "Newton iterations on the whole surface at most", 1, 1e6},
        options.maxIterations);
}

/// One level of the way from coarse to fine.
struct SphereLevel {
  Eigen::Index vertices = 0;
  int iterations = 0;
  double energy = kNaN;  ///< mean over the area, at its end
  double seconds = 0;
};

/// A surface on a sphere.
struct SphereMap {
  Positions positions;              ///< V x 3, mm, single precision
  OneToOne rounding;                ///< what rounding asked for
  std::vector<SphereLevel> levels;  ///< coarsest first
  int iterations = 0;
  Termination termination = Termination::NotRun;
};

/// @param name  of the surface, starts the message
/// @throws InvalidInput  not closed, more than one piece, or handles
void requireSphere(const TriangleMesh& mesh, std::string_view name);

/// Maps a closed surface of genus 0 one to one onto a sphere, with the least distortion by
/// MapWeights' energy.
///
/// Vertices are taken out down to a tetrahedron and put back one after another in the reverse
/// order, each where it sees all of its neighbours, so that no face ever turns over [Praun2003]; on
/// some levels between all are moved by projected Newton steps that keep faces positive.  The
/// result is rounded to single precision, as files hold it, and is one to one after that.  It is
/// turned so that directions from the centre agree with those of the surface as well as they can.
/// @param mesh  oriented outwards
/// @throws InvalidInput  not closed, more than one piece, or handles
[[nodiscard]] SphereMap mapToSphere(const TriangleMesh& mesh, const SphereMapOptions& options = {},
                                    const Monitor& monitor = {});

/// What a map of a surface to a sphere does to areas and shapes.  Means and quantiles are over the
/// surface's area.
struct SphereDistortion {
  /// F: log2 of a face's share of the sphere's area over its share of the surface's; NaN without
  /// area, as the stretch.
  Eigen::VectorXd arealLog2;
  Eigen::VectorXd stretch;                   ///< F: largest over smallest, >= 1
  double arealMean = kNaN, arealMax = kNaN;  ///< of |log2|
  double stretchMedian = kNaN, stretchP95 = kNaN;
  std::int64_t turnedOver = 0;  ///< exact
};
[[nodiscard]] SphereDistortion sphereDistortion(const TriangleMesh& surface,
                                                const Positions& sphere);

/// Mean of a value of faces at each vertex, weighed by area; NaN counts as none.
[[nodiscard]] Eigen::VectorXd meansAtVertices(const TriangleMesh& mesh,
                                              const Eigen::VectorXd& ofFaces);

/// Rotation of `moving` after which its directions agree best with those of `fixed`, weighed
/// [Kabsch1976].
[[nodiscard]] Eigen::Matrix3d bestRotation(const Positions& moving, const Positions& fixed,
                                           const Eigen::VectorXd& weights);

}  // namespace explica::sphere
