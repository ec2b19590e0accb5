// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/TriangleMesh.h"
#include "Explica/Harmonic/Annulus.h"
#include "Explica/Surface/CorticalTissue.h"

#include <array>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

namespace explica::surface {

/// Where a closed mesh crosses the lines through a grid's voxel centres along each axis, exactly
/// as often as its topology says: a line enters as often as it leaves.
class GridCrossings {
 public:
  GridCrossings(const TriangleMesh& mesh, const Grid& grid);

  [[nodiscard]] bool inside(const std::array<int, 3>& voxel) const;

  /// First and last crossing between a voxel and its neighbour along +axis, as shares of the
  /// spacing from the voxel; nothing if there is none.
  [[nodiscard]] std::optional<std::pair<double, double>> between(const std::array<int, 3>& voxel,
                                                                 int axis) const;

 private:
  struct Lines {
    std::vector<std::int64_t> first;  ///< per line: its crossings in `at`, ascending
    std::vector<float> at;            ///< voxels along the axis
  };
  [[nodiscard]] std::size_t lineOf(const std::array<int, 3>& voxel, int axis) const;
  [[nodiscard]] Lines along(const Positions& index, const Faces& faces, int axis) const;

  std::array<int, 3> size_;
  std::array<Lines, 3> lines_;
};

/// The tissue between a closed surface and the outer border of a tissue's level set.  White matter
/// thinner than a voxel cuts the links across it.
[[nodiscard]] harmonic::Annulus annulusBetween(const TriangleMesh& white,
                                               const CorticalTissue& tissue,
                                               const Monitor& monitor);

/// Whether an axis has voxels at least half as long again as the shortest.
[[nodiscard]] bool hasLongVoxels(const Grid& grid);

/// The tissue between two closed surfaces, on a grid whose voxels are nearly cubes: long ones are
/// split, since cortex is hardly thicker than they are long.  White matter and sulci thinner than a
/// voxel cut the links across them.
/// @param insulated  not 0 where neither side is; on the image's grid
[[nodiscard]] harmonic::Annulus annulusBetween(const TriangleMesh& white, const TriangleMesh& pial,
                                               const Volume<std::uint8_t>& insulated,
                                               const Monitor& monitor);

}  // namespace explica::surface
