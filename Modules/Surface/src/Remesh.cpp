// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Surface/Remesh.h"

#include "Explica/Core/Errors.h"
#include "Explica/Core/Parallel.h"
#include "Explica/Core/StopScope.h"
#include "Explica/Geometry/MeshMeasures.h"
#include "Explica/Geometry/MeshTopology.h"
#include "GuardedMesh.h"
#include "OntoLevel.h"
#include "SpatialOrder.h"
#include "Thinning.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

namespace explica::surface {
namespace {

/// Edges shorter than this share of the aim are collapsed [Botsch2004, Sec. 4].
constexpr double kShort = 4.0 / 5;

/// No edge is aimed at that is shorter than this share of a voxel: of so small a triangle the
/// volume can tell nothing.
constexpr double kFinest = 0.2;
/// The mesh is stored anew once it has so many times the faces.
constexpr double kGrown = 1.5;

/// Edge of the blocks in which the mesh is stored, in edges.
constexpr double kBlock = 4;
/// Edges are worked on by length in classes of this share of the aim, each in the order of storage.
constexpr double kQueueClass = 0.1;

using Edge = GuardedMesh::Edge;

class Remesher {
 public:
  Remesher(const TriangleMesh& mesh, const LevelSet& level, double edge)
      : mesh_(thinned(inSpatialOrder(mesh, kBlock * edge), level, edge), edge),
        level_(level),
        edge_(edge),
        voxel_(voxelSize(level.grid)),
        stored_(mesh_.faceCount()) {}

  void setEdge(double edge) { edge_ = edge; }
  [[nodiscard]] double edge() const { return edge_; }
  [[nodiscard]] GuardedMesh& mesh() { return mesh_; }

  /// Stores the mesh in the order of space, which changes have spoilt.
  void tidy() {
    mesh_ = GuardedMesh(inSpatialOrder(mesh_.toMesh(), kBlock * edge_), edge_);
    stored_ = mesh_.faceCount();
  }

  void splitLong() {
    if (static_cast<double>(mesh_.faceCount()) > kGrown * static_cast<double>(stored_)) tidy();
    for (const Edge& e : edges([&](double length) { return length > kLong * edge_; }, true)) {
      if (mesh_.areJoined(e[0], e[1])) mesh_.split(e[0], e[1]);
    }
  }

  void collapseShort(double share) {
    GuardedMesh::CollapseLimits limits;
    limits.longestEdge = kLong * edge_;
    const double limit = share * edge_;
    mesh_.sweepEdges(edges([&](double length) { return length < limit; }, false),
                     [&](const Edge& e, GuardedMesh::Scratch& scratch) {
                       if (stillShort(e, limit)) collapse(e, limits, scratch);
                     });
  }

  void flipForValence() {
    mesh_.sweepEdges(allEdges(), [&](const Edge& e, GuardedMesh::Scratch& scratch) {
      if (wantsFlip(e[0], e[1])) mesh_.flip(e[0], e[1], scratch);
    });
  }

  void smooth() {
    std::vector<Point> centre(mesh_.vertexSlots());
    parallelFor(centre.size(), 256, [&](std::size_t v) {
      const auto vertex = static_cast<std::int32_t>(v);
      if (mesh_.hasVertex(vertex)) centre[v] = centred(vertex);
    });
    // Half way is often free where the whole way is not.
    constexpr int kWays = 2;
    mesh_.moveTogether(mesh_.allVertices(), kWays, [&](std::int32_t v, int way) {
      return way == 0 ? onLevel(v, centre[v]) : Point(0.5 * (mesh_.at(v) + centre[v]));
    });
  }

