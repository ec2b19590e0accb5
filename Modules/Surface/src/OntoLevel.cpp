// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "OntoLevel.h"

namespace explica::surface {

Point ontoLevel(const LevelSet& level, const Point& from, const Vector& normal, double most) {
  const double voxel = level.grid.spacing.minCoeff();
  Point p = from;
  for (int step = 0; step < 3; ++step) {
    const LevelSample s = sample(level, p);
    const double squared = s.gradient.squaredNorm();
    if (squared * voxel * voxel < kFlatLevel || s.gradient.dot(normal) > 0) return from;
    p -= s.value / squared * s.gradient;
    if ((p - from).squaredNorm() > most * most) return from;
  }
  return p;
}

}  // namespace explica::surface
