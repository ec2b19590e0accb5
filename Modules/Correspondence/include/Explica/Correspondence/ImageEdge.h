// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Correspondence/Correspondence.h"

#include <array>
#include <cstddef>
#include <utility>

namespace explica::correspondence {

/// What tissue does at the edge of the image.
enum class ImageEdge {
  Open,      ///< it runs on: what lies beyond is not known
  Insulated  ///< trajectories slide along the edge, as if the tissue ended there
};

/// Distance from the edge, in thicknesses, within which measures are not believed: see leaveOutCut.
inline constexpr double kEdgeReach = 1.25;

/// Takes the measures of voxels away whose trajectories the image's edge bends or cuts.
///
/// The interpolant is solved as if no flux crossed the edge.  Where tissue runs on, that is wrong
/// beside it: what the edge adds to u falls as exp(-pi d / t) with the distance d from the edge in
/// a layer of thickness t.  So a voxel is left out (lengths and points NaN) if it, or an end of its
/// trajectory, is nearer than 1.25 t, where the rest is two per cent of the disturbance, to a
/// tissue voxel on the edge.
/// Voxels that have no thickness anyway count as cut, and no longer as missing, if one of the two
/// boundaries is farther away than the edge: the way there leaves the image first.
/// @param axes  of the grid whose edges count, by i, j, k
/// @return how many voxels the edge cuts
std::size_t leaveOutCut(const harmonic::Annulus& annulus, const std::array<bool, 3>& axes,
                        Correspondence& correspondence);

}  // namespace explica::correspondence

namespace explica {

template <>
struct EnumNames<correspondence::ImageEdge> {
  static constexpr std::array table{std::pair{correspondence::ImageEdge::Open, "open"},
                                    std::pair{correspondence::ImageEdge::Insulated, "insulated"}};
};

}  // namespace explica