  /// Collapses the shortest or splits the longest edges until the count is met.
  void meetCount(std::int64_t wanted) {
    for (int pass = 0; pass < 6 && mesh_.faceCount() != wanted; ++pass) {
      const bool tooMany = mesh_.faceCount() > wanted;
      GuardedMesh::CollapseLimits limits;
      limits.longestEdge = (kLong + 0.2 * pass) * edge_;
      limits.leastQuality = 0.3;
      const double share = tooMany ? kShort + 0.15 * (pass + 1) : 1.1 - 0.1 * pass;
      for (const Edge& e : edges(
               [&](double length) {
                 return tooMany ? length < share * edge_ : length > share * edge_;
               },
               !tooMany)) {
        if (tooMany ? mesh_.faceCount() <= wanted : mesh_.faceCount() >= wanted) break;
        if (!mesh_.hasVertex(e[0]) || !mesh_.hasVertex(e[1]) || !mesh_.areJoined(e[0], e[1])) {
          continue;
        }
        if (tooMany) {
          collapse(e, limits, mesh_.scratch());
        } else {
          mesh_.split(e[0], e[1]);
        }
      }
    }
  }

 private:
  /// Edges whose length fulfils a condition, shortest first or longest first; those of nearly the
  /// same length in the order of storage.
  template <class Condition>
  std::vector<Edge> edges(const Condition& wanted, bool longestFirst) const {
    std::vector<std::pair<int, Edge>> found;
    const double perClass = (longestFirst ? -1 : 1) / (kQueueClass * edge_);
    for (const Edge& e : allEdges()) {
      const double length = (mesh_.at(e[0]) - mesh_.at(e[1])).norm();
      if (wanted(length)) found.emplace_back(static_cast<int>(length * perClass), e);
    }
    std::stable_sort(found.begin(), found.end(),
                     [](const auto& a, const auto& b) { return a.first < b.first; });
    std::vector<Edge> sorted;
    sorted.reserve(found.size());
    for (const auto& [length, e] : found) sorted.push_back(e);
    return sorted;
  }

  [[nodiscard]] std::vector<Edge> allEdges() const {
    std::vector<Edge> found;
    found.reserve(3 * mesh_.faceCount() / 2);
    for (std::int32_t f = 0; f < mesh_.faceSlots(); ++f) {
      if (!mesh_.hasFace(f)) continue;
      for (int k = 0; k < 3; ++k) {
        const std::int32_t a = mesh_.face(f)[k], b = mesh_.face(f)[(k + 1) % 3];
        if (a < b) found.push_back({a, b});
      }
    }
    return found;
  }

  [[nodiscard]] bool stillShort(const Edge& e, double limit) const {
    return mesh_.hasVertex(e[0]) && mesh_.hasVertex(e[1]) && mesh_.areJoined(e[0], e[1]) &&
           (mesh_.at(e[0]) - mesh_.at(e[1])).norm() < limit;
  }

  void collapse(const Edge& e, const GuardedMesh::CollapseLimits& limits,
                GuardedMesh::Scratch& scratch) {
    const Point middle = 0.5 * (mesh_.at(e[0]) + mesh_.at(e[1]));
    if (mesh_.collapse(e[0], e[1], onLevel(e[1], middle), limits, scratch)) return;
    if (mesh_.collapse(e[0], e[1], mesh_.at(e[1]), limits, scratch)) return;
    mesh_.collapse(e[1], e[0], mesh_.at(e[0]), limits, scratch);
  }

  [[nodiscard]] bool wantsFlip(std::int32_t a, std::int32_t b) const {
    const std::int32_t c = mesh_.opposite(a, b), d = mesh_.opposite(b, a);
    if (c < 0 || d < 0) return false;
    const auto excess = [&](std::int32_t v, int change) {
      const int e = static_cast<int>(mesh_.valence(v)) + change - (mesh_.onRim(v) ? 3 : 6);
      return e * e;
    };
    const int before = excess(a, 0) + excess(b, 0) + excess(c, 0) + excess(d, 0);
    const int after = excess(a, -1) + excess(b, -1) + excess(c, 1) + excess(d, 1);
    if (after >= before) return false;
    // Flat enough before and after, so that the shape stays.
    const Point &pa = mesh_.at(a), &pb = mesh_.at(b), &pc = mesh_.at(c), &pd = mesh_.at(d);
    const Vector n1 = (pb - pa).cross(pc - pa), n2 = (pd - pa).cross(pb - pa);
    const Vector m1 = (pd - pa).cross(pc - pa), m2 = (pb - pd).cross(pc - pd);
    constexpr double kFlat = 0.7;
    const auto flat = [](const Vector& x, const Vector& y) {
      return x.dot(y) > kFlat * x.norm() * y.norm();
    };
    return flat(m1, m2) && flat(n1 + n2, m1) && flat(n1 + n2, m2);
  }

