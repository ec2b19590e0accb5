// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/TriangleMesh.h"
#include "Explica/Geometry/FaceTree.h"

#include <vector>

namespace explica::geometry {

/// Exact sign of det(a, b, c): 1 if the spherical triangle (a, b, c) about the origin runs
/// counter-clockwise seen from outside, 0 if a plane through the origin holds all three.
[[nodiscard]] int sphericalOrientation(const Point& a, const Point& b, const Point& c);

/// Faces that do not run counter-clockwise seen from outside, ascending; exact.
/// @param mesh  a closed surface about the origin
[[nodiscard]] std::vector<std::int32_t> turnedOver(const TriangleMesh& mesh);

/// A place on a spherical mesh: a direction is a positive multiple of the weighted corners.
struct SpherePlace {
  std::int32_t face = -1;
  Eigen::Vector3d weights = Eigen::Vector3d::Constant(kNaN);  ///< >= 0, of sum 1
};

/// Finds the face of a spherical mesh that a direction from the origin meets.
///
/// Sidedness is decided exactly, so that every direction has a face of a one-to-one mesh, also on
/// its edges and at its vertices.  Keeps a copy of the mesh.
class SphereLocator {
 public:
  /// @param mesh  closed, about the origin; radii may vary
  /// @throws InvalidInput  a vertex at the origin
  explicit SphereLocator(TriangleMesh mesh);

  /// The first of the faces that hold the direction; where faces turned over leave it none, the
  /// face of which it is least outside.
  [[nodiscard]] SpherePlace locate(const Vector& direction) const;
  /// A face that holds the direction, searched first across edges from face `near`: of several the
  /// one that is come upon.
  [[nodiscard]] SpherePlace locate(const Vector& direction, std::int32_t near) const;

  [[nodiscard]] const TriangleMesh& mesh() const { return mesh_; }

 private:
  [[nodiscard]] SpherePlace placeIn(std::int32_t face, const Vector& direction) const;
  [[nodiscard]] int edgeBeyond(std::int32_t face, const Vector& direction) const;

  TriangleMesh mesh_;
  Faces across_;  ///< F x 3: the face beyond edge k, of corners k and (k + 1) % 3; -1 if none
  BoxTree tree_;  ///< of the spherical triangles on the unit sphere
};

}  // namespace explica::geometry
