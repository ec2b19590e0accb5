// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Parallel.h"
#include "Explica/Harmonic/Annulus.h"

#include <array>
#include <cstdint>
#include <functional>
#include <vector>

namespace explica::harmonic {

using Code = std::uint8_t;
constexpr Code codeOf(Site site) {
  return static_cast<Code>(site);
}
inline constexpr Code kTissueCode = codeOf(Site::Tissue);  // as the fields of sites hold it

// Closest that a boundary may come to a voxel's centre, in voxels: moves it by no more than that
// and keeps 1 / fraction well inside single precision.
inline constexpr double kSmallestFraction = 1e-4;

/// Part of a volume's index space: voxel (0, 0, 0) of the box is voxel `first` of the grid.
struct Box {
  std::array<int, 3> first{}, size{};
  [[nodiscard]] std::size_t count() const {
    return static_cast<std::size_t>(size[0]) * size[1] * size[2];
  }
  [[nodiscard]] std::size_t linear(int i, int j, int k) const {
    return i + static_cast<std::size_t>(size[0]) * (j + static_cast<std::size_t>(size[1]) * k);
  }
};

/// Smallest box around voxels for which `wanted(row, i)`, widened.
[[nodiscard]] Box boxAround(
    const Grid& grid, int margin,
    const std::function<void(std::size_t row, int& low, int& high)>& extentOfRow);

/// Refuses an empty volume, or voxels without size.
void checkGrid(const Grid& grid);

/// The box around the tissue and what its voxels are.
struct BoxOfSites {
  Grid grid;  ///< of the whole volume
  Box box;
  std::vector<Code> sites;
};

/// The box around the tissue of sites, widened.
[[nodiscard]] BoxOfSites boxOf(const Volume<Site>& sites, int margin);

/// visit(place in the box, i, j, k of the grid) for each of its voxels, slices beside each other.
template <class Visit>
void forVoxels(const Box& box, const Visit& visit) {
  parallelFor(box.size[2], 1, [&](std::size_t k) {
    std::size_t p = box.linear(0, 0, static_cast<int>(k));
    for (int j = 0; j < box.size[1]; ++j) {
      for (int i = 0; i < box.size[0]; ++i, ++p) {
        visit(p, i + box.first[0], j + box.first[1], static_cast<int>(k) + box.first[2]);
      }
    }
  });
}

/// Numbers the tissue and makes its links; fractions stay 1.
/// @param cutBits  per voxel and direction whether a boundary cuts that link, the inner one where
///                 `innerBits` says so; both may be empty
void number(Annulus& annulus, const std::vector<Code>& sites,
            const std::vector<std::uint8_t>& cutBits, const std::vector<std::uint8_t>& innerBits);

/// Where a boundary lies on the link from box voxel p, s its subscripts, in direction d: fraction
/// of the spacing.
using PlaceInBox =
    std::function<double(std::int32_t p, const std::array<int, 3>& s, int d, bool inner)>;

/// Sites of the box to the annulus.
[[nodiscard]] Annulus assemble(const Grid& grid, const Box& box, std::vector<Code> sites,
                               const PlaceInBox& placeOnLink, const AnnulusOptions& options,
                               const Monitor& monitor);

}  // namespace explica::harmonic
