// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Geometry/FaceTree.h"

#include <array>

namespace explica::geometry {
namespace {

/// How much nearer than its box a face may seem, by the rounding of a few sums and products.
constexpr double kSquareRounding = 1e-14;

/// A node that waits, and how near its faces may be.
struct Pending {
  double squared;
  std::int32_t node;
};

}  // namespace

Point closestPointOnTriangle(const Point& q, const Point& a, const Point& b, const Point& c) {
  // Which of the triangle's seven Voronoi regions q projects into, by barycentric signs.
  const Vector ab = b - a, ac = c - a;
  const Vector aq = q - a;
  const double d1 = ab.dot(aq), d2 = ac.dot(aq);
  if (d1 <= 0 && d2 <= 0) return a;
  const Vector bq = q - b;
  const double d3 = ab.dot(bq), d4 = ac.dot(bq);
  if (d3 >= 0 && d4 <= d3) return b;
  const Vector cq = q - c;
  const double d5 = ab.dot(cq), d6 = ac.dot(cq);
  if (d6 >= 0 && d5 <= d6) return c;
  const double weightC = d1 * d4 - d3 * d2;
  if (weightC <= 0 && d1 >= 0 && d3 <= 0) return a + ab * (d1 / (d1 - d3));
  const double weightB = d5 * d2 - d1 * d6;
  if (weightB <= 0 && d2 >= 0 && d6 <= 0) return a + ac * (d2 / (d2 - d6));
  const double weightA = d3 * d6 - d5 * d4;
  if (weightA <= 0 && d4 >= d3 && d5 >= d6) {
    return b + (c - b) * ((d4 - d3) / ((d4 - d3) + (d5 - d6)));
  }
  const double sum = weightA + weightB + weightC;
  return a + ab * (weightB / sum) + ac * (weightC / sum);
}

std::vector<std::int32_t> faceOfEachVertex(const TriangleMesh& mesh) {
  std::vector<std::int32_t> faces(static_cast<std::size_t>(mesh.vertexCount()), 0);
  for (Eigen::Index f = 0; f < mesh.faceCount(); ++f) {
    for (int k = 0; k < 3; ++k) faces[mesh.faces(f, k)] = static_cast<std::int32_t>(f);
  }
  return faces;
}

FaceTree::FaceTree(TriangleMesh mesh) : mesh_(std::move(mesh)), tree_(faceBoxes(mesh_)) {}

ClosestPoint FaceTree::closestPoint(const Point& query) const {
  return nearerThan({}, query);
}

ClosestPoint FaceTree::closestPoint(const Point& query, std::int32_t near) const {
  const Point point = closestPointOnTriangle(query, mesh_.corner(near, 0), mesh_.corner(near, 1),
                                             mesh_.corner(near, 2));
  return nearerThan({point, near, (point - query).squaredNorm()}, query);
}

ClosestPoint FaceTree::nearerThan(ClosestPoint best, const Point& query) const {
  const auto& nodes = tree_.nodes();
  if (nodes.empty()) return best;
  const auto pendingOf = [&](std::int32_t node) {
    return Pending{nodes[node].box.squaredExteriorDistance(query), node};
  };
  std::array<Pending, BoxTree::kStackDepth> stack;
  std::size_t depth = 0;
  stack[depth++] = pendingOf(0);
  while (depth > 0) {
    const Pending next = stack[--depth];
    if (next.squared > (1 + kSquareRounding) * best.squaredDistance) continue;
    const BoxTree::Node& node = nodes[next.node];
    if (node.count == 0) {
      Pending nearer = pendingOf(node.left), farther = pendingOf(node.left + 1);
      if (farther.squared < nearer.squared) std::swap(nearer, farther);
      stack[depth++] = farther;
      stack[depth++] = nearer;
      continue;
    }
    for (std::int32_t n = node.first; n < node.first + node.count; ++n) {
      const std::int32_t face = tree_.items()[n];
      const Point point = closestPointOnTriangle(query, mesh_.corner(face, 0),
                                                 mesh_.corner(face, 1), mesh_.corner(face, 2));
      const double squared = (point - query).squaredNorm();
      if (squared < best.squaredDistance || (squared == best.squaredDistance && face < best.face)) {
        best = {point, face, squared};
      }
    }
  }
  return best;
}

}  // namespace explica::geometry
