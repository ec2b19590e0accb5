// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Harmonic/Interpolant.h"
#include "Stencil.h"

namespace explica::harmonic {

struct LinearOutcome {
  Termination termination = Termination::NotRun;
  int iterations = 0;
  double relativeResidual = kNaN;
};

/// Solves A u = rhs (unit diagonal) by BiCGStab [VanDerVorst1992], preconditioned on the right by
/// one V-cycle; u holds the first guess and the result.
LinearOutcome solveLinear(const Annulus& annulus, const Stencil& stencil, Multigrid& multigrid,
                          const std::vector<double>& rhs, std::vector<double>& u,
                          double relativeTolerance, int maxIterations, const Monitor& monitor);

}  // namespace explica::harmonic
