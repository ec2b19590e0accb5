// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Describe.h"
#include "Explica/Core/TriangleMesh.h"

#include <cstdint>
#include <vector>

namespace explica::phantom {

/// A sheet in overhanging folds that wind to and fro.
struct FoldedSheetOptions {
  double length = 80;    ///< along the folded way, mm
  double width = 40;     ///< along the folds, mm
  int waves = 4;         ///< folds, >= 2
  double turn = 2.04;    ///< greatest angle between the sheet and its mean plane, rad, in [0, 2.1]
  double winding = 1.5;  ///< how far folds shift along the way and back over the width, mm
  double edge = 1;       ///< length of the mesh's edges, about, mm
};

template <class Visitor>
void describe(FoldedSheetOptions& options, Visitor&& visit) {
  visit(Field{"length", "mm", "of the sheet across its folds, laid flat", kAboveZero},
        options.length);
  visit(Field{"width", "mm", "of the sheet along its folds", kAboveZero}, options.width);
  visit(Field{"waves", "", "folds", 2, 1000}, options.waves);
  visit(Field{"turn", "rad", "greatest slope; folds overhang and hide each other from pi/2 on", 0,
              2.1},
        options.turn);
  visit(Field{"winding", "mm", "how far folds shift to and fro over the width", 0},
        options.winding);
  visit(Field{"edge", "mm", "length of the mesh's edges, about", kAboveZero}, options.edge);
}

struct FoldedSheet {
  TriangleMesh mesh;                 ///< normals look to +z where the sheet lies flat
  std::vector<std::int32_t> region;  ///< vertices all of whose way to the rim is an eighth of the
                                     ///< width, or half a wave, or more
  Point centre;                      ///< of the region's middle vertex, mm
};

/// A sine-generated curve, whose direction is turn * sin(2 pi s / wave) at arc length s, moved
/// along the width with the shift winding * sin(2 pi y / width).
///
/// Seen from far above, its average visibility is the mean of cos(turn sin), the Bessel function
/// J0(turn), less what the winding tilts: 0.2 by default, the initial visibility of [Thesis, figure
/// 5.24].  Without winding the sheet is developable, so that it can be opened to 1 with every
/// length kept; the winding shears it by at most 2 pi winding / width.
/// @throws InvalidInput  an option out of range
[[nodiscard]] FoldedSheet makeFoldedSheet(const FoldedSheetOptions& options = {});

}  // namespace explica::phantom
