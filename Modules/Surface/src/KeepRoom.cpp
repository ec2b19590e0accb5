// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "KeepRoom.h"

#include "Explica/Collision/CollisionScene.h"
#include "Explica/Collision/Proximity.h"
#include "Explica/Core/IndicesWhere.h"
#include "Explica/Core/Parallel.h"
#include "MoveTogether.h"
#include "Turns.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace explica::surface {
namespace {

using collision::CollisionScene;
using collision::Pair;
using collision::Proximity;

/// Nearest that a surface comes to itself, voxels or edges; smallest face, squared edges.
constexpr double kGap = 0.05, kLeastArea = 0.02;
constexpr int kRoomSweeps = 16;
/// Sweeps in which all vertices go at once; then quarters, for which others do not get in the way.
constexpr int kTogether = 6;
/// Looks for pairs: faces that grow may come near to what was far at the look before.
constexpr int kLooks = 6;
/// Pushed a little farther than the gap, which the next push from elsewhere may take again.
constexpr double kBeyond = 1.1;
/// Shares of a push that are tried.
constexpr std::array<double, 3> kRoomShares = {1.0, 0.4, 0.1};

/// A quarter of the vertices, another one each sweep.
bool isItsTurn(std::int32_t v, int sweep) {
  return (mixedBits(v) & 3U) == (static_cast<std::uint32_t>(sweep) & 3U);
}

/// Pushes on vertices.
class Pushes {
 public:
  explicit Pushes(Eigen::Index vertices) : push_(vertices), count_(vertices, 0), most_(vertices) {}

  /// @param most  farthest that the vertex may have gone from its start then, mm
  void add(std::int32_t v, const Vector& push, double most) {
    if (count_[v]++ == 0) {
      push_[v] = Vector::Zero();
      most_[v] = 0;
      pushed_.push_back(v);
    }
    push_[v] += push;
    most_[v] = std::max(most_[v], most);
  }

  /// In the order of their numbers.
  [[nodiscard]] const std::vector<std::int32_t>& vertices() {
    std::sort(pushed_.begin(), pushed_.end());
    return pushed_;
  }
  /// From `at`, by a share of the mean of the pushes, but not far from `start`.
  [[nodiscard]] Point goal(std::int32_t v, const Point& start, const Point& at,
                           double share) const {
    Vector way = at + share / count_[v] * push_[v] - start;
    const double length = way.norm();
    if (length > most_[v]) way *= most_[v] / length;
    return start + way;
  }

