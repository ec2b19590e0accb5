// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Describe.h"
#include "Explica/Core/Monitor.h"
#include "Explica/Core/Volume.h"
#include "Explica/Surface/LevelSet.h"

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace explica::surface {

/// Which half of the brain.
enum class Side { Left, Right };
constexpr auto enumWords(Side) {
  return std::to_array<EnumWord<Side>>({{Side::Left, "L"}, {Side::Right, "R"}});
}

/// What the labels of a volume mean.
enum class LabelPreset {
  Auto,        ///< told by the labels that are present
  Aseg,        ///< FreeSurfer's aseg, aparc+aseg, aparc.a2009s+aseg, wmparc; SynthSeg, FastSurfer
  Ribbon,      ///< FreeSurfer's and the Human Connectome Project's ribbon: 2, 3, 41, 42
  ThreeClass,  ///< 1 fluid, 2 grey, 3 white, 4 neither (a cut), as `explica segment` writes
  Ants,        ///< six classes of antsCorticalThickness
  Dhcp,        ///< nine classes of the developing Human Connectome Project
  Dhcp87,      ///< its 87 structures
  Nmt,         ///< five classes of the NIMH Macaque Template, version 2; never guessed
  LayNii,      ///< LayNii's rim: border lines 1 and 2, grey matter 3
  Wm,          ///< FreeSurfer's wm (5 and more are white) or filled (127 right, 255 left)
  None         ///< white and grey are named
};
constexpr auto enumWords(LabelPreset) {
  using enum LabelPreset;
  return std::to_array<EnumWord<LabelPreset>>({{Auto, "auto"},
                                               {Aseg, "aseg"},
                                               {Ribbon, "ribbon"},
                                               {ThreeClass, "three-class"},
                                               {Ants, "ants"},
                                               {Dhcp, "dhcp"},
                                               {Dhcp87, "dhcp-87"},
                                               {Nmt, "nmt"},
                                               {LayNii, "laynii"},
                                               {Wm, "wm"},
                                               {None, "none"},
                                               // What people look for by the program's name.
                                               {Aseg, "synthseg"},
                                               {Aseg, "fastsurfer"},
                                               {Ribbon, "hcp"}});
}

/// How labels become the inner and outer boundary of a cortical ribbon.
struct TissueOptions {
  LabelPreset preset = LabelPreset::Auto;
  std::vector<Label> white;      ///< enclosed region; empty: the preset's
  std::vector<Label> grey;       ///< ribbon; empty: the preset's
  std::vector<Label> fill;       ///< joined to white: deep structures, ventricles; empty: preset's
  std::vector<Label> insulated;  ///< neither inside nor outside; empty: the preset's
  std::optional<Side> hemisphere;
  bool noFill = false;      ///< leave the preset's deep structures and ventricles out
  bool closeEdges = false;  ///< tissue may end at the edge of the field of view
};

/// What a ribbon's tissue is, and was made of.
struct TissueFacts {
  std::string structure;                   ///< "CortexLeft", "CortexRight", "Cortex"
  LabelPreset preset = LabelPreset::None;  ///< as used
  std::int64_t whiteVoxels = 0;            ///< labelled white
  std::int64_t filledVoxels = 0;           ///< joined to it
  std::int64_t greyVoxels = 0;
  std::int64_t cutContact = 0;       ///< voxel faces between the hemispheres where white was cut
  std::int64_t atImageBorder = 0;    ///< white and grey voxels in the image's outermost layer
  std::vector<Label> unknownLabels;  ///< that the preset's programs do not use; ascending
};

/// Voxels of one cortical ribbon; what is none of the three lies outside.
struct TissueMasks : TissueFacts {
  Volume<std::uint8_t> white;      ///< with what is joined to it
  Volume<std::uint8_t> grey;       ///< between white matter and what lies outside
  Volume<std::uint8_t> insulated;  ///< neither inside nor outside
};

/// Boundaries of one cortical ribbon on a box around it.
struct CorticalTissue : TissueFacts {
  LevelSet white;                  ///< positive in white matter
  LevelSet tissue;                 ///< positive in white and grey matter
  Volume<std::uint8_t> insulated;  ///< 1 where neither side is; same box
  bool hasGrey = true;
  bool ofLabels = false;      ///< the boundaries come of labels: signs say all
  bool byBrightness = false;  ///< the boundaries come of shares, not of labels
};

/// Voxels of a ribbon from labels.
///
/// A preset's hemisphere is taken by its labels; labels without side (callosum, white-matter
/// hypointensities) go to the nearer hemisphere's.  Where both hemispheres share one label, white
/// matter is parted where waves from both sides, 10 mm and more away from the plane that holds
/// least white matter, meet within white matter: so the cut crosses the callosum near its middle,
/// and gyri that bulge over the plane stay whole.
///
/// @throws InvalidInput  no label of a list present, both hemispheres present and none chosen,
/// nothing left
///                       after separation: with the numbers found
[[nodiscard]] TissueMasks masksFromLabels(const Volume<Label>& labels,
                                          const TissueOptions& options = {},
                                          const Monitor& monitor = {});

/// True if grey matter runs out of the image, as in a block of tissue or a slab: more than one in a
/// hundred of its voxels lie on the image's edge.
[[nodiscard]] bool runsOutOfImage(const TissueMasks& masks);

/// True if the tissue wants sheets with a rim (TissueSheet.h) instead of closed surfaces: it runs
/// out of the image, or it is one of LayNii's rims, which end where somebody stopped drawing.
[[nodiscard]] bool isBlock(const TissueMasks& masks);

/// Boundaries of voxels.
/// @param closeEdges  white matter may end at the edge of the field of view
/// @throws InvalidInput  white matter at the edge of the field of view, with how many voxels
[[nodiscard]] CorticalTissue tissueFromMasks(const TissueMasks& masks, bool closeEdges = false,
                                             const Monitor& monitor = {});

/// Share, by area, of white matter's voxel faces to what is neither white nor insulated that have
/// no grey matter on the other side; 0 for an empty tissue.
[[nodiscard]] double bareShare(const CorticalTissue& tissue);

/// The tissue with a voxel of grey matter wherever white matter lies bare beside what is neither,
/// but for the largest such place.  Cortex is one sheet with one hole, at the medial wall;
/// elsewhere a classifier has taken all of a thin, myelinated cortex for white matter.
[[nodiscard]] CorticalTissue withCortexAllAround(CorticalTissue tissue);

/// Both in one.
[[nodiscard]] CorticalTissue tissueFromLabels(const Volume<Label>& labels,
                                              const TissueOptions& options = {},
                                              const Monitor& monitor = {});

/// Boundaries from shares of each voxel in [0, 1]; 0.5 is the boundary.
/// @param white      share of (filled) white matter
/// @param tissue     share of white and grey matter together; empty grid: white only
/// @param insulated  labels or mask, not 0 where neither side is; empty grid: nowhere.  If given,
/// the
///                   shares hold one hemisphere and `hemisphere` only names it
/// @throws InvalidInput  grids differ, or as tissueFromLabels
[[nodiscard]] CorticalTissue tissueFromShares(const Volume<float>& white,
                                              const Volume<float>& tissue,
                                              const Volume<std::uint8_t>& insulated = {},
                                              const TissueOptions& options = {},
                                              const Monitor& monitor = {});

/// Shares from any scalar that crosses a level at the boundary.
///
/// Without `level`, values that are never negative are shares of their largest value, and the
/// boundary is at one half; others are distances in mm, and the boundary is at 0.  Inside is the
/// side that holds the smaller part of the volume's border: so the sign of distances does not
/// matter.
/// @throws InvalidInput  the level is nowhere crossed; names the values' range
[[nodiscard]] Volume<float> sharesOf(Volume<float> scalars, std::optional<double> level,
                                     const std::string& name);

/// Sum of two shares on one grid, at most 1.
/// @throws InvalidInput  grids differ
[[nodiscard]] Volume<float> addShares(const Volume<float>& a, const Volume<float>& b);

/// Side of each voxel of a white-matter mask that holds both hemispheres: 0 off the mask, 1 left,
/// 2 right.
/// @throws InvalidInput  one side has less than a tenth of the voxels
[[nodiscard]] Volume<std::uint8_t> splitHemispheres(const Volume<std::uint8_t>& white,
                                                    const Monitor& monitor = {});

}  // namespace explica::surface

namespace explica {

namespace surface {

template <class Visitor>
void describe(TissueOptions& options, Visitor&& visit) {
  visit(Field{"preset", "", "what the labels mean"}, options.preset);
  visit(Field{"white-label", "", "labels of white matter (default: the preset's)"}, options.white);
  visit(Field{"grey-label", "", "labels of grey matter (default: the preset's)"}, options.grey);
  visit(Field{"fill", "",
              "labels joined to white matter, such as deep structures and ventricles (default: the "
              "preset's)"},
        options.fill);
  visit(
      Field{"insulated", "", "labels that are neither inside nor outside (default: the preset's)"},
      options.insulated);
  visit(Field{"hemisphere", "", "which hemisphere to take, where labels hold both"},
        options.hemisphere);
  visit(Field{"no-fill", "", "join nothing to white matter"}, options.noFill);
  visit(Field{"close-edges", "",
              "close the surface where tissue meets the edge of the field of view, instead of "
              "refusing"},
        options.closeEdges);
}

}  // namespace surface
}  // namespace explica
