// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Types.h"
#include "Explica/Core/Volume.h"

#include <Eigen/Geometry>

namespace explica::registration {

/// Where each point of an image lies in a template, RAS mm: T(x) = A (x + u(x)).  The displacement
/// u is known on a grid in the image's space, interpolated between its voxels and constant beyond
/// its border; without one, T is A.
struct HeadTransform {
  Eigen::Affine3d affine = Eigen::Affine3d::Identity();
  Volume<Eigen::Vector3f> displacement;  ///< mm; may be empty

  [[nodiscard]] Point operator()(const Point& inImage) const;
};

/// The longest over the shortest stretch of an affine map along any direction: 1 if it keeps
/// proportions.
[[nodiscard]] double stretchOf(const Eigen::Affine3d& affine);

/// Angle of the rotation in an affine map, degrees.
[[nodiscard]] double turnOf(const Eigen::Affine3d& affine);

/// The template's scalars on a grid in the image's space: trilinear, 0 beyond the template.
[[nodiscard]] Volume<float> pulled(const Volume<float>& inTemplate, const HeadTransform& transform,
                                   const Grid& grid);

/// The template's labels on a grid in the image's space: the nearest voxel's, 0 beyond.
[[nodiscard]] Volume<Label> pulled(const Volume<Label>& inTemplate, const HeadTransform& transform,
                                   const Grid& grid);

}  // namespace explica::registration
