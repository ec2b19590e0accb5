// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Room.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

namespace explica::unfolding {
namespace {

// Of unit length: below it viewpoints look from all sides, and no way leads towards them.
constexpr double kOneSide = 0.1;
// Of the room's radius: so far above what stands within it the region shall lie.
constexpr double kAbove = 0.1;

struct Middle {
  Point place = Point::Zero();  ///< mean of the faces by area
  double area = 0;
};

Middle middleOf(const TriangleMesh& mesh, const Region& region) {
  Middle middle;
  for (const std::int32_t f : region.faces) {
    const Point a = mesh.corner(f, 0), b = mesh.corner(f, 1), c = mesh.corner(f, 2);
    const double area = 0.5 * (b - a).cross(c - a).norm();
    middle.place += area / 3 * (a + b + c);
    middle.area += area;
  }
  middle.place /= middle.area;
  return middle;
}

}  // namespace

PatchRoom findRoom(const TriangleMesh& mesh, const Region& region,
                   const visibility::Viewpoints& viewpoints) {
  PatchRoom room;
  const Middle middle = middleOf(mesh, region);
  room.radius = std::sqrt(middle.area / kPi);
  Vector towards = Vector::Zero();
  for (std::size_t k = 0; k < viewpoints.points.size(); ++k) {
    towards += viewpoints.weights[k] * (viewpoints.points[k] - middle.place).normalized();
  }
  if (towards.norm() <= kOneSide) return room;
  room.axis = towards.normalized();
  double top = -kInfinity;
  for (Eigen::Index v = 0; v < mesh.vertexCount(); ++v) {
    const Vector from = mesh.positions.row(v).transpose() - middle.place;
    const double height = room.axis.dot(from);
    if ((from - height * room.axis).norm() < room.radius) top = std::max(top, height);
  }
  room.depth = std::max(0.0, top + kAbove * room.radius);
  room.height = top + kAbove * room.radius + room.axis.dot(middle.place);
  return room;
}

double sunkShare(const Patch& patch, const Positions& x) {
  double sunk = 0, all = 0;
  for (const PatchFace& face : patch.ofRegion()) {
    all += face.restArea;
    if (deficitOf(patch.room, centroidOf(face, x)) > kAbove * patch.room.radius) {
      sunk += face.restArea;
    }
  }
  return sunk / all;
}

}  // namespace explica::unfolding
