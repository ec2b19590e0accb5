// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Describe.h"
#include "Explica/Core/Volume.h"

#include <functional>
#include <string>
#include <utility>
#include <vector>

namespace explica::harmonic {

/// What is known exactly at a point of a phantom's tissue.
struct ExactAnswer {
  double u = kNaN;                           ///< harmonic interpolant, 0 inside to 1 outside
  double innerDistance = kNaN;               ///< L0, mm along the trajectory
  double outerDistance = kNaN;               ///< L1, mm
  Point innerPoint = Point::Constant(kNaN);  ///< phi0
  Point outerPoint = Point::Constant(kNaN);  ///< phi1
  [[nodiscard]] double thickness() const { return innerDistance + outerDistance; }
};

/// A tissue whose boundaries and answers have formulas.  Points are RAS mm.
struct ExactAnnulus {
  std::function<double(const Point&)> innerLevel;   ///< mm near the boundary, negative inside
  std::function<double(const Point&)> outerLevel;   ///< mm near the boundary, negative inside
  std::function<bool(const Point&)> insulated;      ///< may be empty: nowhere
  std::function<ExactAnswer(const Point&)> answer;  ///< at any point of the tissue
  int dimension = 3;
};

/// Concentric spheres (3D) or circles (2D) about the origin: u = (1/a - 1/r)/(1/a - 1/b), or
/// ln(r/a)/ln(b/a).
[[nodiscard]] ExactAnnulus exactShell(double innerRadius, double outerRadius, int dimension = 3);

/// Two circles in the plane, the inner one's centre `offset` mm from the outer one's; bipolar
/// coordinates, trajectories sigma = const.  The outer circle's centre is the origin.
[[nodiscard]] ExactAnnulus exactEccentric(double innerRadius, double outerRadius, double offset);

/// Confocal prolate spheroids about the third axis, foci at +-focal: u ~ ln((xi-1)/(xi+1)) with
/// xi = cosh mu, trajectories eta = const.
[[nodiscard]] ExactAnnulus exactSpheroids(double focal, double innerSinh, double outerSinh);

/// A left ventricle: confocal spheroids with the apex down the third axis, insulated above the
/// plane z = base.  Exact but for the neighbourhood of that plane, which the trajectories cross
/// obliquely.
[[nodiscard]] ExactAnnulus exactVentricle(double focal, double innerSinh, double outerSinh,
                                          double base);

enum class PhantomKind { Shell, Eccentric, Spheroid, Ventricle };
constexpr auto enumWords(PhantomKind) {
  using enum PhantomKind;
  return std::to_array<EnumWord<PhantomKind>>({{Shell, "shell"},
                                               {Eccentric, "eccentric"},
                                               {Spheroid, "spheroid"},
                                               {Ventricle, "ventricle"}});
}

/// Size of a phantom; the radii are fixed in mm (see makePhantom).
struct PhantomOptions {
  int size = 128;      ///< voxels along each axis
  double spacing = 1;  ///< mm
};

template <class Visitor>
void describe(PhantomOptions& options, Visitor&& visit) {
  visit(Field{"size", "voxels", "voxels along each axis", 8, 4096}, options.size);
  visit(Field{"spacing", "mm", "voxel size"}, options.spacing);
}

/// A phantom on a grid: labels, level sets and answers.
struct Phantom {
  ExactAnnulus exact;
  Volume<Label> labels;
  std::vector<std::pair<std::string, Label>> labelNames;
  Volume<float> innerLevel, outerLevel;  ///< mm, negative inside
};

/// Shell: radii 20 and 30 mm.  Eccentric: circles of 10 and 25 mm, centres 5 mm apart, one slice.
/// Spheroid: focal distance 30 mm, sinh mu 0.5 and 1.  Ventricle: focal distance 40 mm, sinh mu 0.6
/// and 0.9, base 15 mm above the centre, a right ventricle beside it.  Centred on the grid.
/// Labels: 1 inner, 2 tissue, 0 outer, 3 right ventricle (outer), 4 beyond the base (insulated).
/// @throws InvalidInput  the phantom does not fit into size * spacing
[[nodiscard]] Phantom makePhantom(PhantomKind kind, const PhantomOptions& options = {});

/// A phantom's answers on its grid; 0 off the tissue (u: 0 inside, 1 outside).
struct PhantomAnswers {
  Volume<float> u, thickness, innerDistance, outerDistance;
  Volume<Eigen::Vector3f> innerPoint, outerPoint;  ///< RAS mm
};
[[nodiscard]] PhantomAnswers answersOf(const Phantom& phantom);

/// Grid of that size with its centre (between voxels if the size is even) at the origin.
[[nodiscard]] Grid centredGrid(const std::array<int, 3>& size, const Vector& spacing);

/// Samples a function of the world point at every voxel.
[[nodiscard]] Volume<float> sampled(const Grid& grid,
                                    const std::function<double(const Point&)>& function);

}  // namespace explica::harmonic
