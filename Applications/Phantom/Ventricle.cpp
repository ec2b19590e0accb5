// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "AnnulusKind.h"

namespace explica::app {
namespace {

void declare(Declaration& d, AnnulusKindSettings& s) {
  d.synopsis("a left ventricle between confocal spheroids, cut at its base, with exact answers")
      .description(
          "Focal distance 40 mm, sinh mu 0.6 and 0.9, the base 15 mm above the centre. "
          "Label 3 is a right ventricle, 4 what lies beyond the base: give it to "
          "--insulated. Near the base, which trajectories cross obliquely, the answers are "
          "not exact.")
      .example("explica phantom ventricle --size 120 --out ventricle", "120 voxels a side");
  declareAnnulusKind(d, s);
}

}  // namespace

Command phantomVentricleCommand() {
  return makeCommand<AnnulusKindSettings>("phantom ventricle", declare,
                                          runAnnulusKind<harmonic::PhantomKind::Ventricle>);
}

}  // namespace explica::app
