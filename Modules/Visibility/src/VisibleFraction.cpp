// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Visibility/VisibleFraction.h"

#include "Occluders.h"

#include "Explica/Core/Errors.h"
#include "Explica/Core/Parallel.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <string>

namespace explica::visibility {
namespace {

constexpr std::size_t kGrain = 256;  // faces a task

/// Centroids of the n^2 equal sub-triangles, as barycentric coordinates.
std::vector<Vector> subTriangleCentroids(int n) {
  std::vector<Vector> result;
  for (int i = 0; i < n; ++i) {
    for (int j = 0; i + j < n; ++j) {
      for (int flipped = 0; flipped < (i + j + 1 < n ? 2 : 1); ++flipped) {
        const double shift = flipped ? 2.0 / 3 : 1.0 / 3;
        const double u = (i + shift) / n;
        const double v = (j + shift) / n;
        result.emplace_back(1 - u - v, u, v);
      }
    }
  }
  return result;
}

Eigen::VectorXd areasOf(const TriangleMesh& mesh) {
  Eigen::VectorXd areas(mesh.faceCount());
  for (Eigen::Index f = 0; f < mesh.faceCount(); ++f) {
    areas[f] = (mesh.corner(f, 1) - mesh.corner(f, 0))
                   .cross(mesh.corner(f, 2) - mesh.corner(f, 0))
                   .norm() /
               2;
  }
  return areas;
}

double meanOver(const TriangleMesh& mesh, const std::vector<std::int32_t>& faces,
                const Eigen::VectorXd& values) {
  const Eigen::VectorXd areas = areasOf(mesh);
  double sum = 0;
  double area = 0;
  for (const std::int32_t f : faces) {
    sum += values[f] * areas[f];
    area += areas[f];
  }
  return area > 0 ? sum / area : 0;
}

}  // namespace

double VisibleFraction::of(const TriangleMesh& mesh, const std::vector<std::int32_t>& faces) const {
  return meanOver(mesh, faces, face);
}

double VisibleFraction::realOf(const TriangleMesh& mesh,
                               const std::vector<std::int32_t>& faces) const {
  return meanOver(mesh, faces, arriving);
}

VisibleFraction visibleFraction(const TriangleMesh& mesh, const Viewpoints& viewpoints,
                                const VisibleFractionOptions& options) {
  if (mesh.faceCount() == 0) throw InvalidInput("visible fraction: the surface has no face");
  if (viewpoints.points.empty() || viewpoints.points.size() != viewpoints.weights.size()) {
    throw InvalidInput("visible fraction: at least one viewpoint, each with a weight, is needed");
  }
  if (options.subdivision < 1 || options.subdivision > 64) {
    throw InvalidInput("visible fraction: subdivision is " + std::to_string(options.subdivision) +
                       "; it must lie between 1 and 64");
  }
  if (!mesh.positions.allFinite()) {
    throw InvalidInput("visible fraction: a vertex position is not finite");
  }
  const Point low = mesh.positions.colwise().minCoeff().transpose();
  const Point high = mesh.positions.colwise().maxCoeff().transpose();
  const Point centre = (low + high) / 2;
  const double radius = (high - low).norm() / 2;
  const Occluders occluders(mesh, centre);
  const std::vector<Vector> samples = subTriangleCentroids(options.subdivision);

  VisibleFraction result;
  result.face.setZero(mesh.faceCount());
  result.arriving.setZero(mesh.faceCount());
  parallelFor(static_cast<std::size_t>(mesh.faceCount()), kGrain, [&](std::size_t i) {
    const auto f = static_cast<Eigen::Index>(i);
    const Point a = mesh.corner(f, 0) - centre;
    const Point b = mesh.corner(f, 1) - centre;
    const Point c = mesh.corner(f, 2) - centre;
    const Vector normal = (b - a).cross(c - a).stableNormalized();
    double seen = 0;
    double arriving = 0;
    for (std::size_t p = 0; p < viewpoints.points.size(); ++p) {
      const Point target = viewpoints.points[p] - centre;
      if (!(normal.dot(target - a) > 0)) continue;  // turned away
      int clear = 0;
      double cosines = 0;
      std::array<Point, Occluders::kPacket> from;
      std::array<Vector, Occluders::kPacket> by;
      std::array<double, Occluders::kPacket> lengths;
      for (std::size_t first = 0; first < samples.size(); first += Occluders::kPacket) {
        const std::size_t count = std::min(Occluders::kPacket, samples.size() - first);
        for (std::size_t n = 0; n < count; ++n) {
          const Vector& s = samples[first + n];
          from[n] = s[0] * a + s[1] * b + s[2] * c;
          const Vector toTarget = target - from[n];
          const double distance = toTarget.norm();
          by[n] = toTarget / distance;
          // Nothing lies beyond the mesh's ball: a far viewpoint costs no precision.
          lengths[n] = std::min(distance, from[n].norm() + 1.001 * radius);
        }
        const std::uint32_t free =
            occluders.clear({from.data(), count}, {by.data(), count}, {lengths.data(), count},
                            static_cast<std::uint32_t>(i));
        clear += std::popcount(free);
        for (std::size_t n = 0; n < count; ++n) {
          if (free >> n & 1U) cosines += normal.dot(by[n]);
        }
      }
      const auto rays = static_cast<double>(samples.size());
      seen += viewpoints.weights[p] * clear / rays;
      arriving += viewpoints.weights[p] * cosines / rays;
    }
    result.face[f] = seen;
    result.arriving[f] = arriving;
  });

  const Eigen::VectorXd areas = areasOf(mesh);
  const double total = areas.sum();
  result.total = total > 0 ? result.face.dot(areas) / total : 0;
  result.vertex.setZero(mesh.vertexCount());
  Eigen::VectorXd around = Eigen::VectorXd::Zero(mesh.vertexCount());
  for (Eigen::Index f = 0; f < mesh.faceCount(); ++f) {
    for (int k = 0; k < 3; ++k) {
      result.vertex[mesh.faces(f, k)] += result.face[f] * areas[f];
      around[mesh.faces(f, k)] += areas[f];
    }
  }
  for (Eigen::Index v = 0; v < around.size(); ++v) {
    result.vertex[v] = around[v] > 0 ? result.vertex[v] / around[v] : 0;
  }
  return result;
}

}  // namespace explica::visibility
