// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Geometry/Geodesic.h"

#include "Explica/Core/Errors.h"

#include <algorithm>
#include <cmath>
#include <queue>
#include <string>
#include <utility>
#include <vector>

namespace explica::geometry {
namespace {

/// Distance at c of a triangle whose corners a and b lie at distances `da` and `db` from a common
/// source: the source is placed in the triangle's plane, on the other side of ab.
double unfoldedDistance(const Point& a, const Point& b, const Point& c, double da, double db) {
  const double length = (b - a).norm();
  const double around = std::min(da + (c - a).norm(), db + (c - b).norm());
  if (length <= 0) return around;
  // Frame of the triangle's plane: a at the origin, b on the positive x axis, c above.
  const Vector axis = (b - a) / length;
  const double cx = axis.dot(c - a);
  const double cy = ((c - a) - cx * axis).norm();
  const double sx = (da * da - db * db + length * length) / (2 * length);
  const double squared = da * da - sx * sx;
  if (squared < 0) return around;  // no point of the plane has these distances
  const double sy = -std::sqrt(squared);
  // The straight way to c must pass between a and b.
  if (cy - sy <= 0) return around;
  const double crossing = sx + (cx - sx) * (-sy) / (cy - sy);
  if (crossing < 0 || crossing > length) return around;
  return std::sqrt((cx - sx) * (cx - sx) + (cy - sy) * (cy - sy));
}

}  // namespace

Eigen::VectorXd geodesicDistances(const TriangleMesh& mesh, const MeshTopology& topology,
                                  std::span<const std::int32_t> sources, double limit) {
  if (sources.empty()) throw InvalidInput("geodesic distance: no source vertex");
  Eigen::VectorXd distance = Eigen::VectorXd::Constant(mesh.vertexCount(), kInfinity);
  using Entry = std::pair<double, std::int32_t>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> front;
  for (const std::int32_t s : sources) {
    if (s < 0 || s >= mesh.vertexCount()) {
      throw InvalidInput("geodesic distance: source " + std::to_string(s) +
                         " is not one of the vertices 0.." +
                         std::to_string(mesh.vertexCount() - 1));
    }
    distance[s] = 0;
    front.emplace(0.0, s);
  }
  // Gains below this share are rounding; without the threshold, corrections could go round for
  // ever.
  constexpr double kSmallestGain = 1e-12;
  const auto offer = [&](std::int32_t v, double d) {
    if (d <= limit && d < distance[v] - kSmallestGain * d) {
      distance[v] = d;
      front.emplace(d, v);
    }
  };
  while (!front.empty()) {
    const auto [d, v] = front.top();
    front.pop();
    if (d > distance[v]) continue;  // corrected since
    for (const std::int32_t f : topology.vertexFaces[v]) {
      int corner = 0;
      while (mesh.faces(f, corner) != v) ++corner;
      const std::int32_t next[2] = {mesh.faces(f, (corner + 1) % 3),
                                    mesh.faces(f, (corner + 2) % 3)};
      const Point pv = mesh.positions.row(v).transpose();
      for (int k = 0; k < 2; ++k) {
        const std::int32_t from = next[k], to = next[1 - k];
        const Point pto = mesh.positions.row(to).transpose();
        double candidate = d + (pto - pv).norm();
        if (std::isfinite(distance[from])) {
          const Point pfrom = mesh.positions.row(from).transpose();
          candidate = std::min(candidate, unfoldedDistance(pv, pfrom, pto, d, distance[from]));
        }
        offer(to, candidate);
      }
    }
  }
  return distance;
}

}  // namespace explica::geometry