  /// Area-weighted mean of the ring's centroids, moved in the tangent plane only.
  [[nodiscard]] Point centred(std::int32_t v) const {
    if (mesh_.onRim(v)) return mesh_.alongRim(v);
    const GuardedMesh::Ring ring = mesh_.ringOf(v);
    const Vector step = ring.centre - mesh_.at(v);
    if (ring.normal.isZero(0)) return mesh_.at(v) + 0.5 * step;
    return mesh_.at(v) + step - ring.normal * ring.normal.dot(step);
  }

  /// Nearest zero of the level set along the gradient, if it is near and the surface's side of it
  /// is right; the point itself otherwise.
  [[nodiscard]] Point onLevel(std::int32_t v, const Point& from) const {
    Vector normal = Vector::Zero();
    for (const std::int32_t f : mesh_.facesOf(v)) normal += mesh_.normalOf(f);
    return ontoLevel(level_, from, normal, 0.5 * std::min(edge_, voxel_ * 2));
  }

  GuardedMesh mesh_;
  const LevelSet& level_;
  double edge_;
  double voxel_;
  std::int64_t stored_;  ///< faces when it was stored last
};

/// What was asked for, to the next even number, but no more than the volume can tell.
std::int64_t facesWanted(const RemeshOptions& options, double area, double voxel,
                         const Monitor& monitor) {
  const std::int64_t asked = options.faces + options.faces % 2;
  const double edge = kFinest * voxel;
  const double most = 4 / std::sqrt(3.0) * area / (edge * edge);
  if (static_cast<double>(asked) <= most) return asked;
  const std::int64_t bound = std::max(kFewestFaces, 2 * static_cast<std::int64_t>(most / 2));
  if (asked <= bound) return asked;
  monitor.warn(std::to_string(options.faces) + " faces asked, " + std::to_string(bound) +
               " made: with more their edges would be shorter than a fifth of a voxel, of which "
               "the volume can tell nothing");
  return bound;
}

}  // namespace

double edgeFor(double area, std::int64_t faces) {
  return std::sqrt(4 / std::sqrt(3.0) * area / static_cast<double>(faces));
}

RemeshResult remesh(const TriangleMesh& mesh, const LevelSet& level, const RemeshOptions& options,
                    const Monitor& monitor) {
  if (options.faces < kFewestFaces) {
    throw InvalidInput("faces: " + std::to_string(options.faces) + " asked; at least " +
                       std::to_string(kFewestFaces) + " are needed");
  }
  if (options.open) {
    geometry::requireManifold(mesh, "mesh");
  } else {
    geometry::requireClosedManifold(mesh, "mesh");
  }
  // An equilateral mesh of edge a has edges from 4/5 to 4/3 of it; their mean area is a little less
  // than that of the aim, which the rounds correct.
  const double area = geometry::totalArea(mesh);
  const std::int64_t wanted = facesWanted(options, area, voxelSize(level.grid), monitor);
  Remesher remesher(mesh, level, edgeFor(area, wanted));
  for (int round = 0; round < options.rounds; ++round) {
    checkpoint(monitor);
    monitor.progress(static_cast<double>(round) / options.rounds, "remeshing");
    remesher.splitLong();
    if (round == 0) {
      remesher.flipForValence();
      remesher.tidy();
    }
    remesher.collapseShort(kShort);
    remesher.flipForValence();
    remesher.smooth();
    const double ratio = static_cast<double>(remesher.mesh().faceCount()) / wanted;
    remesher.setEdge(remesher.edge() * std::clamp(std::sqrt(ratio), 0.7, 1.4));
  }
  remesher.meetCount(wanted);
  remesher.tidy();
  for (int pass = 0; pass < 3; ++pass) {
    remesher.flipForValence();
    remesher.smooth();
  }
  monitor.progress(1.0, "remeshed");
  return {remesher.mesh().toMesh(), remesher.edge()};
}

}  // namespace explica::surface
