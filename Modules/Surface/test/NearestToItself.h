// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/TriangleMesh.h"
#include "Explica/Geometry/FaceTree.h"

#include <algorithm>

namespace explica::surface {

/// Nearest that points of a mesh (corners of faces, middles of edges) come to faces without a
/// corner in common with theirs, mm; infinite beyond `reach`.
inline double nearestToItself(const TriangleMesh& mesh, double reach = 1) {
  const geometry::BoxTree tree(geometry::faceBoxes(mesh, reach));
  double least = kInfinity;
  for (Eigen::Index f = 0; f < mesh.faceCount(); ++f) {
    for (int k = 0; k < 3; ++k) {
      const Point a = mesh.corner(f, k), b = mesh.corner(f, (k + 1) % 3);
      for (const Point& p : {a, Point(0.5 * (a + b))}) {
        tree.forOverlaps(geometry::Box(p), [&](std::int32_t g) {
          for (int i = 0; i < 3; ++i) {
            for (int j = 0; j < 3; ++j) {
              if (mesh.faces(f, i) == mesh.faces(g, j)) return;
            }
          }
          const Point q = geometry::closestPointOnTriangle(p, mesh.corner(g, 0), mesh.corner(g, 1),
                                                           mesh.corner(g, 2));
          least = std::min(least, (p - q).norm());
        });
      }
    }
  }
  return least;
}

}  // namespace explica::surface
