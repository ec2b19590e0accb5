// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Correspondence/Correspondence.h"

#include <array>
#include <cstdint>
#include <vector>

namespace explica::correspondence {

/// Distance from the edge, in thicknesses, within which it may change measures: see nearImageEdge.
inline constexpr double kEdgeReach = 1.25;

/// Marks voxels whose measures the image's edge may change; they hold if it cuts the tissue at a
/// right angle.
///
/// The interpolant is solved as if no flux crossed the edge.  Where tissue runs on, what the edge
/// adds to u falls as exp(-pi d / t) with the distance d from the edge in a layer of thickness t.
/// So a voxel is marked if it, or an end of its trajectory, is nearer than 1.25 t, where the rest
/// is two per cent of the disturbance, to a tissue voxel on the edge; and if it has no thickness
/// and one of the two boundaries is farther away than the edge: the way there leaves the image
/// first.
/// @param axes  of the grid whose edges count, by i, j, k
/// @return per tissue voxel 1 or 0; empty if no tissue is on the edge
[[nodiscard]] std::vector<std::uint8_t> nearImageEdge(const harmonic::Annulus& annulus,
                                                      const std::array<bool, 3>& axes,
                                                      const Correspondence& correspondence);

}  // namespace explica::correspondence
