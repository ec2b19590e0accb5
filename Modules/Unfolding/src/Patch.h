// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Around.h"
#include "BlockSystem.h"

#include "Explica/Core/Parallel.h"
#include "Explica/Core/TriangleMesh.h"

#include <array>
#include <span>
#include <vector>

namespace explica::unfolding {

/// A face with a vertex that moves.
struct PatchFace {
  std::array<std::int32_t, 3> vertices;
  double restArea = 0;    ///< A0, mm^2, > 0
  double weight = 0;      ///< w, mm^2: the rest area, less for needles
  double holdWeight = 0;  ///< h, mm^2: the rest area, more for needles, whose ratio is bounded too
  double overWeight = 0;  ///< o, mm^2: w of a collar's face that stands over the region, else 0
};

/// An edge of such faces.
struct PatchSpring {
  std::array<std::int32_t, 2> vertices;
  double restLength = 0;  ///< l0, mm
  double weight = 0;      ///< e, mm^2: two thirds of the mean face, less for the shortest edges
};

/// Room for the region laid flat: the height along `axis` above which it is clear of all that
/// stands within its radius at rest.
struct PatchRoom {
  Vector axis = Vector::UnitZ();  ///< a, unit, towards the viewpoints
  double height = -kInfinity;     ///< mm, of x . axis
  double radius = 1;              ///< mm, of a disc of the region's area
  double depth = 0;  ///< mm: how far below `height` the region lies at rest, in the mean
};

/// A flat map of the region, laid across the way to the viewpoints where it fits the region at rest
/// best: it says which parts shall lie beside which.
struct PatchGuide {
  std::vector<std::int32_t> vertices = {};  ///< those that the map has; none: no guide
  std::vector<double> weights = {};         ///< a, mm^2: of each, the area that is its share
  Eigen::MatrixX2d flat = {};               ///< the map, mm, a row for each
  Positions places = {};                    ///< p, mm: the map where it is laid, a row for each
  Vector axis = Vector::UnitZ();            ///< unit, towards the viewpoints; p is normal to it
  double radius = 1;                        ///< R, mm, of a disc of the region's area
};

/// What moves, at rest: the region, and what joins it to its surroundings.
struct Patch {
  std::vector<PatchFace> faces;      ///< the region's, then the collar's
  std::size_t regionFaces = 0;       ///< how many of `faces` are the region's
  std::vector<PatchSpring> springs;  ///< of the region's edges, then of the collar's
  std::size_t regionSprings = 0;
  double yieldStrain = kInfinity;  ///< beyond it an edge's length costs less than its square
  PatchRoom room;
  PatchGuide guide;
  Around facesAround;    ///< corners of `faces` at each unknown
  Around springsAround;  ///< ends of `springs`

  [[nodiscard]] std::span<const PatchFace> ofRegion() const { return {faces.data(), regionFaces}; }
  [[nodiscard]] std::span<const PatchFace> ofCollar() const {
    return std::span(faces).subspan(regionFaces);
  }
  [[nodiscard]] std::span<const PatchSpring> regionEdges() const {
    return {springs.data(), regionSprings};
  }
  [[nodiscard]] std::span<const PatchSpring> collarEdges() const {
    return std::span(springs).subspan(regionSprings);
  }
};

/// Normal, area and gradients of the corner functions of a triangle in its plane.
struct FaceShape {
  Vector normal;              ///< outward, unit
  double area;                ///< mm^2
  std::array<Vector, 3> hat;  ///< mm^-1; the area's gradient is area * hat, the normal's
                              ///< differential -sum_i hat_i (normal . dx_i)
};

[[nodiscard]] FaceShape shapeOf(const PatchFace& face, const Positions& x);
[[nodiscard]] Point centroidOf(const PatchFace& face, const Positions& x);
[[nodiscard]] inline double lengthOf(const PatchSpring& spring, const Positions& x) {
  return (x.row(spring.vertices[1]) - x.row(spring.vertices[0])).norm();
}

/// Lists what lies around each unknown.
/// @param unknown  V: row in the system, -1 for vertices that stay
void listAround(Patch& patch, const std::vector<std::int32_t>& unknown);

/// One force per corner.
using CornerForces = std::array<Vector, 3>;

/// How stiff a face is: inPlane * hat_i hat_j^T, and across * (hat_i . hat_j) n n^T for what its
/// tension does against moves out of its plane.
struct FaceStiffness {
  double inPlane = 0;
  double across = 0;
};

/// The 3 x 3 block of two of its corners.
[[nodiscard]] inline Eigen::Matrix3d blockOf(const FaceShape& shape, const FaceStiffness& stiffness,
                                             int i, int j) {
  const Eigen::Matrix3d normal = stiffness.across * shape.normal * shape.normal.transpose();
  return stiffness.inPlane * shape.hat[i] * shape.hat[j].transpose() +
         shape.hat[i].dot(shape.hat[j]) * normal;
}
/// ... of a face whose blocks are all the same.
[[nodiscard]] inline const Eigen::Matrix3d& blockOf(const FaceShape& /*shape*/,
                                                    const Eigen::Matrix3d& block, int /*i*/,
                                                    int /*j*/) {
  return block;
}

/// A tension in its plane as forces on its corners.
[[nodiscard]] inline CornerForces inPlaneForces(const FaceShape& shape, double tension) {
  return {tension * shape.hat[0], tension * shape.hat[1], tension * shape.hat[2]};
}

/// Adds what items contribute to the system, on several threads.
/// @param around      their corners
/// @param verticesOf  verticesOf(item) gives its vertices
/// @param unknown     V: row in the system, -1 for vertices that stay
/// @param blockOf     blockOf(item, i, j) is the block of its corners i >= j
template <class VerticesOf, class BlockOf>
void addBlocks(const Around& around, std::size_t firstItem, std::size_t itemCount,
               const VerticesOf& verticesOf, const std::vector<std::int32_t>& unknown,
               BlockSystem& system, const BlockOf& blockOf) {
  constexpr std::size_t kGrain = 256;  // rows a task
  const auto first = static_cast<std::int32_t>(firstItem);
  const auto end = static_cast<std::int32_t>(firstItem + itemCount);
  parallelFor(around.rows(), kGrain, [&](std::size_t n) {
    const auto row = static_cast<std::int32_t>(n);
    for (const auto& [item, i] : around.at(n)) {
      if (item < first) continue;
      if (item >= end) break;
      std::int32_t j = 0;
      for (const std::int32_t vertex : verticesOf(item)) {
        const std::int32_t column = unknown[vertex];
        if (column >= 0 && column <= row) {
          if (i >= j) {
            system.add(row, column, blockOf(item, i, j));
          } else {
            system.add(row, column, blockOf(item, j, i).transpose());
          }
        }
        ++j;
      }
    }
  });
}

}  // namespace explica::unfolding
