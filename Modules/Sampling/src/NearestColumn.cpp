// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Sampling/NearestColumn.h"

#include "Explica/Core/Errors.h"
#include "Explica/Core/Parallel.h"
#include "Explica/Sampling/Depth.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace explica::sampling {

std::vector<ColumnPlace> nearestColumns(const TriangleMesh& white, const TriangleMesh& pial,
                                        const Positions& points) {
  requireCorresponding(white, pial);
  std::vector<ColumnPlace> places(static_cast<std::size_t>(points.rows()));
  for (Eigen::Index p = 0; p < points.rows(); ++p) {
    if (!points.row(p).allFinite()) {
      throw InvalidInput("points: row " + std::to_string(p + 1) + " is not finite");
    }
  }
  parallelFor(places.size(), 1, [&](std::size_t p) {
    const Point point = points.row(p).transpose();
    double least = kInfinity;
    ColumnPlace& place = places[p];
    for (Eigen::Index v = 0; v < white.vertexCount(); ++v) {
      const Vector from = point - white.positions.row(v).transpose();
      const Vector along = (pial.positions.row(v) - white.positions.row(v)).transpose();
      const double length = along.squaredNorm();
      const double depth = length > 0 ? std::clamp(from.dot(along) / length, 0.0, 1.0) : 0;
      const double square = (from - depth * along).squaredNorm();
      if (!(square < least)) continue;
      least = square;
      place = {static_cast<std::int32_t>(v), depth, 0};
    }
    place.distance = std::sqrt(least);
  });
  return places;
}

}  // namespace explica::sampling
