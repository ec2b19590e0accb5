// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "AnnulusKind.h"

namespace explica::app {
namespace {

void declare(Declaration& d, AnnulusKindSettings& s) {
  d.synopsis("two eccentric circles with their exact answers (bipolar coordinates)")
      .description(
          "One slice: circles of 10 and 25 mm whose centres are 5 mm apart. Trajectories "
          "are circles, so that thickness varies and boundary points are known.")
      .example("explica phantom eccentric --size 120 --out eccentric", "120 voxels a side");
  declareAnnulusKind(d, s);
}

}  // namespace

Command phantomEccentricCommand() {
  return makeCommand<AnnulusKindSettings>("phantom eccentric", declare,
                                          runAnnulusKind<harmonic::PhantomKind::Eccentric>);
}

}  // namespace explica::app
