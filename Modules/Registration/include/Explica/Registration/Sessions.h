// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Monitor.h"
#include "Explica/Core/Volume.h"

#include <Eigen/Geometry>

#include <vector>

namespace explica::registration {

/// How one image of a head lies in another of the same head.
struct RigidRegistration {
  Eigen::Isometry3d motion = Eigen::Isometry3d::Identity();  ///< from a's points to b's, RAS mm
  double gain = 1;         ///< of b's brightness, so that it is a's
  double correlation = 0;  ///< of both halfway between them, within the head, on the finest level
};

/// Brings two images of one head together by a rotation, a translation and a gain.
///
/// Starts from the rotation nearest to registerAffine()'s map.  Then the squared difference of both
/// images, each resampled halfway, falls by Gauss-Newton steps, coarse to fine, with Tukey's weight
/// of each voxel, so that what moved against the skull has no say [Reuter2010].  Both images are
/// treated alike: exchanged, they give the inverse up to the start's rounding.
/// @throws InvalidInput  an image without contrast
[[nodiscard]] RigidRegistration registerRigidly(const Volume<float>& a, const Volume<float>& b,
                                                const Monitor& monitor = {});

/// Images of one person, all in one space.
struct SessionAverage {
  std::vector<Eigen::Isometry3d> toSession;  ///< from the average's points to each session's
  std::vector<Volume<float>> sessions;       ///< on the average's grid, as bright as the first
  Volume<float> mean;                        ///< of these
  double leastCorrelation = 1;               ///< RigidRegistration::correlation with the first
};

/// Brings sessions of a person into a space without favour for any: the one whose rotations to the
/// sessions average to none, and which has the head's centre in the mean of its places.  All are
/// resampled once, by cubic convolution, onto cubes of the smallest spacing among them, so that
/// all are blurred alike [Reuter2012].
///
/// @param sessions  two at least
/// @throws InvalidInput  fewer than two; as registerRigidly()
[[nodiscard]] SessionAverage averageSessions(const std::vector<Volume<float>>& sessions,
                                             const Monitor& monitor = {});

}  // namespace explica::registration
