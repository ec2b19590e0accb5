// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "LinearSolve.h"

#include "Explica/Core/Parallel.h"

#include <cmath>

namespace explica::harmonic {

namespace {

constexpr std::size_t kGrain = 1 << 13;

struct Pair {
  double first = 0, second = 0;
  Pair& operator+=(const Pair& o) {
    first += o.first;
    second += o.second;
    return *this;
  }
};

/// y = A x, where x has single precision.
void apply(const Annulus& annulus, const Stencil& stencil, const std::vector<float>& x,
           std::vector<double>& y) {
  for (int colour = 0; colour < 2; ++colour) {
    forRunsOf(annulus, colour, [&](std::int32_t begin, std::int32_t end, std::int32_t offset) {
      parallelFor(end - begin, kGrain, [&, begin, offset](std::size_t k) {
        const std::size_t n = begin + k;
        const auto& l = annulus.links[n];
        double sum = x[n];
        if (offset < 0) {
          for (int a = 0; a < 3; ++a) {
            sum -= stencil.regular[a] *
                   (static_cast<double>(x[l[2 * a]]) + static_cast<double>(x[l[2 * a + 1]]));
          }
        } else {
          for (int d = 0; d < 6; ++d) {
            if (l[d] >= 0) sum -= static_cast<double>(stencil.weights[k + offset][d]) * x[l[d]];
          }
        }
        y[n] = sum;
      });
    });
  }
}

template <class F>
void forAll(std::size_t count, const F& f) {
  parallelFor(count, kGrain, f);
}

}  // namespace

LinearOutcome solveLinear(const Annulus& annulus, const Stencil& stencil, Multigrid& multigrid,
                          const std::vector<double>& rhs, std::vector<double>& u,
                          double relativeTolerance, int maxIterations, const Monitor& monitor) {
  const std::size_t n = annulus.count();
  const auto dot = [n](const std::vector<double>& a, const std::vector<double>& b) {
    return parallelSum(n, kGrain, 0.0, [&](std::size_t begin, std::size_t end) {
      double sum = 0;
      for (std::size_t k = begin; k < end; ++k) sum += a[k] * b[k];
      return sum;
    });
  };
  std::vector<double> r(n), shadow, p(n, 0), v(n, 0), t(n);
  std::vector<float> single(n), phat(n), shat(n);
  // r = rhs - A u, with u in double precision.
  for (int colour = 0; colour < 2; ++colour) {
    forRunsOf(annulus, colour, [&](std::int32_t begin, std::int32_t end, std::int32_t offset) {
      parallelFor(end - begin, kGrain, [&, begin, offset](std::size_t k) {
        const std::size_t i = begin + k;
        double sum = rhs[i] - u[i];
        for (int d = 0; d < 6; ++d) {
          const std::int32_t m = annulus.links[i][d];
          if (m < 0) continue;
          sum += (offset < 0 ? stencil.regular[axisOf(d)] : stencil.weights[k + offset][d]) * u[m];
        }
        r[i] = sum;
      });
    });
  }
  LinearOutcome outcome;
  const double scale = std::sqrt(dot(rhs, rhs));
  double norm = std::sqrt(dot(r, r));
  outcome.relativeResidual = scale > 0 ? norm / scale : 0;
  if (outcome.relativeResidual <= relativeTolerance) {
    outcome.termination = Termination::Converged;
    return outcome;
  }
  const auto precondition = [&](const std::vector<double>& from, std::vector<float>& to) {
    // Residuals shrink far below single precision's smallest normal numbers: scale to order one.
    const double factor = norm > 0 ? 1 / norm : 1;
    forAll(n, [&](std::size_t k) { single[k] = static_cast<float>(from[k] * factor); });
    multigrid.cycle(single, to);
    return 1 / factor;
  };
  shadow = r;
  double rho = 1, alpha = 1, omega = 1;
  const double start = norm;
  outcome.termination = Termination::MaxIterations;
  while (outcome.iterations < maxIterations) {
    if (monitor.shouldStop()) {
      outcome.termination = Termination::Interrupted;
      break;
    }
    double rhoNext = dot(shadow, r);
    if (std::abs(rhoNext) < 1e-14 * norm * std::sqrt(dot(shadow, shadow))) {
      // Breakdown: begin again from here.
      shadow = r;
      rhoNext = norm * norm;
      std::fill(p.begin(), p.end(), 0);
      std::fill(v.begin(), v.end(), 0);
      rho = alpha = omega = 1;
    }
    const double beta = rhoNext / rho * alpha / omega;
    rho = rhoNext;
    forAll(n, [&](std::size_t k) { p[k] = r[k] + beta * (p[k] - omega * v[k]); });
    const double pScale = precondition(p, phat);
    apply(annulus, stencil, phat, v);
    forAll(n, [&](std::size_t k) { v[k] *= pScale; });
    alpha = rho / dot(shadow, v);
    forAll(n, [&](std::size_t k) { r[k] -= alpha * v[k]; });  // now s
    norm = std::sqrt(dot(r, r));
    if (!std::isfinite(norm)) {
      outcome.termination = Termination::Stalled;
      break;
    }
    const double sScale = precondition(r, shat);
    apply(annulus, stencil, shat, t);
    const Pair dots = parallelSum(n, kGrain, Pair{}, [&](std::size_t begin, std::size_t end) {
      Pair sum;
      for (std::size_t k = begin; k < end; ++k) {
        sum.first += t[k] * r[k];
        sum.second += t[k] * t[k];
      }
      return sum;
    });
    omega = dots.second > 0 ? dots.first / dots.second : 0;  // of the unscaled s-hat
    forAll(n, [&](std::size_t k) {
      u[k] += alpha * pScale * phat[k] + omega * shat[k];
      r[k] -= omega * t[k];
    });
    omega /= sScale;
    norm = std::sqrt(dot(r, r));
    ++outcome.iterations;
    outcome.relativeResidual = norm / scale;
    const double done = std::log(norm / start) / std::log(relativeTolerance * scale / start);
    monitor.progress(std::clamp(done, 0.0, 1.0), "harmonic interpolant");
    if (outcome.relativeResidual <= relativeTolerance) {
      outcome.termination = Termination::Converged;
      break;
    }
    if (omega == 0) {
      outcome.termination = Termination::Stalled;
      break;
    }
  }
  return outcome;
}

}  // namespace explica::harmonic
