// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Volume.h"

namespace explica::registration {

/// How a brain is told from what surrounds it.
struct StrippingOptions {
  double reach = 4;       ///< mm beyond the template's mask that may be brain
  double opening = 3;     ///< mm: what is connected by less is no brain
  double dimmest = 0.75;  ///< tissue, of the mean brightness of the brain nearby
  double brightest = 1.5;
};

/// The brain in the image of a head, from a template's brain mask brought there: the mask, what is
/// as bright as brain within the reach of its border and connected with it by more than thin
/// bridges, without what is too bright within its outer millimetres.
///
/// @param brain  the template's mask on the image's grid, 0 to 1
/// @throws InvalidInput  the mask lies outside of the image
[[nodiscard]] Volume<Label> stripSkull(const Volume<float>& image, const Volume<float>& brain,
                                       const StrippingOptions& options = {});

}  // namespace explica::registration
