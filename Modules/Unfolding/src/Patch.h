// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "BlockSystem.h"

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
  double nearWeight = 0;  ///< o, mm^2: of a collar's face, the weight beside the region, less away
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

/// One force or one 3 x 3 block per corner or pair of corners; pairs in the order 00, 10, 11, 20,
/// 21, 22.
using CornerForces = std::array<Vector, 3>;
using CornerBlocks = std::array<Eigen::Matrix3d, 6>;

/// The stiffness of a face: inPlane * hat_i hat_j^T, and across * (hat_i . hat_j) n n^T for what
/// its tension does against moves out of its plane.
[[nodiscard]] CornerBlocks faceBlocks(const FaceShape& shape, double inPlane, double across);

/// Adds what faces contribute, in their order, to the gradient (V x 3).
void addForces(std::span<const PatchFace> faces, std::span<const CornerForces> forces,
               Positions& gradient);

/// Adds what faces contribute to the system.
/// @param unknown  V: row in the system, -1 for vertices that stay
void addBlocks(std::span<const PatchFace> faces, std::span<const CornerBlocks> blocks,
               const std::vector<std::int32_t>& unknown, BlockSystem& system);

}  // namespace explica::unfolding
