// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Volume.h"

#include <cstdint>

namespace explica::segmentation {

/// Where image and template do not show the same tissue.
struct Disagreement {
  double share = 0;    ///< of the template's deep white matter within the brain, not white here
  double largest = 0;  ///< volume of its largest connected piece, mm^3
  double deepest = 0;  ///< radius of the largest ball that fits into it, mm
  Point middle = Point::Zero();  ///< of that ball, RAS mm
  std::int64_t voxels = 0;       ///< in pieces into which a ball of 5 mm fits
};

/// Which of the template's deep white matter the image shows as grey matter or fluid: a lesion,
/// wide ventricles, or a template that is in the wrong place.  The template is to be brought by its
/// affine map alone: a deformation would carry its fluid into a lesion.  What the map leaves of the
/// anatomy's differences is thin; so only pieces count into which a ball of 5 mm fits.  The classes
/// are the image's alone; the template is not asked when they are found, so that this drowns
/// nothing.  A voxel is white in the template if it is brighter there than half way between what
/// lies under this image's grey and white voxels, and deep if all is white within `depth`, so that
/// registration's errors of a few voxels do not count.
/// @param tissues   0 outside the brain, kCsf, kGrey, kWhite
/// @param expected  the template's T1 without skull, brought onto the same grid affinely
/// @param depth     mm
/// @throws InvalidInput  volumes on different grids
[[nodiscard]] Disagreement whiteDisagreement(const Volume<Label>& tissues,
                                             const Volume<float>& expected, double depth = 3);

}  // namespace explica::segmentation
