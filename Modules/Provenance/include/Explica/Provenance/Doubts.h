// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

namespace explica::provenance {

/// Something about an input that is cut, guessed or contradicted, so that results hang on it.
/// Commands that can meet it state how often they did, under this key of summary.json; reports and
/// study tables show those that are not 0.
struct Doubt {
  const char* key;
  const char* what;     ///< heading of a report's line
  const char* meaning;  ///< what the number counts
};

inline constexpr const char* kTissueAtImageBorder = "tissue_at_image_border";
inline constexpr const char* kHemisphereCutByGuess = "hemisphere_cut_by_guess";
inline constexpr const char* kLabelsUnknown = "labels_unknown";
inline constexpr const char* kHeadersDisagree = "headers_disagree";
inline constexpr const char* kPlacementsAssumed = "placements_assumed";
inline constexpr const char* kFramesNotStated = "frames_not_stated";
inline constexpr const char* kInputsChanged = "inputs_changed";
inline constexpr const char* kInputsContradict = "inputs_contradict";
inline constexpr const char* kWhiteUnlikeTemplate = "white_unlike_template";

inline constexpr std::array kDoubts = {
    Doubt{kTissueAtImageBorder, "Tissue at the image's border",
          "voxels of tissue in the outermost layer of the image, which may cut it off"},
    Doubt{kHemisphereCutByGuess, "Hemispheres parted by a guess",
          "voxel faces of white matter along a cut that no label draws"},
    Doubt{kLabelsUnknown, "Labels unknown",
          "labels that programs of this preset do not use, taken to lie outside the tissue"},
    Doubt{kHeadersDisagree, "Header disagrees with itself",
          "volumes whose qform and sform place the voxels differently, one chosen by --xform"},
    Doubt{kPlacementsAssumed, "Placement assumed",
          "volumes whose header does not say where the voxels lie"},
    Doubt{kFramesNotStated, "Coordinate system of a surface unknown",
          "surfaces whose file does not state it, taken to be scanner mm"},
    Doubt{kInputsChanged, "Input changed since it was made",
          "files that differ from what the record beside them says was written"},
    Doubt{kInputsContradict, "Inputs contradict each other",
          "pairs of files of two hemispheres or meshes, accepted by the user"},
    Doubt{kWhiteUnlikeTemplate, "Tissue unlike the template's",
          "voxels of pieces of at least 0.5 ml that are deep white matter in the template and "
          "other tissue in the image, which was believed"}};

}  // namespace explica::provenance
