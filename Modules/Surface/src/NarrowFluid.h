// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace explica::surface {

/// Where the border of tissue beside fluid lies between the brightness of the tissue, 1, and the
/// darkest that the image shows of the fluid, 0.
///
/// A layer of fluid of width g between tissues alike, seen through a Gaussian of deviation s, is
/// darkest in its middle, by the share erf(u) of the contrast of tissue and fluid, u = g / (s
/// sqrt 8); at its border it is darker by erf(2 u) / 2.  So the border lies at 1 - erf(2 u) / (2
/// erf(u)) of what is seen: at one half where fluid is wide, at the darkest place where it is much
/// narrower than the image can show.  Neither g nor s has to be known.
/// @param depth  darkest seen, as a share of the contrast of tissue and pure fluid; is held within
///               0.05 and 1
[[nodiscard]] double levelBesideFluid(double depth);

}  // namespace explica::surface
