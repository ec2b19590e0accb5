// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Harmonic/Interpolant.h"

#include "Embedding.h"
#include "Explica/Core/Errors.h"
#include "Explica/Core/Parallel.h"
#include "LinearSolve.h"
#include "Stencil.h"

#include <algorithm>

namespace explica::harmonic {

namespace {

constexpr std::size_t kInterpolantGrain = 1 << 13;  // elements a task
// Nearer than this (in voxels) a boundary's difference to the voxel is too small to divide by.
constexpr double kTooClose = 0.005;

/// One Gauss-Seidel sweep, odd voxels last; values stay in the range of their neighbours'.
void finalSweep(const Annulus& annulus, const Stencil& stencil, const std::vector<double>& rhs,
                std::vector<double>& u) {
  for (int colour = 0; colour < 2; ++colour) {
    forRunsOf(annulus, colour, [&](std::int32_t begin, std::int32_t end, std::int32_t offset) {
      parallelFor(end - begin, kInterpolantGrain, [&, begin, offset](std::size_t k) {
        const std::size_t n = begin + k;
        const auto& links = annulus.links[n];
        double sum = rhs[n];
        for (int d = 0; d < 6; ++d) {
          if (links[d] < 0) continue;
          const double w = offset < 0 ? stencil.regular[axisOf(d)] : stencil.weights[k + offset][d];
          sum += w * u[links[d]];
        }
        u[n] = std::clamp(sum, 0.0, 1.0);  // the weights' sum is 1 up to single precision
      });
    });
  }
}

}  // namespace

std::vector<Eigen::Vector3f> gradientOf(const Annulus& annulus, const std::vector<double>& u) {
  std::vector<Eigen::Vector3f> gradient(annulus.count());
  const Vector inverse = annulus.grid.spacing.cwiseInverse();
  parallelFor(annulus.count(), kInterpolantGrain, [&](std::size_t index) {
    const auto n = static_cast<std::int32_t>(index);
    const auto& links = annulus.links[n];
    const std::int32_t row = annulus.irregular(n);
    if (row < 0) {
      for (int a = 0; a < 3; ++a) {
        gradient[n][a] =
            static_cast<float>(0.5 * inverse[a] * (u[links[2 * a + 1]] - u[links[2 * a]]));
      }
      return;
    }
    for (int a = 0; a < 3; ++a) {
      double value[2];
      for (int side = 0; side < 2; ++side) {
        const std::int32_t m = links[2 * a + side];
        // An insulated neighbour mirrors the voxel.
        value[side] = m >= 0 ? u[m] : m == kInner ? 0.0 : m == kOuter ? 1.0 : u[n];
      }
      const double left = annulus.fractions[row][2 * a], right = annulus.fractions[row][2 * a + 1];
      double slope =
          (left / right * (value[1] - u[n]) + right / left * (u[n] - value[0])) / (left + right);
      const int close = left < right ? 0 : 1;  // the side whose boundary nearly meets the voxel
      if (std::min(left, right) < kTooClose && links[2 * a + 1 - close] >= 0) {
        // The voxel's own value is the boundary's up to round-off: a parabola through the boundary
        // and the next two voxels, or a line through one.
        const double theta = std::min(left, right), wall = value[close], one = value[1 - close];
        const std::int32_t beyond = annulus.links[links[2 * a + 1 - close]][2 * a + 1 - close];
        double outward = (one - wall) / (1 + theta);
        if (beyond >= 0) {
          const double second = ((u[beyond] - one) - outward) / (2 + theta);
          outward += second * (theta - 1);
        }
        slope = close == 0 ? outward : -outward;
      }
      gradient[n][a] = static_cast<float>(inverse[a] * slope);
    }
  });
  return gradient;
}

Interpolant solveInterpolant(const Annulus& annulus, const InterpolantOptions& options,
                             const Monitor& monitor) {
  if (!(options.relativeTolerance > 0) || options.maxIterations < 1) {
    throw InvalidInput("the tolerance and the number of iterations must be positive");
  }
  if (annulus.model == BoundaryModel::Embedding) {
    return solveByEmbedding(annulus, options, monitor);
  }
  Interpolant result;
  const Stencil stencil(annulus);
  Multigrid multigrid(annulus);
  std::vector<double> rhs(annulus.count(), 0);
  parallelFor(annulus.count(), kInterpolantGrain, [&](std::size_t index) {
    const auto n = static_cast<std::int32_t>(index);
    const std::int32_t row = annulus.irregular(n);
    if (row < 0) return;
    for (int d = 0; d < 6; ++d) {
      if (annulus.links[n][d] == kOuter) rhs[n] += stencil.weights[row][d];
    }
  });
  result.u.assign(annulus.count(), 0);
  const LinearOutcome outcome =
      solveLinear(annulus, stencil, multigrid, rhs, result.u, options.relativeTolerance,
                  options.maxIterations, monitor);
  result.termination = outcome.termination;
  result.iterations = outcome.iterations;
  result.relativeResidual = outcome.relativeResidual;
  result.corrected = parallelSum(annulus.count(), kInterpolantGrain, std::size_t{0},
                                 [&](std::size_t begin, std::size_t end) {
                                   std::size_t corrected = 0;
                                   for (std::size_t n = begin; n < end; ++n) {
                                     const double kept = std::clamp(result.u[n], 0.0, 1.0);
                                     corrected += kept != result.u[n];
                                     result.u[n] = kept;
                                   }
                                   return corrected;
                                 });
  finalSweep(annulus, stencil, rhs, result.u);
  result.gradient = gradientOf(annulus, result.u);
  return result;
}

}  // namespace explica::harmonic
