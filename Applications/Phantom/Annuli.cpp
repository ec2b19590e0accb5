// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
// The annular tissues of fixed size.

#include "AnnulusKind.h"

namespace explica::app {
namespace {

void declare(Declaration& d, AnnulusKindSettings& s, const char* synopsis, const char* description,
             const char* example) {
  d.synopsis(synopsis).description(description).example(example, "120 voxels a side");
  declareAnnulusKind(d, s);
}

}  // namespace

Command phantomEccentricCommand() {
  return makeCommand<AnnulusKindSettings>(
      "phantom eccentric",
      [](Declaration& d, AnnulusKindSettings& s) {
        declare(d, s, "two eccentric circles with their exact answers (bipolar coordinates)",
                "One slice: circles of 10 and 25 mm whose centres are 5 mm apart. Trajectories "
                "are circles, so that thickness varies and boundary points are known.",
                "explica phantom eccentric --size 120 --out eccentric");
      },
      runAnnulusKind<harmonic::PhantomKind::Eccentric>);
}

Command phantomSpheroidCommand() {
  return makeCommand<AnnulusKindSettings>(
      "phantom spheroid",
      [](Declaration& d, AnnulusKindSettings& s) {
        declare(d, s, "confocal spheroids with their exact answers",
                "Prolate spheroids of focal distance 30 mm, sinh mu 0.5 and 1. Trajectories are "
                "hyperbolas.",
                "explica phantom spheroid --size 120 --out spheroid");
      },
      runAnnulusKind<harmonic::PhantomKind::Spheroid>);
}

}  // namespace explica::app
