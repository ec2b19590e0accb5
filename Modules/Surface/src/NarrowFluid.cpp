// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "NarrowFluid.h"

#include "Explica/Core/Types.h"

#include <algorithm>
#include <cmath>

namespace explica::surface {
namespace {

constexpr double kLeastDepth = 0.05;   // less is noise
constexpr double kMostDepth = 0.9999;  // the level is one half from there on
constexpr int kNewton = 20;            // from below erf's concave side: monotone, and converged

/// u with erf(u) = depth.
double inverseErf(double depth) {
  double u = 0;
  for (int k = 0; k < kNewton; ++k) {
    u -= (std::erf(u) - depth) * 0.5 * std::sqrt(kPi) * std::exp(u * u);
  }
  return u;
}

}  // namespace

double levelBesideFluid(double depth) {
  const double seen = std::clamp(depth, kLeastDepth, kMostDepth);
  return 1 - 0.5 * std::erf(2 * inverseErf(seen)) / seen;
}

}  // namespace explica::surface
