// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Flattening/Seen.h"

#include "Explica/Flattening/Comparison.h"
#include "Explica/Geometry/MeshMeasures.h"
#include "Explica/Geometry/MeshTopology.h"
#include "Explica/Visibility/VisibleFraction.h"

#include <cmath>

namespace explica::flattening {
namespace {

constexpr double kDistance = 3;  // of a viewpoint, over the surface's size

/// Points spread evenly over the unit sphere, along a spiral of the golden angle.
Vector onSphere(int n, int count) {
  const double golden = kPi * (3 - std::sqrt(5.0));
  const double z = 1 - (2 * n + 1.0) / count, radius = std::sqrt(1 - z * z);
  return {radius * std::cos(golden * n), radius * std::sin(golden * n), z};
}

/// With faces that run counter-clockwise, seen from above or from outside; an open surface that is
/// not flat has no outside.
TriangleMesh facingOut(TriangleMesh mesh, bool flat) {
  if (!flat && geometry::inspectMesh(mesh).closedManifold()) geometry::turnOutward(mesh);
  const bool down = flat && geometry::faceNormalVectors(mesh).col(2).sum() < 0;
  if (down) mesh.faces.col(1).swap(mesh.faces.col(2));
  return mesh;
}

}  // namespace

double seenShare(const TriangleMesh& given, int viewpoints) {
  const bool flat = isFlatMap(given, given.allFaces());
  const TriangleMesh mesh = facingOut(given, flat);
  Point low = Point::Constant(kInfinity), high = -low;
  for (Eigen::Index f = 0; f < mesh.faceCount(); ++f) {
    for (int k = 0; k < 3; ++k) {
      low = low.cwiseMin(mesh.corner(f, k));
      high = high.cwiseMax(mesh.corner(f, k));
    }
  }
  const Point centre = (low + high) / 2;
  const double distance = kDistance * (high - low).norm();
  if (flat) {
    const Point above = centre + 100 * distance * Vector(0, 0, 1);
    return visibility::visibleFraction(mesh, visibility::viewpoint(above)).total;
  }
  Eigen::VectorXd seen = Eigen::VectorXd::Zero(mesh.faceCount());
  visibility::VisibleFractionOptions one{.subdivision = 1};
  for (int n = 0; n < viewpoints; ++n) {
    const auto view = visibility::viewpoint(centre + distance * onSphere(n, viewpoints));
    seen = seen.cwiseMax(visibility::visibleFraction(mesh, view, one).face);
  }
  const Eigen::VectorXd areas = geometry::faceAreas(mesh);
  return seen.dot(areas) / areas.sum();
}

}  // namespace explica::flattening
