// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Relaxation.h"

#include "Explica/Core/Parallel.h"
#include "GuardedMesh.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <numeric>
#include <utility>
#include <vector>

namespace explica::surface {
namespace {

/// When a ring's triangles want help; lengths in mean edges of the surface it grew out of.
struct Limits {
  double quality;    ///< of a face, 1 if equilateral: flatter ones are poor
  double stretched;  ///< length of an edge
  double crowded;    ///< area of a face
  double standsOut;  ///< way from a vertex to the mean of its neighbours
  double folded;     ///< cosine between a face's normal and the ring's
};
// Stricter than kUnsound: mended while surfaces grow.
constexpr Limits kCrumpled{0.55, 2.7, 0.05, 1.2, 0.75};
/// What must not be left: 4 mm, 0.02 mm^2 and 1.5 mm where edges are 1.16 mm.
constexpr Limits kUnsound{0, 3.3, 0.02, 1.2, -1};

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
  if (mesh.onRim(v)) {
    return std::any_of(mesh.facesOf(v).begin(), mesh.facesOf(v).end(),
                       [&](std::int32_t f) { return isPoor(mesh, f, edge, limits); });
  }
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

/// Vertices of crumpled rings and their neighbours, looked for anew only where something may have
/// moved since.
class Crumpled {
 public:
  /// @param moves  1 for the vertices that may be among them
  Crumpled(const GuardedMesh& mesh, const std::vector<std::uint8_t>& moves, double edge,
           const Limits& limits)
      : mesh_(mesh),
        moves_(moves),
        edge_(edge),
        limits_(limits),
        bad_(moves.size(), 0),
        listed_(moves.size(), 0) {
    stale_.resize(moves.size());
    std::iota(stale_.begin(), stale_.end(), 0);
  }

  /// In the order of their numbers.
  const std::vector<std::int32_t>& vertices() {
    parallelFor(stale_.size(), 256, [&](std::size_t k) {
      bad_[stale_[k]] = isCrumpled(mesh_, stale_[k], edge_, limits_);
    });
    // What is known and not stale is as bad as it was.
    std::vector<std::int32_t> both;
    std::set_union(known_.begin(), known_.end(), stale_.begin(), stale_.end(),
                   std::back_inserter(both));
    std::erase_if(both, [&](std::int32_t v) { return bad_[v] == 0; });
    known_ = std::move(both);
    near_ = withNeighbours(known_);
    std::erase_if(near_, [&](std::int32_t v) { return !moves_[v]; });
    stale_ = withNeighbours(near_);
    return near_;
  }

 private:
  /// The vertices of a list's faces, each once, in the order of their numbers.
  [[nodiscard]] std::vector<std::int32_t> withNeighbours(
      const std::vector<std::int32_t>& vertices) {
    for (const std::int32_t v : vertices) {
      for (const std::int32_t f : mesh_.facesOf(v)) {
        for (const std::int32_t w : mesh_.face(f)) listed_[w] = 1;
      }
    }
    std::vector<std::int32_t> list;
    for (std::size_t v = 0; v < listed_.size(); ++v) {
      if (std::exchange(listed_[v], 0) != 0) list.push_back(static_cast<std::int32_t>(v));
    }
    return list;
  }

  const GuardedMesh& mesh_;
  const std::vector<std::uint8_t>& moves_;
  double edge_;
  Limits limits_;
  std::vector<std::uint8_t> bad_, listed_;
  std::vector<std::int32_t> stale_, known_, near_;
};

/// What is tried of a way, one after another.
constexpr std::array<double, 4> kShares = {1.0, 0.5, 0.2, 0.05};
/// The same where many go together, sweep after sweep.
constexpr std::array<double, 2> kSharesTogether = {1.0, 0.3};
/// Steps shorter than this are not worth a look at what is in the way, edges.
constexpr double kSmallStep = 0.01;

Point partOfWay(const Point& from, const Point& to, double share) {
  return from + share * (to - from);
}

}  // namespace

TriangleMesh relaxed(const TriangleMesh& mesh, double edge, const std::vector<std::uint8_t>& moves,
                     const Placement& place, const RelaxationOptions& options) {
  GuardedMesh guarded(mesh, edge);
  Crumpled crumpled(guarded, moves, edge, kCrumpled);
  for (int sweep = 0; sweep < options.sweeps; ++sweep) {
    std::vector<std::int32_t> vertices = crumpled.vertices();
    std::vector<Point> goal(mesh.vertexCount());
    parallelFor(vertices.size(), 64, [&](std::size_t n) {
      const std::int32_t v = vertices[n];
      if (guarded.onRim(v)) {
        goal[v] = guarded.alongRim(v);
        return;
      }
      const GuardedMesh::Ring ring = guarded.ringOf(v);
      const Vector step = ring.centre - guarded.at(v);
      const double across = ring.normal.dot(step);
      const double bend = std::clamp(options.bend * across, -options.most, options.most);
      const Point target = guarded.at(v) + step + (bend - across) * ring.normal;
      goal[v] = place(v, target, ring.normal);
    });
    std::erase_if(vertices, [&](std::int32_t v) {
      return (goal[v] - guarded.at(v)).squaredNorm() < kSmallStep * kSmallStep * edge * edge;
    });
    guarded.moveTogether(vertices, static_cast<int>(kSharesTogether.size()),
                         [&](std::int32_t v, int way) {
                           return partOfWay(guarded.at(v), goal[v], kSharesTogether[way]);
                         });
  }
  // A vertex without way of its own among others that have grown is a pit: it may move, too.
  const std::vector<std::uint8_t> all(mesh.vertexCount(), 1);
  Crumpled unsound(guarded, all, edge, kUnsound);
  for (int sweep = 0; sweep < options.lastSweeps; ++sweep) {
    guarded.sweep(unsound.vertices(), [&](std::int32_t v, GuardedMesh::Scratch& scratch) {
      if (guarded.onRim(v)) return true;
      const GuardedMesh::Ring ring = guarded.ringOf(v);
      const Point from = guarded.at(v), to = sweep % 2 == 0 ? ring.mean : ring.centre;
      return std::any_of(kShares.begin(), kShares.end(), [&](double share) {
        return guarded.move(v, partOfWay(from, to, share), scratch);
      });
    });
  }
  return guarded.toMesh();
}

}  // namespace explica::surface
