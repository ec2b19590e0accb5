// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Shapes/Summary.h"

namespace explica::shapes {

void describe(Results& t, const EmbedSummary& s) {
  t.number("distance_mean", "Mean distance from the target", "mm",
           "The larger of both ways between shape and target.", s.distanceMean)
      .inHead();
  constexpr double kClose = 0.05;  // of the annulus's inner radius
  t.number("distance_max", "Largest distance from the target", "mm", "", s.distanceMax)
      .atMost(kClose * s.innerRadius, Judgement::Look, "a twentieth of the inner radius")
      .inHead();
  t.change(
       "symmetric_difference", "Symmetric difference", "",
       "What one of shape and target holds and the other does not: mm^2 of a plane, mm^3 of space.",
       s.symmetricDifference)
      .inHead();
  t.count("dimension", "Dimension", "", s.dimension);
  t.count("targets", "Targets", "", s.targets).inHead();
  t.count("coefficients", "Coefficients", "Of both boundaries.", s.coefficients);
  t.number("inner_radius", "Inner radius of the annulus", "mm", "", s.innerRadius).inHead();
  t.number("outer_radius", "Outer radius of the annulus", "mm", "", s.outerRadius).inHead();
  t.count("order", "Highest angular frequency", "", s.order).inHead();
  t.number("annulus_width", "Width of the annulus", "mm", "", s.width);
  t.number("voxel", "Voxel of the grid", "mm", "", s.voxel);
  t.number("boundary_margin", "Margin of the boundary values", "",
           "Of 1/2, which they must not reach.", s.boundaryMargin);
}

}  // namespace explica::shapes
