// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "LinearSolve.h"

#include "Explica/Core/Parallel.h"

#include <algorithm>
#include <cmath>

namespace explica::harmonic {

namespace {

constexpr std::size_t kSolveGrain = 1 << 13;  // elements a task

struct Pair {
  double first = 0, second = 0;
  Pair& operator+=(const Pair& o) {
    first += o.first;
    second += o.second;
    return *this;
  }
};

/// The rows of A x over a strand.
/// @param to  of the strand's first voxel; aliases nothing else
void applyTo(const Strand& strand, const std::array<double, 3>& weight, const std::vector<float>& x,
             double* __restrict to) {
  std::array<const float*, 6> at{};
  for (int d = 0; d < 6; ++d) at[d] = x.data() + strand.links[d];
  const auto pair = [&](int a, std::int32_t k) {
    return weight[a] * (static_cast<double>(at[2 * a][k]) + static_cast<double>(at[2 * a + 1][k]));
  };
  const float* own = x.data() + strand.begin;
  for (std::int32_t k = 0; k < strand.count; ++k) {
    to[k] = static_cast<double>(own[k]) - pair(0, k) - pair(1, k) - pair(2, k);
  }
}

/// y = A x, where x has single precision.
void apply(const Annulus& annulus, const Stencil& stencil, const std::vector<float>& x,
           std::vector<double>& y) {
  const std::array<double, 3> weight = {stencil.regular[0], stencil.regular[1], stencil.regular[2]};
  const auto ofStrand = [&](const Strand& strand) {
    applyTo(strand, weight, x, y.data() + strand.begin);
  };
  const auto ofIrregular = [&](std::size_t n, std::size_t row) {
    const auto& links = annulus.links[n];
    const auto& weights = stencil.linked[row];
    double sum = x[n];
    for (int d = 0; d < 6; ++d) {
      sum -= static_cast<double>(weights[d]) * static_cast<double>(x[std::max(links[d], 0)]);
    }
    y[n] = sum;
  };
  for (int colour = 0; colour < 2; ++colour) {
    forVoxelsOf(annulus, stencil, colour, ofStrand, ofIrregular);
  }
}

template <class F>
void forAll(std::size_t count, const F& f) {
  parallelFor(count, kSolveGrain, f);
}

double dot(const std::vector<double>& a, const std::vector<double>& b) {
  return parallelSum(a.size(), kSolveGrain, 0.0, [&](std::size_t begin, std::size_t end) {
    double sum = 0;
    for (std::size_t k = begin; k < end; ++k) sum += a[k] * b[k];
    return sum;
  });
}

/// Two sums in one pass: termsAt(k) gives both terms.
template <class TermsAt>
Pair sumsOf(std::size_t count, const TermsAt& termsAt) {
  return parallelSum(count, kSolveGrain, Pair{}, [&](std::size_t begin, std::size_t end) {
    Pair sum;
    for (std::size_t k = begin; k < end; ++k) {
      const Pair terms = termsAt(k);
      sum.first += terms.first;
      sum.second += terms.second;
    }
    return sum;
  });
}

/// rhs - A u, with u in double precision.
std::vector<double> residualOf(const Annulus& annulus, const Stencil& stencil,
                               const std::vector<double>& rhs, const std::vector<double>& u) {
  std::vector<double> r(annulus.count());
  for (int colour = 0; colour < 2; ++colour) {
    forRunsOf(annulus, colour, [&](std::int32_t begin, std::int32_t end, std::int32_t offset) {
      parallelFor(end - begin, kSolveGrain, [&, begin, offset](std::size_t k) {
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
  return r;
}

/// BiCGStab with the multigrid cycle before it [VanDerVorst1992]; one object a solve.
class BiCGStab {
 public:
  BiCGStab(const Annulus& annulus, const Stencil& stencil, Multigrid& multigrid,
           const std::vector<double>& rhs, std::vector<double>& u)
      : annulus_(annulus),
        stencil_(stencil),
        multigrid_(multigrid),
        u_(u),
        r_(residualOf(annulus, stencil, rhs, u)),
        shadow_(r_),
        p_(r_.size(), 0),
        v_(r_.size(), 0),
        t_(r_.size()),
        single_(r_.size()),
        phat_(r_.size()),
        shat_(r_.size()),
        norm_(std::sqrt(dot(r_, r_))),
        rhoNext_(norm_ * norm_) {}

  [[nodiscard]] double residual() const { return norm_; }

  /// One iteration; false if it broke down, so that a further one would bring nothing.
  [[nodiscard]] bool iterate() {
    // What goes into the cycle has single precision, whose smallest normal numbers residuals fall
    // far below: it is scaled to order one, and what comes out by `scale`.
    const double scale = norm_ > 0 ? norm_ : 1, factor = 1 / scale;
    chooseDirection(factor);
    multigrid_.cycle(single_, phat_);
    apply(annulus_, stencil_, phat_, v_);
    vScale_ = scale;
    alpha_ = rho_ / (scale * dot(shadow_, v_));
    const double along = alpha_ * scale;
    norm_ = std::sqrt(sumsOf(r_.size(), [&](std::size_t k) {
                        r_[k] -= along * v_[k];  // now s
                        single_[k] = static_cast<float>(r_[k] * factor);
                        return Pair{r_[k] * r_[k], 0};
                      }).first);
    if (!std::isfinite(norm_)) return false;
    multigrid_.cycle(single_, shat_);
    apply(annulus_, stencil_, shat_, t_);
    const Pair dots = sumsOf(t_.size(), [&](std::size_t k) {
      return Pair{t_[k] * r_[k], t_[k] * t_[k]};
    });
    const double shift = dots.second > 0 ? dots.first / dots.second : 0;  // of the unscaled s-hat
    const Pair next = sumsOf(u_.size(), [&](std::size_t k) {
      u_[k] += along * phat_[k] + shift * shat_[k];
      r_[k] -= shift * t_[k];
      return Pair{r_[k] * r_[k], shadow_[k] * r_[k]};
    });
    omega_ = shift / scale;
    norm_ = std::sqrt(next.first);
    rhoNext_ = next.second;
    return omega_ != 0;
  }

 private:
  /// @param factor  of the direction, for the cycle
  void chooseDirection(double factor) {
    if (std::abs(rhoNext_) < 1e-14 * norm_ * std::sqrt(dot(shadow_, shadow_))) {
      // Breakdown: begin again from here.
      shadow_ = r_;
      rhoNext_ = norm_ * norm_;
      std::fill(p_.begin(), p_.end(), 0);
      std::fill(v_.begin(), v_.end(), 0);
      rho_ = alpha_ = omega_ = 1;
    }
    const double beta = rhoNext_ / rho_ * alpha_ / omega_, back = omega_ * vScale_;
    rho_ = rhoNext_;
    forAll(p_.size(), [&](std::size_t k) {
      p_[k] = r_[k] + beta * (p_[k] - back * v_[k]);
      single_[k] = static_cast<float>(p_[k] * factor);
    });
  }

  const Annulus& annulus_;
  const Stencil& stencil_;
  Multigrid& multigrid_;
  std::vector<double>& u_;
  std::vector<double> r_, shadow_, p_, v_, t_;
  std::vector<float> single_, phat_, shat_;
  double rho_ = 1, alpha_ = 1, omega_ = 1;
  double vScale_ = 1;  ///< v_ is to be multiplied by this
  double norm_;
  double rhoNext_;  ///< shadow_ . r_
};

}  // namespace

LinearOutcome solveLinear(const Annulus& annulus, const Stencil& stencil, Multigrid& multigrid,
                          const std::vector<double>& rhs, std::vector<double>& u,
                          double relativeTolerance, int maxIterations, const Monitor& monitor) {
  BiCGStab solver(annulus, stencil, multigrid, rhs, u);
  const double scale = std::sqrt(dot(rhs, rhs));
  const double start = solver.residual();
  LinearOutcome outcome{.relativeResidual = scale > 0 ? start / scale : 0};
  if (outcome.relativeResidual <= relativeTolerance) {
    outcome.termination = Termination::Converged;
    return outcome;
  }
  outcome.termination = Termination::MaxIterations;
  while (outcome.iterations < maxIterations) {
    if (monitor.shouldStop()) {
      outcome.termination = Termination::Interrupted;
      break;
    }
    const bool sound = solver.iterate();
    if (!std::isfinite(solver.residual())) {
      outcome.termination = Termination::Stalled;
      break;
    }
    ++outcome.iterations;
    outcome.relativeResidual = solver.residual() / scale;
    const double done =
        std::log(solver.residual() / start) / std::log(relativeTolerance * scale / start);
    monitor.progress(std::clamp(done, 0.0, 1.0), "harmonic interpolant");
    if (outcome.relativeResidual <= relativeTolerance) {
      outcome.termination = Termination::Converged;
      break;
    }
    if (!sound) {
      outcome.termination = Termination::Stalled;
      break;
    }
  }
  return outcome;
}

}  // namespace explica::harmonic
