// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Ventricle/HeartLabels.h"

#include <array>
#include <vector>

namespace explica::ventricle {

/// What a slice (a plane of constant k) shows of the left ventricle.
enum class SliceKind {
  Empty,       ///< neither cavity nor wall
  Ring,        ///< the wall encloses the cavity
  OpenRing,    ///< the cavity also touches what is outside: outflow tract, gap in the wall
  Valve,       ///< over so much of the outline that the valve plane cuts the slice
  Cap,         ///< wall without cavity
  CavityOnly,  ///< cavity without wall
};
constexpr auto enumWords(SliceKind) {
  using enum SliceKind;
  return std::to_array<EnumWord<SliceKind>>({{Empty, "empty"},
                                             {Ring, "ring"},
                                             {OpenRing, "open"},
                                             {Valve, "valve"},
                                             {Cap, "cap"},
                                             {CavityOnly, "cavity-only"}});
}

/// A slice and where its ring is open.  Lengths in mm along the grid's axes i and j, from voxel
/// (0, 0).
struct Slice {
  SliceKind kind = SliceKind::Empty;
  std::size_t cavity = 0, wall = 0;                  ///< voxels
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();  ///< of the cavity, else of the wall
  double openShare = 0;                   ///< of the cavity's outline that touches no wall
  std::vector<Eigen::Vector2d> contacts;  ///< middles of the pixel edges where it does not

  [[nodiscard]] bool whole() const {
    return kind == SliceKind::Ring || kind == SliceKind::OpenRing;
  }
};

/// From this share of a cavity's outline without wall on, a slice is not a ring with a gap but cut
/// by the valve plane: aortic outflow alone takes a quarter of the outline.
inline constexpr double kValveShare = 0.3;

/// @param heart  with this module's labels
/// @return one per plane of constant k
[[nodiscard]] std::vector<Slice> slicesOf(const Volume<Label>& heart);

/// How many slices between the first and the last one with cavity and wall lack one of both: their
/// labels are missing.
/// @param heart  with this module's labels
[[nodiscard]] std::int64_t missingSlices(const Volume<Label>& heart);

/// Voxels without a role that cavity and wall enclose within their slice, as papillary muscles that
/// nobody labelled: the cavity counts as open there.
/// @param heart  with this module's labels
[[nodiscard]] std::int64_t enclosedVoxels(const Volume<Label>& heart);

/// Share of the cavity's outer area, by voxel faces, that touches no wall: the base of a ventricle
/// and its openings; beyond the image counts as open.  0 of a closed shell, which is no ventricle.
/// @param heart  with this module's labels
[[nodiscard]] double openShareOf(const Volume<Label>& heart);

}  // namespace explica::ventricle
