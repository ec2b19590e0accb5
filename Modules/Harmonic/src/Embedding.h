// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Harmonic/Interpolant.h"

namespace explica::harmonic {

/// Interpolant by harmonic embedding [thesis 3.2]: u = sum alpha_j u_j, where u_j is 1 at the j-th
/// grid vertex of the boundary, 0 at the others and harmonic (seven-point stencil) between them.
/// alpha minimises the sum of (u - 0)^2 over the inner and of (u - 1)^2 over the outer boundary's
/// crossings of the grid's links.  The u_j are never formed: the normal equations are solved by
/// conjugate gradients (CGLS), one Laplace solve and one of its adjoint an iteration.
[[nodiscard]] Interpolant solveByEmbedding(const Annulus& annulus,
                                           const InterpolantOptions& options,
                                           const Monitor& monitor);

}  // namespace explica::harmonic
