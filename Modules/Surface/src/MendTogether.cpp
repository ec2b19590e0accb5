// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "MendTogether.h"

#include "Explica/Core/Parallel.h"
#include "GuardedMesh.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <memory>
#include <utility>
#include <vector>

namespace explica::surface {
namespace {

using Edge = GuardedMesh::Edge;

constexpr int kRounds = 6;  // of joining and splitting: one may allow another
/// What is left where edges are joined: flat faces, but no needles, and no edges that are long.
constexpr double kFlatQuality = 0.1;
/// Where others are joined to keep the count.
constexpr double kFairQuality = 0.3;
/// Longest edge that joining may make, of the longest that is allowed.
constexpr double kShareOfLongest = 0.5;

/// Surfaces with the same faces, changed in step.
class JointMesh {
 public:
  JointMesh(const std::array<TriangleMesh*, 3>& surfaces, const Eigen::MatrixXd& values,
            const MendingLimits& limits, double cell)
      : limits_(limits), columns_(values.cols()), values_(values.rows()) {
    for (std::size_t v = 0; v < values_.size(); ++v) values_[v] = values.row(v);
    std::array<std::unique_ptr<GuardedMesh>, 3> made;
    parallelFor(made.size(), 1, [&](std::size_t n) {
      made[n] = std::make_unique<GuardedMesh>(*surfaces[n], cell);
    });
    for (const auto& mesh : made) meshes_.push_back(std::move(*mesh));
  }

  [[nodiscard]] const GuardedMesh& first() const { return meshes_.front(); }
  [[nodiscard]] const std::vector<GuardedMesh>& meshes() const { return meshes_; }
  [[nodiscard]] const Mending& done() const { return done_; }

  /// The smallest area that a face has in any surface, mm^2.
  [[nodiscard]] double areaOf(std::int32_t f) const {
    double least = kInfinity;
    for (const GuardedMesh& mesh : meshes_) least = std::min(least, mesh.normalOf(f).norm() / 2);
    return least;
  }

  /// The greatest length that an edge has in any surface, mm.
  [[nodiscard]] double lengthOf(const Edge& e) const {
    double longest = 0;
    for (const GuardedMesh& mesh : meshes_) {
      longest = std::max(longest, (mesh.at(e[0]) - mesh.at(e[1])).norm());
    }
    return longest;
  }

  /// Joins the ends of an edge in all surfaces, at one of its ends or in the middle.
  bool join(const Edge& e, double leastQuality) {
    for (const double share : {0.5, 0.0, 1.0}) {
      if (joinAt(e, share, leastQuality)) return true;
    }
    return false;
  }

  /// Splits an edge in all surfaces.
  bool split(const Edge& e) {
    if (!hasEdge(e) || !mayBeHalved(e)) return false;
    for (GuardedMesh& mesh : meshes_) {
      if (!mesh.maySplit(e[0], e[1])) return false;
    }
    std::int32_t put = -1;
    for (GuardedMesh& mesh : meshes_) put = mesh.split(e[0], e[1]);
    if (put >= static_cast<std::int32_t>(values_.size())) values_.resize(put + 1);
    values_[put] = between(values_[e[0]], values_[e[1]], 0.5);
    ++done_.inserted;
    return true;
  }

  /// Values at the vertices there are, in the order of toMesh().
  [[nodiscard]] Eigen::MatrixXd values() const {
    Eigen::MatrixXd kept(static_cast<Eigen::Index>(values_.size()), columns_);
    Eigen::Index count = 0;
    for (std::int32_t v = 0; v < first().vertexSlots(); ++v) {
      if (first().hasVertex(v)) kept.row(count++) = values_[v];
    }
    return kept.topRows(count);
  }

 private:
  [[nodiscard]] bool hasEdge(const Edge& e) const {
    return first().hasVertex(e[0]) && first().hasVertex(e[1]) && first().areJoined(e[0], e[1]);
  }

  /// True if half of each face at an edge is large enough in every surface.
  [[nodiscard]] bool mayBeHalved(const Edge& e) const {
    for (const std::int32_t f : first().facesOf(e[0])) {
      const auto& c = first().face(f);
      if (std::find(c.begin(), c.end(), e[1]) == c.end()) continue;
      if (areaOf(f) < 2 * limits_.leastArea) return false;
    }
    return true;
  }

  bool joinAt(const Edge& e, double share, double leastQuality) {
    if (!hasEdge(e)) return false;
    GuardedMesh::CollapseLimits limits;
    limits.longestEdge = kShareOfLongest * limits_.longestEdge;
    limits.leastCosine = 0;
    limits.leastQuality = leastQuality;
    limits.leastArea = limits_.leastArea;
    const auto [gone, stays] = e;
    const auto place = [&, gone = gone, stays = stays](const GuardedMesh& mesh) -> Point {
      return share * mesh.at(gone) + (1 - share) * mesh.at(stays);
    };
    for (GuardedMesh& mesh : meshes_) {
      if (!mesh.mayCollapse(gone, stays, place(mesh), limits)) return false;
    }
    for (GuardedMesh& mesh : meshes_) mesh.collapse(gone, stays, place(mesh), limits);
    values_[stays] = between(values_[gone], values_[stays], share);
    ++done_.removed;
    return true;
  }

  /// What is not known at one of the ends is not known between them.
  [[nodiscard]] static Eigen::RowVectorXd between(const Eigen::RowVectorXd& a,
                                                  const Eigen::RowVectorXd& b, double share) {
    return (a.array() == 0 || b.array() == 0).select(0.0, share * a + (1 - share) * b);
  }

