// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Guide.h"

#include "Explica/Core/Errors.h"
#include "Explica/Flattening/Flatten.h"
#include "Explica/Geometry/MeshMeasures.h"

#include <Eigen/Geometry>

#include <cmath>
#include <optional>

namespace explica::unfolding {
namespace {

/// None where the region is nothing that can be laid flat.
std::optional<flattening::Disc> discOf(const TriangleMesh& mesh, const Region& region) {
  try {
    return flattening::discOf(mesh, region.faces);
  } catch (const InvalidInput&) {
    return std::nullopt;
  }
}

/// Stopped at once, a map is that of few vertices, with the others where there was room.
flattening::FlatPositions mapOf(const flattening::Disc& disc) {
  Monitor atOnce;
  atOnce.stopWanted = [] { return true; };
  return flattening::flatten(disc, {}, atOnce).positions;
}

}  // namespace

PatchGuide makeGuide(const TriangleMesh& mesh, const Region& region, const PatchRoom& room) {
  PatchGuide guide;
  if (!std::isfinite(room.height)) return guide;  // looked at from all sides
  const auto disc = discOf(mesh, region);
  if (!disc) return guide;
  guide.vertices = disc->vertexOrigin;
  guide.flat = mapOf(*disc);
  guide.weights.assign(guide.vertices.size(), 0);
  const Eigen::VectorXd areas = geometry::faceAreas(disc->mesh);
  for (Eigen::Index f = 0; f < areas.size(); ++f) {
    for (int k = 0; k < 3; ++k) guide.weights[disc->mesh.faces(f, k)] += areas[f] / 3;
  }
  layGuide(mesh, room, guide);
  return guide;
}

/// The turn is that of least squares in the plane: the direction of the sum of a conj(z) w, z a
/// vertex's place in the map and w the one where it stands, both from their means.
void layGuide(const TriangleMesh& mesh, const PatchRoom& room, PatchGuide& guide) {
  if (guide.vertices.empty()) return;
  guide.axis = room.axis;
  guide.radius = room.radius;
  Eigen::Matrix<double, 3, 2> plane;  // right and up, as seen from the viewpoints
  plane.col(0) = room.axis.unitOrthogonal();
  plane.col(1) = room.axis.cross(plane.col(0));
  const Eigen::MatrixX2d standing = mesh.positions(guide.vertices, Eigen::all) * plane;
  const Eigen::Map<const Eigen::VectorXd> a(guide.weights.data(), guide.flat.rows());
  const Eigen::RowVector2d from = a.transpose() * guide.flat / a.sum();
  const Eigen::RowVector2d to = a.transpose() * standing / a.sum();
  const Eigen::MatrixX2d z = guide.flat.rowwise() - from;
  const Eigen::Matrix2d moments = z.transpose() * a.asDiagonal() * (standing.rowwise() - to);
  const Eigen::Vector2d sum(moments.trace(), moments(0, 1) - moments(1, 0));
  const Eigen::Vector2d along = sum.norm() > 0 ? sum.normalized() : Eigen::Vector2d(1, 0);
  Eigen::Matrix2d turn;
  turn << along.x(), -along.y(), along.y(), along.x();
  guide.places = ((z * turn.transpose()).rowwise() + to) * plane.transpose();
}

}  // namespace explica::unfolding
