// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Describe.h"
#include "Explica/Core/Types.h"
#include "Explica/Report/Picture.h"

#include <array>
#include <optional>
#include <string>
#include <vector>

namespace explica::report {

/// Colours for values.  All but Grey run along curves in the OKLab space [Ottosson2020] at constant
/// speed, so that equal steps of the value look like equal steps; lightness alone orders the
/// sequential maps, and the diverging map runs along blue to yellow-brown, so that colour-blind
/// readers see the same order.
enum class ColourMap {
  Sequential,  ///< dark blue, green, light yellow
  Heat,        ///< dark purple, orange, light yellow
  Diverging,   ///< blue, light grey in the middle, brown
  Grey         ///< black to white
};
constexpr auto enumWords(ColourMap) {
  using enum ColourMap;
  return std::to_array<EnumWord<ColourMap>>(
      {{Sequential, "sequential"}, {Heat, "heat"}, {Diverging, "diverging"}, {Grey, "grey"}});
}

/// The colour of t in [0, 1] (clamped); not-a-number is a middle grey.
[[nodiscard]] Colour colourAt(ColourMap map, double t);

/// Colour of a label: eight that differ for colour-blind readers too [Okabe2008], then repeats at
/// other lightnesses; label 0 is light grey.
[[nodiscard]] Colour colourOfLabel(Label label);

/// The colour that a label's own table gives it (red, green, blue, opacity; sRGB in [0, 1]), or
/// where that is black or clear the one above.
[[nodiscard]] Colour colourOfLabel(Label label, const std::array<float, 4>& own);

/// A name and its colour.
struct LegendEntry {
  std::string name;
  Colour colour;
};

/// How values become colours.
struct ColourScale {
  ColourMap map = ColourMap::Sequential;
  double low = 0;   ///< value of the first colour
  double high = 1;  ///< value of the last colour
  std::string title;
  std::string unit;

  [[nodiscard]] Colour operator()(double value) const {
    return colourAt(map, (value - low) / (high - low));
  }
};

/// A scale for values: diverging and symmetric about 0 where both signs matter (more than a tenth
/// of the values lie on either side), else sequential; from the 2nd to the 98th percentile, rounded
/// outwards to two digits.
[[nodiscard]] ColourScale scaleFor(const Eigen::VectorXd& values, std::string title,
                                   std::string unit, std::optional<ColourMap> map = {});

/// Colours of a map's values, one a vertex.
[[nodiscard]] std::vector<Colour> coloursOf(const Eigen::VectorXd& values,
                                            const ColourScale& scale);

}  // namespace explica::report
