// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Ventricle/Beat.h"

#include <string>
#include <vector>

namespace explica::ventricle {

/// Mean and standard deviation over a group of people.
struct Spread {
  double mean, deviation;

  [[nodiscard]] double low() const { return mean - 2 * deviation; }
  [[nodiscard]] double high() const { return mean + 2 * deviation; }
};

/// Numbers of a heart that have a published range.
enum class Quantity {
  MiddleThickness,   ///< mm, end-diastole, mean of the segments of the middle ring
  BasalThickening,   ///< mm, end-systole less end-diastole, mean of the basal ring
  MiddleThickening,  ///< the same of the middle ring
  ApicalThickening,  ///< the same of the apical ring, without the apex
  DiastolicVolume,   ///< ml
  SystolicVolume,    ///< ml
  Ejection,          ///< percent
  Mass,              ///< g, at end-diastole
};

/// What was published of healthy adults, measured by magnetic resonance.  Only means and standard
/// deviations that were read in the source stand here: of systolic thickness, and of thickening in
/// percent, there are none.
struct Reference {
  Quantity quantity;
  std::string name, unit;
  Spread women, men;      ///< equal where the source does not tell them apart
  std::string papillary;  ///< where the source counts papillary muscles: "cavity", "wall", "n/a"
  std::string people;
  std::string source;

  [[nodiscard]] bool bothAlike() const { return women.mean == men.mean; }
};

/// All of them, in the order of Quantity.
[[nodiscard]] const std::vector<Reference>& references();
[[nodiscard]] const Reference& referenceOf(Quantity quantity);

/// This heart's number; NaN where it has none (one frame, segments that do not count).
[[nodiscard]] double valueOf(const Beat& beat, Quantity quantity);

/// "women 5.3 (SD 0.9), men 6.3 (SD 1.1) mm", or once for both.
[[nodiscard]] std::string rangeText(const Reference& reference);

/// A row a reference with this heart's number and its distance from women's and men's means in
/// standard deviations.
[[nodiscard]] std::string referenceTable(const Beat& beat);

}  // namespace explica::ventricle
