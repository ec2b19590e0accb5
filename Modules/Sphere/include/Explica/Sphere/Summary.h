// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Results.h"
#include "Explica/Core/Termination.h"
#include "Explica/Sphere/Register.h"
#include "Explica/Sphere/SphereMap.h"

namespace explica::sphere {

/// A surface on the sphere, in numbers.
struct SphereSummary {
  SphereDistortion distortion;
  std::size_t moved = 0;  ///< vertices, so that no face is turned over in single precision
  int iterations = 0;
  Termination stopReason = Termination::NotRun;
};
void describe(Results& t, const SphereSummary& s);

/// A registration in numbers.
void describe(Results& t, const SphereRegistration& r);

}  // namespace explica::sphere
