// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Describe.h"
#include "Explica/Core/VoxelSets.h"
#include "Explica/Harmonic/Annulus.h"

#include <array>
#include <optional>
#include <string>
#include <vector>

namespace explica::ventricle {

/// The labels of all functions of this module.
inline constexpr Label kOutside = 0, kCavity = 1, kWall = 2, kRight = 3;

/// Known conventions of short-axis segmentations.
enum class Preset {
  Automatic,  ///< the one that fits the values and what the wall encloses
  Acdc,       ///< 1 right ventricle, 2 wall, 3 cavity [Bernard2018]
  Mms,        ///< 1 cavity, 2 wall, 3 right ventricle [Campello2021]
  Ukbb,       ///< as Mms [Bai2018]
  None        ///< the labels are given
};
constexpr auto enumWords(Preset) {
  using enum Preset;
  return std::to_array<EnumWord<Preset>>(
      {{Automatic, "auto"}, {Acdc, "acdc"}, {Mms, "mms"}, {Ukbb, "ukbb"}, {None, "none"}});
}

struct HeartLabelOptions {
  Preset preset = Preset::Automatic;
  std::optional<Label> cavity =
      std::nullopt;  ///< of the left ventricle; any given label overrides the preset
  std::optional<Label> wall = std::nullopt;   ///< left ventricle's muscle
  std::optional<Label> right = std::nullopt;  ///< right ventricle's cavity
};

template <class Visitor>
void describe(HeartLabelOptions& options, Visitor&& visit) {
  visit(Field{"preset", "", "convention of the labels (auto: the one that fits, or a refusal)"},
        options.preset);
  visit(Field{"cavity", "", "label of the left ventricle's cavity"}, options.cavity);
  visit(Field{"wall", "", "label of the left ventricle's wall"}, options.wall);
  visit(Field{"rv", "", "label of the right ventricle"}, options.right);
}

/// Which label is what.
struct HeartRoles {
  Label cavity = kCavity, wall = kWall;
  std::optional<Label> right;
  std::string how;  ///< "acdc", "mms or ukbb", "given", ...
};

/// Finds out which label is what.  Where the values allow several conventions, the cavity is the
/// label that the wall encloses within the slices.
/// @param frames  at least one
/// @throws InvalidInput  no wall or no cavity in any frame, or more than one convention fits
[[nodiscard]] HeartRoles findRoles(const std::vector<Volume<Label>>& frames,
                                   const HeartLabelOptions& options = {});

/// A frame with this module's labels; what has no role is outside.
[[nodiscard]] Volume<Label> relabelled(const Volume<Label>& frame, const HeartRoles& roles);

/// Pieces of the left ventricle that lack cavity or wall and touch no piece with both become
/// outside: one voxel of cavity far away would open its slice.  A frame without wall stays.
/// @return their voxels
std::int64_t takeOutIslands(Volume<Label>& heart);

}  // namespace explica::ventricle
