// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Describe.h"
#include "Explica/Core/Monitor.h"
#include "Explica/Core/Volume.h"
#include "Explica/Segmentation/Atlas.h"
#include "Explica/Segmentation/Tissue.h"

#include <array>
#include <cstdint>

namespace explica::segmentation {

/// Tissue that touches the hemisphere but is no part of it: the other hemisphere's white matter
/// across the corpus callosum, the brain stem.  Neither inner nor outer boundary of the ribbon.
inline constexpr Label kCut = 4;

/// How a hemisphere is taken out of a segmented brain.
struct HemisphereOptions {
  Side side = Side::Left;  ///< Left or Right
  double coreDepth = 2;    ///< least distance of a ventricle's voxels to cortical labels, mm
};

template <class Visitor>
void describe(HemisphereOptions& options, Visitor&& visit) {
  visit(Field{"hemisphere", "", "which hemisphere to take out"}, options.side);
  visit(Field{"core-depth", "mm", "least distance of the ventricles' voxels to cortical labels"},
        options.coreDepth);
}

/// One hemisphere's voxels, and counts of what was done to get them.
struct Hemisphere {
  Volume<Label> labels;      ///< kWhite: white matter, filled; kGrey: ribbon; kCsf; kCut; 0 outside
  Volume<float> whiteShare;  ///< share of (filled) white in each voxel; 0.5 is the white surface
  Volume<float> tissueShare;  ///< share of white and grey; 0.5 is the pial surface
  std::int64_t whiteVoxels = 0;
  std::int64_t greyVoxels = 0;
  std::int64_t deepVoxels = 0;       ///< of deep structures, filled into the white matter
  std::int64_t ventricleVoxels = 0;  ///< enclosed fluid and its rim, filled
  std::int64_t cavityVoxels = 0;     ///< other enclosed voxels, filled
  std::int64_t strayVoxels = 0;      ///< not connected, or far from white matter; dropped
};

/// White matter and grey ribbon of one hemisphere, by an atlas in the image's space.
///
/// A brain voxel belongs to the side (or to the cerebellum) of the nearest labelled voxel.  The
/// brain stem, which AAL does not label, is what lies unlabelled below the thalamus and between the
/// medial borders of the left and right hippocampus, amygdala, parahippocampal, lingual and
/// fusiform labels in the same coronal plane, and not nearer to other cortex, whose rim an atlas
/// may leave unlabelled; so the image's axes must be near the atlas's (RAS within about 20
/// degrees), unless it is labelled. Ventricles are unlabelled non-white voxels at least `coreDepth`
/// from cortical labels whose component touches a deep structure and not the brain's outside, or
/// that are nearer to a ventricle of the atlas (labelVentricles) than to cortex and the outside, by
/// steps through such voxels.  Grey matter within 8 mm of hippocampus and amygdala is filled with
/// them where they are nearer than the outside, by ways through grey matter, which is more than 4
/// mm away.
///
/// @param atlas  labels on the segmentation's grid; 0 is unlabelled
/// @throws InvalidInput  atlas on another grid, side Both, no white or no grey voxel found
[[nodiscard]] Hemisphere extractHemisphere(const TissueSegmentation& tissue,
                                           const Volume<Label>& atlas, const AtlasLegend& legend,
                                           const HemisphereOptions& options = {},
                                           const Monitor& monitor = {});

/// Both at once, left first, whatever `options.side` says: sooner than one after the other, and the
/// same.
/// @throws InvalidInput  as extractHemisphere
[[nodiscard]] std::array<Hemisphere, 2> extractHemispheres(const TissueSegmentation& tissue,
                                                           const Volume<Label>& atlas,
                                                           const AtlasLegend& legend,
                                                           const HemisphereOptions& options = {},
                                                           const Monitor& monitor = {});

/// Gives the brain stem of an atlas that does not label it a label of its own (see
/// extractHemisphere), so that it stays known where the atlas is turned or bent.
/// @return the label; 0 if there is none, because the atlas has no thalamus
Label labelStem(Volume<Label>& atlas, AtlasLegend& legend);

/// Gives the ventricles of a template whose atlas does not label them labels of their own, a deep
/// structure on each side, so that they stay known where the template is bent onto a brain: what is
/// unlabelled, as dark as fluid, off the brain's border and its cortex, and joined to deep
/// structures.  After labelStem(), whose label the cisterns around the stem have.
/// @param brain  the template's T1 without skull, on the atlas's grid
void labelVentricles(const Volume<float>& brain, Volume<Label>& atlas, AtlasLegend& legend);

/// 1 where a label is, 0 elsewhere.
[[nodiscard]] Volume<std::uint8_t> maskOf(const Volume<Label>& labels, Label label);

/// Labels on another grid: the nearest voxel's, 0 beyond the source.  Labels are not interpolated.
[[nodiscard]] Volume<Label> resampleLabels(const Volume<Label>& labels, const Grid& grid);

}  // namespace explica::segmentation
