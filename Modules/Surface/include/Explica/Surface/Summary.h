// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Results.h"
#include "Explica/Geometry/MeshTopology.h"
#include "Explica/Surface/CorticalSurface.h"
#include "Explica/Surface/Measures.h"

#include <array>
#include <optional>
#include <string>

namespace explica::surface {

/// What every surface must be, measured on it.
struct SurfaceCheck {
  double area = kNaN;                   ///< mm^2
  std::optional<double> volume = kNaN;  ///< mm^3; of closed ones
  Evenness evenness;
  std::int64_t selfIntersections = 0;  ///< pairs of faces
  geometry::MeshCondition condition;
};
[[nodiscard]] SurfaceCheck checkOf(const TriangleMesh& mesh);

/// Thickness by both measures over the area of the middle surface, mm.
struct ThicknessMeans {
  std::string measure;  ///< that mean and sd are of: "trajectory" or "nearest"
  double mean = kNaN, sd = kNaN;
  double trajectory = kNaN, nearest = kNaN;
};
[[nodiscard]] ThicknessMeans thicknessMeansOf(const CorticalSurfaces& made, bool nearest);

/// 1 at vertices where the thickness is defined and known, else 0.
[[nodiscard]] Eigen::VectorXd validOf(const CorticalSurfaces& made);

/// 1 where the image leaves a border more than half a voxel of standard deviation, else 0; empty
/// without image.
[[nodiscard]] Eigen::VectorXd doubtfulOf(const CorticalSurfaces& made);

/// Millilitres, from a newborn's to the largest adult's [Gilmore2007].
inline constexpr double kLeastCerebrum = 250, kMostCerebrum = 2000;

/// White, middle and outer surface in numbers.
struct SurfaceSummary {
  bool given = false;                                 ///< by the user, not made
  const TissueFacts* tissue = nullptr;                ///< that they are made of; must outlive this
  const CorticalSurfaces* made = nullptr;             ///< must outlive this
  std::array<std::optional<SurfaceCheck>, 3> checks;  ///< white, middle, outer
  bool hasGrey = true;
  std::optional<double> bareShare = kNaN;  ///< of white matter's border
  double smallestAngleDeg = kNaN;          ///< 5th percentile over the white surface's faces
  std::optional<ThicknessMeans> thickness = ThicknessMeans{};
  bool hasImage = true;
  std::optional<double> secondMoved = kNaN;  ///< mm: a second image's way onto the first, farthest
  std::optional<std::size_t> regions = 0;
  std::optional<double> cerebrumVolume = kNaN;  ///< ml, both sides; of human labels

  /// Self-intersections of all surfaces.
  [[nodiscard]] std::int64_t meetings() const;
};

void describe(Results& t, const SurfaceSummary& s);

}  // namespace explica::surface
