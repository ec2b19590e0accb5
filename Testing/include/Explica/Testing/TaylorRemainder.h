// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Types.h"

#include <cmath>
#include <functional>
#include <random>

namespace explica::test {

/// Slope in a log-log plot of |E(x + e d) - E(x) - e g . d| over e, for a random direction d of the
/// vertices: 2 for the exact gradient of a smooth energy, 1 for any other.
inline double taylorSlope(const std::function<double(const Positions&)>& energy,
                          const Positions& at, const Positions& gradient, double largestStep,
                          unsigned seed = 1) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(-1, 1);
  Positions direction(at.rows(), 3);
  for (Eigen::Index i = 0; i < direction.size(); ++i) direction.data()[i] = uniform(random);
  const double value = energy(at);
  const double slope = (gradient.array() * direction.array()).sum();
  const auto remainder = [&](double e) {
    return std::abs(energy(at + e * direction) - value - e * slope);
  };
  return std::log2(remainder(largestStep) / remainder(largestStep / 16)) / 4;
}

}  // namespace explica::test
