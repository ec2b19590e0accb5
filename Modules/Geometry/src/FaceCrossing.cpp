// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Geometry/FaceCrossing.h"

#include <Eigen/Geometry>

#include <vector>

namespace explica::geometry {
namespace {

/// Where the edge from corner k of face f pierces face g.
std::optional<CrossingEnd> piercing(const TriangleMesh& mesh, std::int32_t f, int k,
                                    std::int32_t g) {
  CrossingEnd end{.edge = {mesh.faces(f, k), mesh.faces(f, (k + 1) % 3)},
                  .face = {mesh.faces(g, 0), mesh.faces(g, 1), mesh.faces(g, 2)}};
  for (const std::int32_t v : end.edge) {
    for (const std::int32_t w : end.face) {
      if (v == w) return std::nullopt;
    }
  }
  const Point a = mesh.corner(f, k), b = mesh.corner(f, (k + 1) % 3);
  const Point p = mesh.corner(g, 0), q = mesh.corner(g, 1), r = mesh.corner(g, 2);
  const Vector normal = (q - p).cross(r - p);
  const double heightA = normal.dot(a - p), heightB = normal.dot(b - p);
  if ((heightA > 0) == (heightB > 0) || heightA == heightB) return std::nullopt;
  const double along = heightA / (heightA - heightB);
  end.edgeWeights = {1 - along, along};
  end.point = a + along * (b - a);
  const double squared = normal.squaredNorm();
  end.faceWeights = {normal.dot((r - q).cross(end.point - q)) / squared,
                     normal.dot((p - r).cross(end.point - r)) / squared,
                     normal.dot((q - p).cross(end.point - p)) / squared};
  constexpr double kRounding = 1e-9;  // barycentric: on the rim counts
  for (const double weight : end.faceWeights) {
    if (!(weight >= -kRounding)) return std::nullopt;
  }
  return end;
}

}  // namespace

std::optional<CrossingSegment> crossingSegment(const TriangleMesh& mesh, const FacePair& pair) {
  std::vector<CrossingEnd> ends;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      if (mesh.faces(pair[0], i) != mesh.faces(pair[1], j)) continue;
      CrossingEnd end{.point = mesh.corner(pair[0], i),
                      .edge = {mesh.faces(pair[0], i), mesh.faces(pair[0], i)}};
      ends.push_back(end);
    }
  }
  if (ends.size() > 1) return std::nullopt;  // a common edge: folded onto each other in one plane
  for (int side = 0; side < 2; ++side) {
    for (int k = 0; k < 3; ++k) {
      if (const auto end = piercing(mesh, pair[side], k, pair[1 - side])) ends.push_back(*end);
    }
  }
  double longest = 0;
  std::optional<CrossingSegment> segment;
  for (std::size_t i = 0; i < ends.size(); ++i) {
    for (std::size_t j = i + 1; j < ends.size(); ++j) {
      const double length = (ends[i].point - ends[j].point).norm();
      if (!(length > longest)) continue;
      longest = length;
      segment = {ends[i], ends[j]};
    }
  }
  return segment;
}

Point placeOfCrossing(const TriangleMesh& mesh, const FacePair& pair) {
  if (const auto segment = crossingSegment(mesh, pair)) {
    return 0.5 * ((*segment)[0].point + (*segment)[1].point);
  }
  Point sum = Point::Zero();
  for (const std::int32_t face : pair) {
    for (int k = 0; k < 3; ++k) sum += mesh.corner(face, k) / 6;
  }
  return sum;
}

}  // namespace explica::geometry