 private:
  std::vector<Vector> push_;
  std::vector<int> count_;
  std::vector<double> most_;
  std::vector<std::int32_t> pushed_;
};

/// The pushes that bring a pair to `wanted` mm, least in the sum of squares.
void pushApart(const CollisionScene& scene, const Pair& pair, const Proximity& proximity,
               double wanted, double most, Pushes& pushes) {
  const double distance = std::sqrt(proximity.squaredDistance);
  if (!(distance > 0)) return;
  double squares = 0;
  for (const double w : proximity.weights) squares += w * w;
  const Vector way = (wanted - distance) / (squares * distance) * proximity.difference;
  const auto vertices = scene.vertices(pair);
  for (int k = 0; k < 4; ++k) {
    if (proximity.weights[k] != 0) pushes.add(vertices[k], proximity.weights[k] * way, most);
  }
}

double areaOf(const TriangleMesh& mesh, std::int32_t f) {
  const Point a = mesh.corner(f, 0);
  return (mesh.corner(f, 1) - a).cross(mesh.corner(f, 2) - a).norm() / 2;
}

/// The pushes along a face's area's gradient that bring the area to `wanted` mm^2.
void widen(const TriangleMesh& mesh, std::int32_t f, double wanted, double most, Pushes& pushes) {
  const std::array<Point, 3> p = {mesh.corner(f, 0), mesh.corner(f, 1), mesh.corner(f, 2)};
  const Vector cross = (p[1] - p[0]).cross(p[2] - p[0]);
  const double doubled = cross.norm();
  if (!(doubled > 0)) return;
  std::array<Vector, 3> gradient;
  double squares = 0;
  for (int k = 0; k < 3; ++k) {
    gradient[k] = cross.cross(p[(k + 2) % 3] - p[(k + 1) % 3]) / (2 * doubled);
    squares += gradient[k].squaredNorm();
  }
  for (int k = 0; k < 3; ++k) {
    Vector push = (wanted - doubled / 2) / squares * gradient[k];
    const double length = push.norm();
    if (length > most) push *= most / length;
    pushes.add(mesh.faces(f, k), push, most);
  }
}

std::vector<std::int32_t> smallFaces(const TriangleMesh& mesh, double leastArea) {
  std::vector<std::uint8_t> isSmall(static_cast<std::size_t>(mesh.faceCount()));
  parallelFor(isSmall.size(), 8192, [&](std::size_t f) {
    isSmall[f] = areaOf(mesh, static_cast<std::int32_t>(f)) < leastArea;
  });
  return indicesWhere(isSmall.size(), [&](std::size_t f) { return isSmall[f] != 0; });
}

/// Pushes, sweep by sweep, what is known to be near; returns what is left of it.
Cramped sweepApart(TriangleMesh& mesh, geometry::SelfIntersectionSearch& search,
                   const CollisionScene& scene, const std::vector<Pair>& candidates,
                   const Room& room) {
  const Positions start = mesh.positions;
  std::vector<Proximity> proximities(candidates.size());
  for (int sweep = 0;; ++sweep) {
    parallelFor(candidates.size(), 256, [&](std::size_t n) {
      proximities[n] =
          collision::findProximity(candidates[n].kind, scene.points(candidates[n], mesh.positions));
    });
    Pushes pushes(mesh.vertexCount());
    Cramped left;
    for (std::size_t n = 0; n < candidates.size(); ++n) {
      if (proximities[n].squaredDistance >= room.gap * room.gap) continue;
      ++left.pairs;
      pushApart(scene, candidates[n], proximities[n], kBeyond * room.gap, room.gap, pushes);
    }
    for (const std::int32_t f : smallFaces(mesh, room.leastArea)) {
      ++left.faces;
      widen(mesh, f, kBeyond * room.leastArea, std::sqrt(room.leastArea), pushes);
    }
    if (left.pairs + left.faces == 0 || sweep == kRoomSweeps) return left;
    const Positions from = mesh.positions;
    std::vector<std::int32_t> vertices = pushes.vertices();
    if (sweep >= kTogether) {
      std::erase_if(vertices, [&](std::int32_t v) { return !isItsTurn(v, sweep); });
    }
    moveTogether(mesh, search, vertices, static_cast<int>(kRoomShares.size()),
                 [&](std::int32_t v, int attempt) {
                   return pushes.goal(v, start.row(v), from.row(v), kRoomShares[attempt]);
                 });
  }
}

}  // namespace

Room roomFor(double voxel, double edge) {
  return {kGap * std::min(voxel, edge), kLeastArea * edge * edge};
}

Cramped keepRoom(TriangleMesh& mesh, const Room& room) {
  const CollisionScene scene(mesh,
                             std::vector<bool>(static_cast<std::size_t>(mesh.vertexCount()), true));
  const Positions still = Positions::Zero(mesh.vertexCount(), 3);
  geometry::SelfIntersectionSearch search;
  Cramped left;
  for (int look = 0; look < kLooks; ++look) {
    const bool shrunk = !smallFaces(mesh, room.leastArea).empty();
    // Two vertices that move by the gap each come no nearer than it to what is left out.
    const std::vector<Pair> candidates = scene.findPairs(mesh.positions, still, 3 * room.gap);
    left = sweepApart(mesh, search, scene, candidates, room);
    if (!shrunk && left.pairs == 0) break;
  }
  return left;
}

}  // namespace explica::surface
