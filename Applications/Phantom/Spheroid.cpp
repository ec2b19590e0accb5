// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "AnnulusKind.h"

namespace explica::app {
namespace {

void declare(Declaration& d, AnnulusKindSettings& s) {
  d.synopsis("confocal spheroids with their exact answers")
      .description(
          "Prolate spheroids of focal distance 30 mm, sinh mu 0.5 and 1. Trajectories are "
          "hyperbolas.")
      .example("explica phantom spheroid --size 120 --out spheroid", "120 voxels a side");
  declareAnnulusKind(d, s);
}

}  // namespace

Command phantomSpheroidCommand() {
  return makeCommand<AnnulusKindSettings>("phantom spheroid", declare,
                                          runAnnulusKind<harmonic::PhantomKind::Spheroid>);
}

}  // namespace explica::app
