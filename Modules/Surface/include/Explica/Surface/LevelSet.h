// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Volume.h"

#include <algorithm>
#include <array>
#include <cstdint>

namespace explica::surface {

/// A boundary with sub-voxel position: the zero of a scalar that is positive inside.
///
/// Values are without unit, in [-1, 1]: twice a share of the voxel, less one, or a distance.
using LevelSet = Volume<float>;

/// A sign's least magnitude: a lattice point is never nearer to the surface than this share of
/// an edge whose other end has level 1.
inline constexpr float kLeastLevel = 0.05F;

/// What lengths are counted in where they are given in voxels: the finest spacing, mm.
[[nodiscard]] inline double voxelSize(const Grid& grid) {
  return grid.spacing.minCoeff();
}

/// Voxels of the smallest box that holds every voxel of `mask` that is not 0, widened by `margin`
/// voxels; the box may reach beyond the volume.
struct VoxelBox {
  std::array<int, 3> low = {0, 0, 0};
  std::array<int, 3> size = {0, 0, 0};  ///< all 0 if the mask is empty
};
[[nodiscard]] VoxelBox boundingBox(const Volume<std::uint8_t>& mask, int margin);

/// The lattice of a box.
[[nodiscard]] Grid gridOf(const Grid& grid, const VoxelBox& box);

/// Part of a volume; voxels beyond it get `outside`.
[[nodiscard]] Volume<std::uint8_t> crop(const Volume<std::uint8_t>& volume, const VoxelBox& box,
                                        std::uint8_t outside = 0);
[[nodiscard]] Volume<float> crop(const Volume<float>& volume, const VoxelBox& box, float outside);

/// Level set of a mask without its staircase.
///
/// The boundary is the smoothest surface that leaves every voxel's centre on its own side
/// (harmonic::LabelBoundary); the level is the distance to it, 1 at two voxels of the coarsest axis
/// and beyond, and nowhere less than kLeastLevel times the ratio of the finest spacing to the
/// coarsest: so thin sheets and strands of one voxel survive.  Threaded; deterministic.
[[nodiscard]] LevelSet levelSetOf(const Volume<std::uint8_t>& mask);

/// Level set of shares in [0, 1] whose 0.5 is the boundary: 2 p - 1, kept off zero.
[[nodiscard]] LevelSet levelSetOf(const Volume<float>& share);

/// What 1 is of a level that is a distance: two of the longest spacings, mm.
[[nodiscard]] double bandOf(const Grid& grid);

/// The level set of the same zero that a mask's would be: the distance to it, 1 at two voxels of
/// the coarsest axis and beyond.  Shares say nothing of how far their border is once they are 0
/// or 1.
[[nodiscard]] LevelSet distanceLevelOf(const LevelSet& level);

/// A level's value so far from 0 that it has a side; 0 counts as inside.
[[nodiscard]] inline float offZero(float value) {
  constexpr float kOffZero = 1e-3F;
  return value >= 0 ? std::max(value, kOffZero) : std::min(value, -kOffZero);
}

/// Trilinear value and gradient (per mm, world axes) of a level set; beyond the lattice the nearest
/// border cell's.
struct LevelSample {
  double value = 0;
  Vector gradient = Vector::Zero();
};
[[nodiscard]] LevelSample sample(const LevelSet& level, const Point& world);

}  // namespace explica::surface
