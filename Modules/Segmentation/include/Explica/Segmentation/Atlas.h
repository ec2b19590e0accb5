// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Describe.h"
#include "Explica/Core/Volume.h"

#include <map>
#include <string>
#include <string_view>

namespace explica::segmentation {

/// Which half of the brain a structure lies in.
enum class Side { Both, Left, Right };
constexpr auto enumWords(Side) {
  using enum Side;
  return std::to_array<EnumWord<Side>>({{Both, "both"}, {Left, "L"}, {Right, "R"}});
}

/// What a structure of an atlas is to the cortex.
enum class StructureKind {
  Cortex,     ///< part of the folded ribbon
  Deep,       ///< enclosed by the white surface: basal ganglia, thalamus, hippocampus, amygdala
  BelowTent,  ///< cerebellum, vermis, brain stem: left out
  Stem,       ///< brain stem: cut off
  White       ///< white matter of a hemisphere: tells only the side
};

/// One label of an atlas.
struct AtlasStructure {
  std::string name;
  Side side = Side::Both;
  StructureKind kind = StructureKind::Cortex;
};

/// What the labels of an atlas mean.
using AtlasLegend = std::map<Label, AtlasStructure>;

/// A structure by its name: side from the name's end (_L, _R), kind from its beginning, as the AAL
/// atlas names them [TzourioMazoyer2002], or Deep_, White_, Below_ where that says it.
[[nodiscard]] AtlasStructure structureNamed(const std::string& name);

/// Reads a legend: one structure a line, "value name", anything after the name ignored; empty
/// lines, lines that start with '#' and BIDS's heading "index name" are skipped.  Side comes from
/// the name's end (_L, _R) and the kind from its beginning, as the AAL atlas names them
/// [TzourioMazoyer2002].
/// @param name  the legend's file, for messages
/// @throws InvalidInput  a line without value and name, a value named twice, or no cortical
/// structure
///                       of one side
[[nodiscard]] AtlasLegend parseAtlasLegend(std::string_view text, std::string_view name);

/// True if the labels are FreeSurfer's: white matter and cortex of both sides, by aseg's numbers or
/// aparc's.
[[nodiscard]] bool isFreeSurferAtlas(const Volume<Label>& labels);

/// What FreeSurfer's labels (aseg, aparc+aseg, aparc.a2009s+aseg) mean to a hemisphere.
[[nodiscard]] AtlasLegend freeSurferLegend();

/// What the labels of INIA19's atlas NeuroMaps mean [Rohlfing2012]: cortex by the names of its
/// gyri, the rest by what it is to the cortex.  A label of the right side is that of the left one
/// and 1000.
[[nodiscard]] AtlasLegend inia19Legend();

/// The labels of an atlas that its legend does not name become 0.
void keepNamed(Volume<Label>& atlas, const AtlasLegend& legend);

}  // namespace explica::segmentation
