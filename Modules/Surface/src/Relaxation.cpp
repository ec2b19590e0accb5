// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Relaxation.h"

#include "Explica/Core/Parallel.h"
#include "GuardedMesh.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <vector>

namespace explica::surface {
namespace {

/// A vertex among its neighbours.
struct Ring {
  Point centre = Point::Zero();    ///< area-weighted mean of the faces' centroids
  Point mean = Point::Zero();      ///< of the neighbours
  Vector normal = Vector::Zero();  ///< area-weighted, of unit length; zero if there is none
};

Ring ringOf(const GuardedMesh& mesh, std::int32_t v) {
  Ring ring;
  double weight = 0;
  for (const std::int32_t f : mesh.facesOf(v)) {
    const auto& c = mesh.face(f);
    const Vector normal = mesh.normalOf(f);
    const double area = normal.norm();
    const Point sum = mesh.at(c[0]) + mesh.at(c[1]) + mesh.at(c[2]);
    ring.centre += area / 3 * sum;
    ring.mean += sum - mesh.at(v);
    ring.normal += normal;
    weight += area;
  }
  // Each neighbour is a corner of two faces.
  ring.mean /= 2 * static_cast<double>(mesh.valence(v));
  ring.centre = weight > 0 ? Point(ring.centre / weight) : mesh.at(v);
  const double length = ring.normal.norm();
  ring.normal = length > 0 ? Vector(ring.normal / length) : Vector(Vector::Zero());
  return ring;
}

/// When a ring's triangles want help; lengths in mean edges of the surface it grew out of.
struct Limits {
  double quality;    ///< of a face, 1 if equilateral: flatter ones are poor
  double stretched;  ///< length of an edge
  double crowded;    ///< area of a face
  double standsOut;  ///< way from a vertex to the mean of its neighbours
  double folded;     ///< cosine between a face's normal and the ring's
};
constexpr Limits kCrumpled{0.55, 2.7, 0.05, 1.2, 0.75};
/// What must not be left: 4 mm, 0.02 mm^2 and 1.5 mm where edges are 1.16 mm.
constexpr Limits kUnsound{0, 3.3, 0.02, 0.9, -1};

/// True if a face is too small, too long or too flat.
bool isPoor(const GuardedMesh& mesh, std::int32_t f, double edge, const Limits& limits) {
  const auto& c = mesh.face(f);
  double squares = 0, longest = 0;
  for (int k = 0; k < 3; ++k) {
    const double squared = (mesh.at(c[k]) - mesh.at(c[(k + 1) % 3])).squaredNorm();
    longest = std::max(longest, squared);
    squares += squared;
  }
  const double doubleArea = mesh.normalOf(f).norm();
  return longest > limits.stretched * limits.stretched * edge * edge ||
         doubleArea < 2 * limits.crowded * edge * edge ||
         2 * std::sqrt(3.0) * doubleArea < limits.quality * squares;
}

/// True if the triangles at a vertex are stretched, crowded, flat or folded, or it stands out.
bool isCrumpled(const GuardedMesh& mesh, std::int32_t v, double edge, const Limits& limits) {
  if (mesh.onRim(v)) return false;
  Vector sum = Vector::Zero();
  Point ring = Point::Zero();
  for (const std::int32_t f : mesh.facesOf(v)) {
    if (isPoor(mesh, f, edge, limits)) return true;
    sum += mesh.normalOf(f).normalized();
    for (const std::int32_t w : mesh.face(f)) ring += mesh.at(w);
  }
  // Each neighbour was counted twice, the vertex as often as it has faces.
  const auto faces = static_cast<double>(mesh.valence(v));
  ring = (ring - faces * mesh.at(v)) / (2 * faces);
  if ((ring - mesh.at(v)).norm() > limits.standsOut * edge) return true;
  for (const std::int32_t f : mesh.facesOf(v)) {
    const Vector normal = mesh.normalOf(f);
    if (normal.dot(sum) < limits.folded * normal.norm() * sum.norm()) return true;
  }
  return false;
}

/// Vertices of crumpled rings, and their neighbours.
std::vector<std::uint8_t> crumpled(const GuardedMesh& mesh, const std::vector<std::uint8_t>& moves,
                                   double edge, const Limits& limits) {
  std::vector<std::uint8_t> bad(moves.size()), near(moves.size(), 0);
  parallelFor(moves.size(), 1024, [&](std::size_t v) {
    bad[v] = isCrumpled(mesh, static_cast<std::int32_t>(v), edge, limits);
  });
  for (std::int32_t f = 0; f < mesh.faceSlots(); ++f) {
    const auto& c = mesh.face(f);
    if (!bad[c[0]] && !bad[c[1]] && !bad[c[2]]) continue;
    for (const std::int32_t v : c) near[v] = moves[v];
  }
  return near;
}

}  // namespace

TriangleMesh relaxed(const TriangleMesh& mesh, double edge, const std::vector<std::uint8_t>& moves,
                     const Placement& place, const RelaxationOptions& options) {
  GuardedMesh guarded(mesh, edge);
  const auto tryWays = [&](std::int32_t v, const Point& to, GuardedMesh::Scratch& scratch) {
    const Point from = guarded.at(v);
    for (const double share : {1.0, 0.5, 0.2, 0.05}) {
      if (guarded.move(v, from + share * (to - from), scratch)) return true;
    }
    return false;
  };
  for (int sweep = 0; sweep < options.sweeps; ++sweep) {
    const std::vector<std::uint8_t> active = crumpled(guarded, moves, edge, kCrumpled);
    guarded.sweep([&](std::int32_t v, GuardedMesh::Scratch& scratch) {
      if (!active[v] || guarded.onRim(v)) return true;
      const Ring ring = ringOf(guarded, v);
      const Vector step = ring.centre - guarded.at(v);
      const double across = ring.normal.dot(step);
      const double bend = std::clamp(options.bend * across, -options.most, options.most);
      const Point target = guarded.at(v) + step + (bend - across) * ring.normal;
      return tryWays(v, place(v, target, ring.normal), scratch);
    });
  }
  // A vertex without way of its own among others that have grown is a pit: it may move, too.
  const std::vector<std::uint8_t> all(mesh.vertexCount(), 1);
  for (int sweep = 0; sweep < options.lastSweeps; ++sweep) {
    const std::vector<std::uint8_t> active = crumpled(guarded, all, edge, kUnsound);
    guarded.sweep([&](std::int32_t v, GuardedMesh::Scratch& scratch) {
      if (!active[v] || guarded.onRim(v)) return true;
      const Ring ring = ringOf(guarded, v);
      return tryWays(v, sweep % 2 == 0 ? ring.mean : ring.centre, scratch);
    });
  }
  return guarded.toMesh();
}

}  // namespace explica::surface
