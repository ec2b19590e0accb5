// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Visibility/SphereView.h"

#include "Rays.h"

#include "Explica/Core/Errors.h"
#include "Explica/Core/Parallel.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

namespace explica::visibility {
namespace {

constexpr std::size_t kSphereGrain = 256;  // faces a task
constexpr double kEnclosingRadius = 3;     // of the box's diagonal
constexpr double kBeyond = 1.001;          // of the mesh's ball: nothing stands farther away

/// The viewpoints before a face, as a packet after the other, and what arrives from them.
class FaceLook {
 public:
  FaceLook(const Occluders& occluders, std::size_t face, const Point& from, double radius)
      : occluders_(occluders),
        face_(static_cast<std::uint32_t>(face)),
        from_(from),
        length_(from.norm() + kBeyond * radius) {}

  void add(const Vector& unit, double distance, double flux) {
    by_[packet_.count] = unit;
    fluxes_[packet_.count] = flux;
    possible += flux;
    packet_.add(from_, unit, std::min(distance, length_), face_);
    if (packet_.count == Occluders::kPacket) cast();
  }

  void cast() {
    if (packet_.count == 0) return;
    const std::uint32_t clear = occluders_.clear(packet_);
    for (std::size_t n = 0; n < packet_.count; ++n) {
      if ((clear >> n & 1U) == 0) continue;
      arriving += fluxes_[n];
      direction += by_[n];
    }
    packet_.count = 0;
  }

  double possible = 0, arriving = 0;
  Vector direction = Vector::Zero();

 private:
  const Occluders& occluders_;
  std::uint32_t face_;
  Point from_;
  double length_;
  Occluders::Packet packet_;
  std::array<Vector, Occluders::kPacket> by_;
  std::array<double, Occluders::kPacket> fluxes_ = {};
};

}  // namespace

Viewpoints viewSphere(const Point& centre, double radius, int count) {
  if (count < 1) throw InvalidInput("view sphere: " + std::to_string(count) + " points");
  if (!(radius > 0)) throw InvalidInput("view sphere: the radius must be positive");
  const double golden = kPi * (3 - std::sqrt(5.0));
  Viewpoints sphere;
  for (int n = 0; n < count; ++n) {
    const double z = 1 - (2 * n + 1.0) / count, across = std::sqrt(1 - z * z);
    sphere.points.emplace_back(
        centre + radius * Vector(across * std::cos(golden * n), across * std::sin(golden * n), z));
    sphere.weights.push_back(1.0 / count);
  }
  return sphere;
}

Viewpoints enclosingSphere(const TriangleMesh& mesh, int count) {
  Point low = Point::Constant(kInfinity), high = -low;
  for (Eigen::Index f = 0; f < mesh.faceCount(); ++f) {
    for (int k = 0; k < 3; ++k) {
      low = low.cwiseMin(mesh.corner(f, k));
      high = high.cwiseMax(mesh.corner(f, k));
    }
  }
  return viewSphere((low + high) / 2, kEnclosingRadius * (high - low).norm(), count);
}

SphereView lookFromSphere(const TriangleMesh& mesh, const Viewpoints& viewpoints) {
  requireInputs(mesh, viewpoints, "sphere view");
  const Frame frame = frameOf(mesh.positions);
  const Occluders occluders(mesh, frame.middle);
  SphereView view;
  view.direction = Positions::Zero(mesh.faceCount(), 3);
  view.share.setZero(mesh.faceCount());
  view.seen.setZero(mesh.faceCount());
  Eigen::VectorXd areas(mesh.faceCount());
  parallelFor(static_cast<std::size_t>(mesh.faceCount()), kSphereGrain, [&](std::size_t i) {
    const auto f = static_cast<Eigen::Index>(i);
    const Point a = mesh.corner(f, 0), b = mesh.corner(f, 1), c = mesh.corner(f, 2);
    const Vector twice = (b - a).cross(c - a);
    areas[f] = twice.norm() / 2;
    if (!(areas[f] > 0)) return;
    const Vector normal = twice.normalized();
    const Point from = (a + b + c) / 3;
    FaceLook look(occluders, i, from - frame.middle, frame.radius);
    for (std::size_t p = 0; p < viewpoints.points.size(); ++p) {
      const Vector towards = viewpoints.points[p] - from;
      const double distance = towards.norm(), flux = normal.dot(towards) / distance;
      if (flux > 0) look.add(towards / distance, distance, flux);
    }
    look.cast();
    if (!(look.possible > 0)) return;
    view.direction.row(f) = look.direction.transpose() / look.possible;
    view.share[f] = look.arriving / look.possible;
    view.seen[f] = look.arriving > 0 ? 1 : 0;
  });
  const double total = areas.sum();
  view.visibility = total > 0 ? view.share.dot(areas) / total : 0;
  view.seenShare = total > 0 ? view.seen.dot(areas) / total : 0;
  return view;
}

}  // namespace explica::visibility
