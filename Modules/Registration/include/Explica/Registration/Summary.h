// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Results.h"

namespace explica::registration {

/// A template in the space of a head, in numbers.
struct HeadSummary {
  std::optional<bool> stripped;
  std::optional<double> information;      ///< bits, of the affine map
  std::optional<double> correlation;      ///< of tissue and template after the deformation
  std::optional<double> leastJacobian;    ///< of the deformation
  std::optional<double> stretch;          ///< of the affine map
  std::optional<double> turn;             ///< of the affine map, degrees
  std::optional<double> fluidOfWhite;     ///< HeadRegistration::fluidOfWhite
  std::optional<double> borderOffset;     ///< BrainMask::meanOffset, mm
  std::optional<double> borderDeviation;  ///< BrainMask::deviation, mm
  std::optional<double> borderOpenShare;  ///< BrainMask::openShare
  std::optional<double> leftOverRight;    ///< volumes of the brain's halves
};

inline void describe(Results& t, const HeadSummary& r) {
  t.flag("stripped", "Without skull", "Whether the image shows the brain alone.", r.stripped);
  t.number("registration_information", "Mutual information of image and template", "bit",
           "Normalised, after the affine registration.", r.information);
  t.number("registration_correlation", "Agreement with the template", "",
           "Correlation of image and template after the deformation.", r.correlation);
  t.number("registration_least_jacobian", "Smallest Jacobian of the deformation", "",
           "Above 0 the deformation is one to one.", r.leastJacobian);
  t.number("registration_stretch", "Stretch of the affine registration", "",
           "Largest over smallest scale.", r.stretch);
  t.number("registration_turn", "Rotation of the affine registration", "degrees",
           "How far the head is turned from where its header says.", r.turn)
      .atMost(45, Judgement::Look,
              "it lay so, or an axis of the header is wrong; left and right may be exchanged then");
  t.number("registration_fluid_of_white", "Template's fluid over its white matter", "",
           "Ratio of the image's brightness there; below 1 in a T1.", r.fluidOfWhite);
  t.number("brain_border_offset", "Border of the brain, beyond the template's", "mm",
           "Mean distance outward from the template's border to the one found.", r.borderOffset);
  t.number("brain_border_deviation", "Border of the brain, uncertainty", "mm",
           "Root mean square of the border's standard deviation.", r.borderDeviation);
  t.share("brain_border_open_share", "Border of the brain without an edge",
          "Where tissue goes on beyond the border.", r.borderOpenShare);
  t.number("left_over_right", "Left half of the brain over the right", "", "Ratio of volumes.",
           r.leftOverRight);
}

}  // namespace explica::registration
