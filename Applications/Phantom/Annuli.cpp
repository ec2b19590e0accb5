// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "AnnulusKind.h"

namespace explica::app {
namespace {

void declareEccentric(Declaration& d, AnnulusKindSettings& s) {
  d.synopsis("two eccentric circles with their exact answers (bipolar coordinates)")
      .description(
          "One slice: circles of 10 and 25 mm whose centres are 5 mm apart. Trajectories are "
          "circles, so that thickness varies and boundary points are known.")
      .example("explica phantom eccentric --size 120 --out eccentric", "120 voxels a side");
  declareAnnulusKind(d, s);
}

void declareSpheroid(Declaration& d, AnnulusKindSettings& s) {
  d.synopsis("confocal spheroids with their exact answers")
      .description(
          "Prolate spheroids of focal distance 30 mm, sinh mu 0.5 and 1. Trajectories are "
          "hyperbolas.")
      .example("explica phantom spheroid --size 120 --out spheroid", "120 voxels a side");
  declareAnnulusKind(d, s);
}

}  // namespace

Command phantomEccentricCommand() {
  return makeCommand<AnnulusKindSettings>("phantom eccentric", declareEccentric,
                                          runAnnulusKind<harmonic::PhantomKind::Eccentric>);
}

Command phantomSpheroidCommand() {
  return makeCommand<AnnulusKindSettings>("phantom spheroid", declareSpheroid,
                                          runAnnulusKind<harmonic::PhantomKind::Spheroid>);
}

}  // namespace explica::app
