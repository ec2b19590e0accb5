// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Volume.h"

#include <functional>

namespace explica::registration {

/// Convolution with a Gaussian of this standard deviation, mm; what lies outside counts as the
/// border's value.  Not longer than three standard deviations.
[[nodiscard]] Volume<float> smoothed(Volume<float> volume, double sigma);

/// Mean over a box of 2 r + 1 voxels a side, cut at the border.
[[nodiscard]] Volume<float> boxMean(Volume<float> volume, int radius);

/// Trilinear value at a continuous index; `outside` beyond half a voxel from the voxels.
[[nodiscard]] float valueAt(const Volume<float>& volume, const Vector& index, float outside = 0);

/// Calls `work` for each plane k of the grid, in parallel.
void forPlanes(const Grid& grid, const std::function<void(int k)>& work);

/// Grid of cubes of this size along the axes of another, over a box of continuous indices of it.
[[nodiscard]] Grid cubicGrid(const Grid& like, const Vector& low, const Vector& high,
                             double spacing);

/// The volume on another grid, smoothed first as far as its voxels are smaller than the grid's.
/// 0 outside.
[[nodiscard]] Volume<float> resampled(const Volume<float>& volume, const Grid& grid);

/// The whole volume in cubes of this size, as resampled().
[[nodiscard]] Volume<float> inCubes(const Volume<float>& volume, double spacing);

/// Voxels in which there is a head, roughly: 1 where brighter than the mean, else 0.
[[nodiscard]] Volume<float> headOf(const Volume<float>& image);

/// Centre of the voxels above 0, RAS mm.
[[nodiscard]] Point centreOf(const Volume<float>& head);

}  // namespace explica::registration
