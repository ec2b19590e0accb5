// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Results.h"
#include "Explica/Sphere/Register.h"

#include <vector>

namespace explica::sphere {

/// How people are averaged.
struct AverageOptions {
  int iterations = 10;  ///< at most
  RegisterOptions registration;
};

template <class Visitor>
void describe(AverageOptions& options, Visitor&& visit) {
  visit(Field{"iterations", "", "times that all people are registered to their mean, at most", 1,
              100},
        options.iterations);
  describe(options.registration, visit);
}

/// The mean of people's spheres and folds.
struct SphereAverage {
  FoldingSphere folding;  ///< on the grid: means, and of ten people or more deviations between them
  std::vector<Positions> registered;  ///< of each person: the sphere's vertices on the template, mm
  std::vector<double> deformation;  ///< mean over the grid of the mean deformation, degrees, after
                                    ///< each iteration
  double correlation = kNaN;        ///< of sulcal depth with the mean, mean over the people
  Termination termination = Termination::NotRun;
};

/// Averages people's spheres and folds without favour for any of them: the template on which each
/// person's own, rotated sphere is deformed by the identity in the mean.
///
/// All are registered to the mean of the iteration before, at first to the person whose folds are
/// of middle depth, so that the order of the people does not matter.  At each
/// vertex of the grid the mean of the places that it has on the people's spheres, rotated onto it
/// as well as a rotation can, is where the next template has its folds [Guimond2000].  It ends
/// where that mean is less than 0.05 degrees from the vertex, in the mean over all.  The people's
/// spheres are moved along with the last template, so that on it the mean is the vertex.
///
/// @param people  two at least
/// @param grid    a sphere about the origin, of the template's vertices
/// @throws InvalidInput  fewer than two people; as registerSphere()
[[nodiscard]] SphereAverage averageSpheres(std::vector<FoldingSphere> people,
                                           const TriangleMesh& grid,
                                           const AverageOptions& options = {},
                                           const Monitor& monitor = {});

/// A template in numbers; of both hemispheres what is worse.
struct AverageSummary {
  std::int64_t people = 0;
  double deformation = kNaN;  ///< degrees
  double correlation = kNaN;

  void add(const SphereAverage& hemisphere);
};
void describe(Results& t, const AverageSummary& summary);

/// Mean of people's surfaces with the same vertices, each moved rigidly to the mean [Gower1975].
/// @param shapes  of each person, V x 3; one at least
[[nodiscard]] Positions meanShape(const std::vector<Positions>& shapes);

}  // namespace explica::sphere
