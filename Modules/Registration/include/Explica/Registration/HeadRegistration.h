// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Monitor.h"
#include "Explica/Registration/Deformation.h"
#include "Explica/Registration/HeadTransform.h"

namespace explica::registration {

/// A head of which brain and structures are known; all volumes on one grid.
struct Template {
  Volume<float> head;   ///< T1 with skull; empty if there is none
  Volume<float> brain;  ///< T1 without skull: 0 outside the brain
  Volume<Label> atlas;  ///< labels of structures
};

/// How a template lies in an image.
struct HeadRegistration {
  HeadTransform transform;
  double information = 0;  ///< of the affine part, 1 to 2; 0 if the transform was given
  Agreement agreement;     ///< of the whole
  Volume<float> brain;     ///< the template's brain mask on the image's grid, 0 to 1
  /// Brightness where the template has fluid, its darker quarter, over that of white matter: below
  /// 1 in a T1, above in a T2 or a proton density image; NaN where there is no fluid or white
  /// matter.
  double fluidOfWhite = 0;
};

/// Volume of the template's brain, mm^3.
[[nodiscard]] double brainVolumeOf(const Template& head);

/// True if the image has no skull: what lies above 0 is not much more than the template's brain.
[[nodiscard]] bool looksStripped(const Volume<float>& image, const Template& head);

/// Brings a template into the image's space: affinely, then by a deformation.  A head that is not
/// found so is looked for in turned poses, too.
/// @param stripped  the image has no skull: it is compared with the template's brain alone
/// @param enough    agreement by which a head is held to be found
/// @throws InvalidInput  a head with skull for a template without, an image without contrast
[[nodiscard]] HeadRegistration registerHead(const Volume<float>& image, const Template& head,
                                            bool stripped, double enough = 0,
                                            const DeformationOptions& options = {},
                                            const Monitor& monitor = {});

/// Takes a transform that an earlier registration has found, and compares as `registerHead` does.
/// Whether it is this image's, the agreement tells.
/// @throws InvalidInput  as `registerHead`, and a transform that stretches a head tenfold
[[nodiscard]] HeadRegistration reuseRegistration(const Volume<float>& image, const Template& head,
                                                 bool stripped, HeadTransform transform,
                                                 const DeformationOptions& options = {});

}  // namespace explica::registration
