// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Report/Canvas.h"

namespace explica::ventricle {

using report::Canvas;
using report::Point2;

// Linear light, as all colours here.
using report::kInk;
inline constexpr report::Colour kPale = {0.78F, 0.79F, 0.80F};  // gridlines, and what is not known
inline constexpr report::Colour kGrey = {0.21F, 0.22F, 0.23F};  // small print
inline constexpr report::Colour kWhite = {1, 1, 1};             // paper

/// Black or white, whichever is read better on a colour.
inline report::Colour inkOn(const report::Colour& ground) {
  // Where black and white have the same contrast, (Y + 0.05)^2 = 1.05 * 0.05.
  const double light = 0.2126 * ground[0] + 0.7152 * ground[1] + 0.0722 * ground[2];
  return light > 0.18 ? kInk : kWhite;
}

}  // namespace explica::ventricle
