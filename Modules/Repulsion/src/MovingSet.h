// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/TriangleMesh.h"
#include "Explica/Repulsion/PairIntegral.h"

#include <Eigen/Geometry>

#include <array>
#include <span>
#include <vector>

namespace explica::repulsion {

/// Two faces with common corners, each written so that the common ones come first.
struct AdjacentPair {
  std::int32_t s = 0;  ///< a moving face
  std::int32_t t = 0;  ///< its neighbour; if it moves too, t > s
  std::array<std::int32_t, 3> cornersS{};
  std::array<std::int32_t, 3> cornersT{};
};

/// Which faces move, and who touches whom: all that the evaluators need besides positions.
class MovingSet {
 public:
  /// @throws InvalidInput  as makeKnotEnergy
  MovingSet(const TriangleMesh& mesh, const std::vector<bool>& vertexMoves);

  Faces faces;
  std::vector<bool> vertexMoves;
  std::vector<bool> faceMoves;
  std::vector<std::int32_t> moving;     ///< faces with a moving vertex, ascending
  std::vector<std::int32_t> fixed;      ///< all others, ascending
  std::vector<AdjacentPair> edgePairs;  ///< each unordered pair once, at least one face moving
  std::vector<AdjacentPair> vertexPairs;

  /// Faces that share a corner with the k-th moving face, ascending; itself included.
  [[nodiscard]] std::span<const std::int32_t> touching(std::size_t k) const {
    return {touching_.data() + touchingBegin_[k], touching_.data() + touchingBegin_[k + 1]};
  }

  void requireVertexCount(const Positions& positions) const;

 private:
  std::vector<std::size_t> touchingBegin_;
  std::vector<std::int32_t> touching_;
};

[[nodiscard]] inline std::array<std::int32_t, 3> verticesOf(const Faces& faces, std::int32_t face) {
  return {faces(face, 0), faces(face, 1), faces(face, 2)};
}

[[nodiscard]] inline Corners cornersOf(const Positions& positions,
                                       const std::array<std::int32_t, 3>& v) {
  return {positions.row(v[0]).transpose(), positions.row(v[1]).transpose(),
          positions.row(v[2]).transpose()};
}

[[nodiscard]] inline Corners cornersOf(const Positions& positions, const Faces& faces,
                                       std::int32_t face) {
  return cornersOf(positions, verticesOf(faces, face));
}

/// Area of a face and its unit normal by the right-hand rule; zero normal for zero area.
struct FaceArea {
  double area = 0;
  Vector normal = Vector::Zero();
};
[[nodiscard]] FaceArea faceArea(const Corners& corners);

/// Derivative of the area by corner k.
[[nodiscard]] inline Vector areaByCorner(const Vector& normal, const Corners& c, int k) {
  return normal.cross(c[(k + 2) % 3] - c[(k + 1) % 3]) / 2;
}

/// Area of a face and its derivatives by the corners; zero derivatives for zero area.
struct AreaGradient {
  double area = 0;
  std::array<Vector, 3> byCorner;
};
[[nodiscard]] AreaGradient areaGradient(const Corners& corners);

}  // namespace explica::repulsion
