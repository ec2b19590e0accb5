// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Volume.h"
#include "Explica/Segmentation/Tissue.h"

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace explica::segmentation {

/// A number of a head or cortex and the range within which it can be believed, limits included.
struct Limit {
  std::string_view name;    ///< as users write it to accept what lies outside
  std::string_view what;    ///< the number in words, to begin a sentence with
  std::string_view unit;    ///< "ml", "mm"; empty if none
  double low, high;         ///< infinite where one side is open
  std::string_view remedy;  ///< what to look at, to end the sentence with
  std::string_view source;  ///< where the limits are from
};

/// All limits, in the order in which a head meets them.
[[nodiscard]] std::span<const Limit> limits();

/// @throws InvalidInput  no limit has this name; lists the names
[[nodiscard]] const Limit& limitNamed(std::string_view name);

/// The names that users accept, checked.
/// @throws InvalidInput  as limitNamed
void checkAccepted(const std::vector<std::string>& accepted);

/// A number outside of its limits.
struct Flag {
  std::string name;
  double value = 0;
  double low = 0, high = 0;
  bool accepted = false;  ///< the user knows and wants to go on
  std::string sentence;
};

/// Compares a number with its limits; one that is not finite lies outside.
/// @return nothing if it lies within
/// @throws InvalidInput  no limit has this name
[[nodiscard]] std::optional<Flag> judge(std::string_view name, double value,
                                        const std::vector<std::string>& accepted = {});

/// Of all pairs of face neighbours that are both not 0, the share that are equal: near 1 in a map
/// of labels, small in an image with noise.  0 where there is no such pair.
[[nodiscard]] double equalNeighbours(const Volume<float>& image);
[[nodiscard]] double equalNeighbours(const Volume<Label>& labels);

/// True for what can be no map of labels: more than 64 values, and neighbours that mostly differ.
[[nodiscard]] bool looksLikeImage(const Volume<Label>& labels);

/// True for what can be no image: whole numbers only, and neighbours that are mostly the same.
[[nodiscard]] bool looksLikeLabels(const Volume<float>& image);

/// Share of voxels below -500, where only air and lung lie in Hounsfield units, and no magnitude
/// image has anything.
[[nodiscard]] double airInHounsfieldUnits(const Volume<float>& image);

/// Whether the dark tissue lies outside and the bright one inside: how often the voxels of the rim
/// are fluid or grey matter, against all of the brain, over the same of white matter: a brain may
/// be stripped so tightly that its only fluid lies deep.  The rim is what lies within 5 % of the
/// radius of a ball of the brain's volume.  Far above 1 in a T1, far below where the contrast is
/// inverted. NaN if there is no white matter or nothing else.
[[nodiscard]] double rimContrast(const Volume<Label>& tissues);

/// Share of the outer border of grey matter, by the area of voxel faces, that is the edge of the
/// brain mask or of the image and not fluid: there the image does not show where the cortex ends.
/// @param tissues  1 fluid, 2 grey, 3 white matter, 0 outside
/// @return NaN if grey matter touches neither
[[nodiscard]] double greyAtMaskEdge(const Volume<Label>& tissues);

/// The noise's deviation over the difference of white matter's and fluid's means.
[[nodiscard]] double noiseOfContrast(const TissueSegmentation& tissue);

/// Share of the brain that is a fifth brighter than white matter, the brightest tissue of a T1:
/// arteries by inflow, or vessels and membranes with contrast agent.
/// @param intensity  the image that was segmented, on the grid of the tissues
[[nodiscard]] double brighterThanWhite(const Volume<float>& intensity,
                                       const TissueSegmentation& tissue);

}  // namespace explica::segmentation
