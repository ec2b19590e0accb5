// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Geometry/SphereLocator.h"

#include "Explica/Core/Errors.h"
#include "Explica/Core/IndicesWhere.h"
#include "Explica/Core/Parallel.h"
#include "Explica/Geometry/MeshTopology.h"
#include "Explica/Geometry/Predicates.h"

#include <algorithm>
#include <cmath>

namespace explica::geometry {
namespace {

constexpr double kUnitRounding = 1e-14;  // of unit vectors and of boxes about them
constexpr int kLongestWalk = 64;         // faces crossed before the tree is asked

/// Box of a spherical triangle of unit corners.  A point p of the flat triangle has |p|^2 >= 1 -
/// l^2 / 3, l its longest edge, and its direction is 1 - |p| away.
Box boxOf(const Point& a, const Point& b, const Point& c) {
  const double squared =
      std::max({(b - a).squaredNorm(), (c - b).squaredNorm(), (a - c).squaredNorm()});
  const double margin = 1 - std::sqrt(std::max(0.0, 1 - squared / 3)) + kUnitRounding;
  Box box(a);
  box.extend(b).extend(c);
  return {box.min() - Vector::Constant(margin), box.max() + Vector::Constant(margin)};
}

std::vector<Box> boxesOf(const TriangleMesh& mesh) {
  std::vector<Box> boxes(static_cast<std::size_t>(mesh.faceCount()));
  parallelFor(boxes.size(), [&](std::size_t f) {
    const auto face = static_cast<Eigen::Index>(f);
    boxes[f] = boxOf(mesh.corner(face, 0).normalized(), mesh.corner(face, 1).normalized(),
                     mesh.corner(face, 2).normalized());
  });
  return boxes;
}

Faces facesAcross(const TriangleMesh& mesh) {
  const MeshTopology topology = buildTopology(mesh.faces, mesh.vertexCount());
  Faces across(mesh.faceCount(), 3);
  for (Eigen::Index f = 0; f < mesh.faceCount(); ++f) {
    for (int k = 0; k < 3; ++k) {
      const auto pair = topology.edgeFaces.row(topology.faceEdges(f, k));
      across(f, k) = pair[0] == f ? pair[1] : pair[0];
    }
  }
  return across;
}

}  // namespace

int sphericalOrientation(const Point& a, const Point& b, const Point& c) {
  return -orientation(a, b, c, Point::Zero());
}

std::vector<std::int32_t> turnedOver(const TriangleMesh& mesh) {
  std::vector<char> turned(static_cast<std::size_t>(mesh.faceCount()));
  parallelFor(turned.size(), [&](std::size_t f) {
    const auto face = static_cast<Eigen::Index>(f);
    turned[f] =
        sphericalOrientation(mesh.corner(face, 0), mesh.corner(face, 1), mesh.corner(face, 2)) <= 0;
  });
  return indicesWhere(turned.size(), [&](std::size_t f) { return turned[f] != 0; });
}

SphereLocator::SphereLocator(TriangleMesh mesh) : mesh_(std::move(mesh)) {
  if (!(mesh_.positions.rowwise().squaredNorm().minCoeff() > 0)) {
    throw InvalidInput("sphere: a vertex is at the origin, so that it has no direction");
  }
  across_ = facesAcross(mesh_);
  tree_ = BoxTree(boxesOf(mesh_));
}

int SphereLocator::edgeBeyond(std::int32_t face, const Vector& direction) const {
  for (int k = 0; k < 3; ++k) {
    if (sphericalOrientation(mesh_.corner(face, k), mesh_.corner(face, (k + 1) % 3), direction) < 0)
      return k;
  }
  return -1;
}

SpherePlace SphereLocator::placeIn(std::int32_t face, const Vector& direction) const {
  SpherePlace place{face, {}};
  for (int k = 0; k < 3; ++k) {
    const Point a = mesh_.corner(face, (k + 1) % 3), b = mesh_.corner(face, (k + 2) % 3);
    place.weights[k] =
        sphericalOrientation(a, b, direction) > 0 ? std::max(0.0, a.cross(b).dot(direction)) : 0;
  }
  const double sum = place.weights.sum();
  if (sum > 0) {
    place.weights /= sum;
  } else {
    place.weights = Eigen::Vector3d(1, 0, 0);  // a face too small for its determinants
  }
  return place;
}

SpherePlace SphereLocator::locate(const Vector& direction) const {
  const Vector unit = direction.normalized();
  std::int32_t found = -1;
  tree_.forOverlaps(Box(unit), [&](std::int32_t face) {
    if (found >= 0 && face > found) return;
    if (edgeBeyond(face, direction) < 0) found = face;
  });
  if (found >= 0) return placeIn(found, direction);
  SpherePlace nearest;
  double least = kInfinity;
  for (Eigen::Index f = 0; f < mesh_.faceCount(); ++f) {
    const Point on =
        closestPointOnTriangle(unit, mesh_.corner(f, 0).normalized(),
                               mesh_.corner(f, 1).normalized(), mesh_.corner(f, 2).normalized());
    const double distance = (on - unit).squaredNorm();
    if (distance < least) {
      least = distance;
      nearest.face = static_cast<std::int32_t>(f);
    }
  }
  return placeIn(nearest.face, direction);
}

SpherePlace SphereLocator::locate(const Vector& direction, std::int32_t near) const {
  const Vector unit = direction.normalized();
  std::int32_t face = near;
  for (int n = 0; n < kLongestWalk && face >= 0; ++n) {
    const int edge = edgeBeyond(face, direction);
    if (edge >= 0) {
      face = across_(face, edge);
    } else if (mesh_.corner(face, 0).dot(unit) > 0) {
      return placeIn(face, direction);
    } else {
      break;  // a face turned over holds the opposite directions
    }
  }
  return locate(direction);
}

}  // namespace explica::geometry
