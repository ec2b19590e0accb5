// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Collision/Proximity.h"

#include <random>

namespace explica::collision {

inline FourPoints randomPoints(std::mt19937& random, double size = 1) {
  std::uniform_real_distribution<double> uniform(-size, size);
  FourPoints x;
  for (auto& p : x) p = Point(uniform(random), uniform(random), uniform(random));
  return x;
}

inline FourPoints moved(const FourPoints& x, const FourPoints& motion, double time) {
  FourPoints y = x;
  for (int i = 0; i < 4; ++i) y[i] += time * motion[i];
  return y;
}

inline FourPoints moved(const FourPoints& x, const Vector12& direction, double step) {
  FourPoints y = x;
  for (int i = 0; i < 4; ++i) y[i] += step * direction.segment<3>(3 * i);
  return y;
}

}  // namespace explica::collision
