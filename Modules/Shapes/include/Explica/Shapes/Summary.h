// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Results.h"
#include "Explica/Shapes/HarmonicAnnulus.h"

namespace explica::shapes {

/// Targets as level sets of harmonic functions, in numbers.
struct EmbedSummary {
  int dimension = 0;
  std::size_t targets = 0;
  Eigen::Index coefficients = 0;
  double innerRadius = kNaN, outerRadius = kNaN;  ///< of the annulus, mm
  int order = 0;
  double width = kNaN;  ///< of the annulus, mm
  double voxel = kNaN;  ///< of the grid, mm
  double boundaryMargin = kNaN;
  Change symmetricDifference = {kNaN, kNaN};  ///< of the first target's fit; mm^2 or mm^3
  std::optional<double> distanceMean = kNaN, distanceMax = kNaN;  ///< mm, of a single target
};

void describe(Results& t, const EmbedSummary& s);

}  // namespace explica::shapes