  MendingLimits limits_;
  Eigen::Index columns_;
  std::vector<GuardedMesh> meshes_;
  std::vector<Eigen::RowVectorXd> values_;  ///< per slot
  Mending done_;
};

/// What look(f, found) adds to a list, of all faces there are, in order.
template <class T, class Look>
std::vector<T> sortedOfFaces(const JointMesh& mesh, const Look& look) {
  struct List {
    std::vector<T> values;
    void operator+=(const List& other) {
      values.insert(values.end(), other.values.begin(), other.values.end());
    }
  };
  const auto slots = static_cast<std::size_t>(mesh.first().faceSlots());
  List all = parallelSum(slots, 4096, List{}, [&](std::size_t begin, std::size_t end) {
    List part;
    for (std::size_t n = begin; n < end; ++n) {
      const auto f = static_cast<std::int32_t>(n);
      if (mesh.first().hasFace(f)) look(f, part.values);
    }
    return part;
  });
  std::sort(all.values.begin(), all.values.end());
  return std::move(all.values);
}

/// Edges of faces whose area fulfils a condition, those of the smallest face first, each face's
/// shortest edge first.
std::vector<Edge> edgesOfSmallest(const JointMesh& mesh, double below) {
  using Small = std::pair<double, std::int32_t>;
  const auto faces = sortedOfFaces<Small>(mesh, [&](std::int32_t f, std::vector<Small>& found) {
    const double area = mesh.areaOf(f);
    if (area < below) found.emplace_back(area, f);
  });
  std::vector<Edge> edges;
  for (const auto& [area, f] : faces) {
    const auto& c = mesh.first().face(f);
    std::array<Edge, 3> own = {Edge{c[0], c[1]}, Edge{c[1], c[2]}, Edge{c[2], c[0]}};
    std::stable_sort(own.begin(), own.end(), [&](const Edge& a, const Edge& b) {
      return mesh.lengthOf(a) < mesh.lengthOf(b);
    });
    edges.insert(edges.end(), own.begin(), own.end());
  }
  return edges;
}

/// Edges longer than a length in any of the surfaces, the longest first.
std::vector<Edge> edgesLongerThan(const JointMesh& mesh, double length) {
  using Long = std::pair<double, Edge>;
  const auto found = sortedOfFaces<Long>(mesh, [&](std::int32_t f, std::vector<Long>& mine) {
    const auto& c = mesh.first().face(f);
    for (int k = 0; k < 3; ++k) {
      const Edge e = {c[k], c[(k + 1) % 3]};
      const double own = mesh.lengthOf(e);
      if (own <= length || (e[0] > e[1] && mesh.first().opposite(e[1], e[0]) >= 0)) continue;
      mine.emplace_back(-own, e);
    }
  });
  std::vector<Edge> edges;
  for (const auto& [negative, e] : found) edges.push_back(e);
  return edges;
}

/// True if some face or edge of a surface is beyond the limits.
bool isBeyond(const TriangleMesh& mesh, const MendingLimits& limits) {
  const auto isFaceBeyond = [&](Eigen::Index f) {
    const Point a = mesh.corner(f, 0), b = mesh.corner(f, 1), c = mesh.corner(f, 2);
    if ((b - a).cross(c - a).norm() < 2 * limits.leastArea) return true;
    const double squared =
        std::max({(a - b).squaredNorm(), (b - c).squaredNorm(), (c - a).squaredNorm()});
    return squared > limits.longestEdge * limits.longestEdge;
  };
  for (Eigen::Index f = 0; f < mesh.faceCount(); ++f) {
    if (isFaceBeyond(f)) return true;
  }
  return false;
}

/// Splits the longest edges, or joins the smallest faces, until the count is that of the start.
void meetCount(JointMesh& mesh, const MendingLimits& limits) {
  const auto missing = [&] { return mesh.done().removed - mesh.done().inserted; };
  constexpr double kShrink = 0.8;  // of the length, or of the area's inverse, from try to try
  for (double share = kShrink; missing() != 0 && share > 0.3; share *= kShrink) {
    if (missing() > 0) {
      for (const Edge& e : edgesLongerThan(mesh, share * limits.longestEdge)) {
        if (missing() <= 0) break;
        mesh.split(e);
      }
    } else {
      for (const Edge& e : edgesOfSmallest(mesh, limits.leastArea / (share * share * share))) {
        if (missing() >= 0) break;
        mesh.join(e, kFairQuality);
      }
    }
  }
}

}  // namespace

Mending mendTogether(const std::array<TriangleMesh*, 3>& surfaces, Eigen::MatrixXd& values,
                     const MendingLimits& limits, double cell) {
  if (std::none_of(surfaces.begin(), surfaces.end(),
                   [&](const TriangleMesh* mesh) { return isBeyond(*mesh, limits); })) {
    return {};
  }
  JointMesh mesh(surfaces, values, limits, cell);
  for (int round = 0; round < kRounds; ++round) {
    const std::int64_t before = mesh.done().removed + mesh.done().inserted;
    for (const Edge& e : edgesOfSmallest(mesh, limits.leastArea)) mesh.join(e, kFlatQuality);
    for (const Edge& e : edgesLongerThan(mesh, limits.longestEdge)) mesh.split(e);
    if (mesh.done().removed + mesh.done().inserted == before) break;
  }
  meetCount(mesh, limits);
  for (std::size_t n = 0; n < surfaces.size(); ++n) *surfaces[n] = mesh.meshes()[n].toMesh();
  values = mesh.values();
  return mesh.done();
}

}  // namespace explica::surface
