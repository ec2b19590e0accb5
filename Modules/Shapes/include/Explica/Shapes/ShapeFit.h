// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Describe.h"
#include "Explica/Core/Monitor.h"
#include "Explica/Core/Termination.h"
#include "Explica/Shapes/HarmonicAnnulus.h"

#include <optional>
#include <vector>

namespace explica::shapes {

/// A target's boundary as points, each for a piece of it.
struct TargetSamples {
  Positions points;         ///< P x 3, mm; z = 0 in the plane
  Eigen::VectorXd weights;  ///< length (mm) or area (mm^2) of each piece
};

/// What is known of an annulus that targets are to lie in; the rest is taken from them.
struct AnnulusOptions {
  std::optional<Eigen::Vector3d> centre;  ///< mm; unset: mean of the targets' centres
  std::optional<double> innerRadius;      ///< mm; unset: 0.85 of the nearest target point's
  std::optional<double> outerRadius;      ///< mm; unset: 1.15 of the farthest target point's
  std::optional<int> order;               ///< unset: 64 in the plane, 14 in space
};

template <class Visitor>
void describe(AnnulusOptions& options, Visitor&& visit) {
  visit(Field{"center", "mm", "default: mean of the targets' points"}, options.centre);
  visit(Field{"inner-radius", "mm", "default: 0.85 of the nearest target point"},
        options.innerRadius);
  visit(Field{"outer-radius", "mm", "default: 1.15 of the farthest target point"},
        options.outerRadius);
  visit(Field{"order", "", "highest angular frequency; default 64 in 2D, 14 in 3D", 0, 1000},
        options.order);
}

/// The annulus about targets of a dimension, 2 or 3, that leaves some room on both sides of them.
/// @throws InvalidInput  no target, or options that make no annulus
[[nodiscard]] HarmonicAnnulus annulusAround(const std::vector<TargetSamples>& targets,
                                            int dimension, const AnnulusOptions& options = {});

struct ShapeFitOptions {
  int samples = 2000;  ///< points of the target's boundary that are fitted; taken by the caller
  int maxIterations = 200;
  double start = 0.5;  ///< where the concentric initial estimate lies: u on it in the harmonic
                       ///< function that is 0 on the inner and 1 on the outer boundary
  double step = 0.5;   ///< share of the way to each iteration's optimum; 1 is the full step
  double smoothness = 1e-9;  ///< weight of the boundary values' mean square slope, against the
                             ///< fit's mean weight
};

template <class Visitor>
void describe(ShapeFitOptions& options, Visitor&& visit) {
  visit(Field{"samples", "", "points of each target's boundary that are fitted", 16, 1e7},
        options.samples);
  visit(Field{"max-iterations", "", "iterations of the fit", 0, 1e6}, options.maxIterations);
  visit(Field{"fit-start", "",
              "initial estimate: 0 near the inner boundary, 1 near the outer one; the fit does not "
              "hang on it",
              0.01, 0.99},
        options.start);
}

struct ShapeFitIteration {
  double symmetricDifference = 0;  ///< area (mm^2) or volume (mm^3) between shape and target
  double distanceMean = 0;         ///< of the target's points from the shape, mm
  double distanceMax = 0;          ///< mm
};

struct ShapeFit {
  HarmonicShape shape;
  std::vector<ShapeFitIteration> history;  ///< first entry is the initial estimate
  std::vector<HarmonicShape> path;         ///< the shape at every entry
  Termination termination = Termination::NotRun;
};

/// Finds the coefficients whose 1/2 level has the smallest set-symmetric difference to a target,
/// starting from a concentric shape.
///
/// A target says what u is on it, not elsewhere: each frequency has two boundary values and one
/// equation.  Of all u that fit equally well the one with the smoothest boundary values is taken,
/// with their means 1 apart.  It is unique (for given weights the problem is strictly convex), so
/// that averages mean something: turned and mirrored targets have turned and mirrored
/// coefficients, and circles of radii a and b average to that of radius sqrt(a b), spheres to that
/// of radius 2 / (1/a + 1/b).
///
/// To first order the set between the level and the target is the integral over the target of the
/// distance |u - 1/2| / |grad u|; its minimum is found by re-weighted least squares.  Unknowns are
/// the positive amplitudes of a constant and of bumps of boundary values, below 1/2 on the inner
/// and above 1/2 on the outer boundary, so that the result and all its convex combinations are one
/// closed component. The annulus should not be much wider than the target: details fade with the
/// distance from a boundary.
/// @throws InvalidInput  a target point outside the annulus, or an option out of range
[[nodiscard]] ShapeFit fitShape(const HarmonicAnnulus& annulus, const TargetSamples& target,
                                const ShapeFitOptions& options = {}, const Monitor& monitor = {});

/// Weighted mean of shapes of one annulus: weights are divided by their sum.
/// @throws InvalidInput  no shape, another number of weights, a negative weight, weights that are
///                       all zero, or different annuli
[[nodiscard]] HarmonicShape combine(const std::vector<HarmonicShape>& shapes,
                                    const std::vector<double>& weights);

}  // namespace explica::shapes
