// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Collision/Repair.h"

#include "Explica/Core/DisjointSets.h"
#include "Explica/Core/Errors.h"
#include "Explica/Geometry/FaceTree.h"
#include "Explica/Geometry/Fixtures.h"
#include "Explica/Geometry/MeshMeasures.h"
#include "Explica/Geometry/MeshTopology.h"

#include <algorithm>
#include <map>
#include <set>
#include <string>
#include <utility>

namespace explica::collision {
namespace {

using geometry::FacePair;

/// Groups of moved vertices that are joined by edges: what was moved together.
class MovedGroups {
 public:
  MovedGroups(const geometry::MeshTopology& topology, const Positions& before,
              const Positions& after)
      : groupOf_(static_cast<std::size_t>(before.rows()), -1) {
    const auto moved = [&](std::int32_t v) { return before.row(v) != after.row(v); };
    DisjointSets sets(groupOf_.size());
    for (std::int32_t v = 0; v < before.rows(); ++v) {
      if (!moved(v)) continue;
      for (const std::int32_t n : topology.vertexVertices[v]) {
        if (moved(n)) sets.join(v, n);
      }
    }
    for (std::int32_t v = 0; v < before.rows(); ++v) {
      if (!moved(v)) continue;
      if (sets.root(v) == v) members_.emplace_back();
      groupOf_[v] = sets.root(v) == v ? static_cast<std::int32_t>(members_.size()) - 1
                                      : groupOf_[sets.root(v)];
      members_[groupOf_[v]].push_back(v);
    }
  }

  [[nodiscard]] std::size_t count() const { return members_.size(); }
  [[nodiscard]] const std::vector<std::int32_t>& members(std::size_t group) const {
    return members_[group];
  }
  /// Groups of a face's corners.
  void addOf(const Faces& faces, std::int32_t face, std::set<std::size_t>& groups) const {
    for (int k = 0; k < 3; ++k) {
      const std::int32_t group = groupOf_[faces(face, k)];
      if (group >= 0) groups.insert(static_cast<std::size_t>(group));
    }
  }
  void forget(std::size_t group) {
    for (const std::int32_t v : members_[group]) groupOf_[v] = -1;
    members_[group].clear();
  }
  [[nodiscard]] bool holds(std::int32_t vertex) const { return groupOf_[vertex] >= 0; }

 private:
  std::vector<std::int32_t> groupOf_;  ///< per vertex; -1: did not move
  std::vector<std::vector<std::int32_t>> members_;
};

/// One surface on its way.
struct Piece {
  const TriangleMesh* input = nullptr;
  TriangleMesh now;
  MovedGroups groups;
  std::size_t far = 0, other = 0;

  void putBack(std::size_t group) {
    for (const std::int32_t v : groups.members(group)) {
      now.positions.row(v) = input->positions.row(v);
    }
    groups.forget(group);
  }
};

std::vector<std::int32_t> movedFaces(const Piece& piece) {
  std::vector<std::int32_t> faces;
  for (std::int32_t f = 0; f < piece.now.faceCount(); ++f) {
    for (int k = 0; k < 3; ++k) {
      if (!piece.groups.holds(piece.now.faces(f, k))) continue;
      faces.push_back(f);
      break;
    }
  }
  return faces;
}

/// Pairs of a moved face of `a` and a face of `b` that meet, for given positions of both.
std::vector<FacePair> meetings(const TriangleMesh& a, const std::vector<std::int32_t>& moved,
                               const TriangleMesh& b) {
  if (moved.empty()) return {};
  const geometry::SubMesh partA = geometry::extractFaces(a, moved);
  const geometry::BoxTree tree(geometry::faceBoxes(partA.mesh));
  const std::vector<geometry::Box> boxes = geometry::faceBoxes(b);
  std::vector<std::int32_t> near;
  for (std::int32_t f = 0; f < b.faceCount(); ++f) {
    bool meets = false;
    tree.forOverlaps(boxes[f], [&meets](std::int32_t) { meets = true; });
    if (meets) near.push_back(f);
  }
  if (near.empty()) return {};
  const geometry::SubMesh partB = geometry::extractFaces(b, near);
  const auto border = static_cast<std::int32_t>(partA.mesh.faceCount());
  std::vector<FacePair> pairs;
  for (const FacePair& pair :
       geometry::findSelfIntersections(geometry::joined(partA.mesh, partB.mesh))) {
    if (pair[0] >= border || pair[1] < border) continue;  // of one surface
    pairs.push_back({partA.faceOrigin[pair[0]], partB.faceOrigin[pair[1] - border]});
  }
  return pairs;
}

/// Meetings of each group of `a` that has any, with `b`.
std::map<std::size_t, std::size_t> meetingsByGroup(const Piece& a, const TriangleMesh& positionsOfA,
                                                   const std::vector<std::int32_t>& moved,
                                                   const TriangleMesh& b) {
  std::map<std::size_t, std::size_t> count;
  for (const FacePair& pair : meetings(positionsOfA, moved, b)) {
    std::set<std::size_t> groups;
    a.groups.addOf(a.now.faces, pair[0], groups);
    for (const std::size_t group : groups) ++count[group];
  }
  return count;
}

/// Tells on which side of a closed surface a point lies, by the parity of a ray's crossings.
class Inside {
 public:
  explicit Inside(const TriangleMesh& mesh) : mesh_(mesh), tree_(geometry::faceBoxes(mesh)) {}

  [[nodiscard]] bool operator()(const Point& x) const {
    geometry::Box ray(x, Point(kInfinity, x[1], x[2]));
    int crossings = 0;
    tree_.forOverlaps(ray, [&](std::int32_t face) { crossings += crosses(x, face); });
    return crossings % 2 != 0;
  }

 private:
  /// True if the ray from x along +x crosses the face.  Borders are given to one side, so that a
  /// ray through an edge counts once.
  [[nodiscard]] bool crosses(const Point& x, std::int32_t face) const {
    bool inside = false;
    Point corner[3];
    for (int k = 0; k < 3; ++k) corner[k] = mesh_.corner(face, k) - x;
    for (int k = 0; k < 3; ++k) {
      const Point &a = corner[k], &b = corner[(k + 1) % 3];
      if ((a[2] > 0) == (b[2] > 0)) continue;
      inside ^= a[1] - a[2] * (b[1] - a[1]) / (b[2] - a[2]) > 0;
    }
    if (!inside) return false;
    const Vector normal = (corner[1] - corner[0]).cross(corner[2] - corner[0]);
    return normal[0] != 0 && corner[0].dot(normal) / normal[0] > 0;
  }

  const TriangleMesh& mesh_;
  geometry::BoxTree tree_;
};

/// Two surfaces of which one encloses more: whether its vertices are outside of the other one.
class Order {
 public:
  Order(const Piece& a, const Piece& b) : Order(a, b, volumeOf(a) < volumeOf(b)) {}

  /// How many of the outer surface's vertices lie inside the inner one, before and after.
  [[nodiscard]] std::size_t wrongBefore(const std::vector<std::int32_t>& vertices) const {
    return wrong(before_, outer_.input->positions, vertices);
  }
  [[nodiscard]] std::size_t wrongAfter(const std::vector<std::int32_t>& vertices) const {
    return wrong(after_, outer_.now.positions, vertices);
  }

 private:
  Order(const Piece& a, const Piece& b, bool aIsInner)
      : outer_(aIsInner ? b : a),
        before_(*(aIsInner ? a : b).input),
        after_((aIsInner ? a : b).now) {}

  static double volumeOf(const Piece& piece) { return geometry::enclosedVolume(*piece.input); }

  static std::size_t wrong(const Inside& inner, const Positions& positions,
                           const std::vector<std::int32_t>& vertices) {
    return static_cast<std::size_t>(std::ranges::count_if(
        vertices, [&](std::int32_t v) { return inner(positions.row(v).transpose()); }));
  }

  const Piece& outer_;
  Inside before_, after_;
};

/// Puts groups back whose faces meet another surface where they did not in the input, or at whose
/// vertices more of the outer surface's lie inside the inner one.
/// @return how many
std::size_t putBackMeetings(std::vector<Piece>& pieces) {
  std::size_t count = 0;
  for (Piece& a : pieces) {
    for (const Piece& b : pieces) {
      if (&a == &b) continue;
      const std::vector<std::int32_t> moved = movedFaces(a);
      const auto after = meetingsByGroup(a, a.now, moved, b.now);
      if (after.empty()) continue;
      const auto before = meetingsByGroup(a, *a.input, moved, *b.input);
      const Order order(a, b);
      for (const auto& [group, meetingCount] : after) {
        const auto& members = a.groups.members(group);
        if (before.contains(group) && order.wrongAfter(members) <= order.wrongBefore(members)) {
          continue;
        }
        a.putBack(group);
        ++a.other;
        ++count;
      }
    }
  }
  return count;
}

void putBackFar(Piece& piece, double maxMove) {
  for (std::size_t group = 0; group < piece.groups.count(); ++group) {
    const auto& members = piece.groups.members(group);
    const bool tooFar = std::ranges::any_of(members, [&](std::int32_t v) {
      return (piece.now.positions.row(v) - piece.input->positions.row(v)).norm() > maxMove;
    });
    if (!tooFar) continue;
    piece.putBack(group);
    ++piece.far;
  }
}

RepairedSurface accountOf(const Piece& piece, std::vector<FacePair> before,
                          std::vector<FacePair> after) {
  RepairedSurface result;
  result.before = std::move(before);
  const bool putBack = piece.far + piece.other > 0;
  result.after = putBack ? geometry::findSelfIntersections(piece.now) : std::move(after);
  result.putBackFar = piece.far;
  result.putBackOther = piece.other;
  result.positions = piece.now.positions;
  result.noteMoves(piece.input->positions);
  return result;
}

}  // namespace

std::vector<RepairedSurface> repairSurfaces(std::span<const TriangleMesh> surfaces,
                                            const RepairOptions& options, const Monitor& monitor) {
  if (surfaces.empty()) throw InvalidInput("surfaces: there are none");
  if (!(options.maxMove > 0)) throw InvalidInput("max-move: must be positive");
  for (const TriangleMesh& surface : surfaces) {
    const bool same = surface.vertexCount() == surfaces[0].vertexCount() &&
                      surface.faceCount() == surfaces[0].faceCount() &&
                      surface.faces == surfaces[0].faces;
    if (!same) {
      throw InvalidInput(
          "surfaces: their faces differ; several surfaces are repaired together if their vertices "
          "correspond");
    }
  }
  const auto topology = geometry::buildTopology(surfaces[0].faces, surfaces[0].vertexCount());
  std::vector<Piece> pieces;
  std::vector<Untangling> untangled;
  for (std::size_t n = 0; n < surfaces.size(); ++n) {
    const auto from = static_cast<double>(n), all = static_cast<double>(surfaces.size());
    untangled.push_back(untangle(surfaces[n], {}, monitor.part(from / all, (from + 1) / all)));
    TriangleMesh now{untangled.back().positions, surfaces[n].faces};
    MovedGroups groups(topology, surfaces[n].positions, now.positions);
    pieces.push_back({&surfaces[n], std::move(now), std::move(groups)});
    putBackFar(pieces.back(), options.maxMove);
  }
  while (putBackMeetings(pieces) > 0) {
  }
  std::vector<RepairedSurface> results;
  for (std::size_t n = 0; n < surfaces.size(); ++n) {
    results.push_back(
        accountOf(pieces[n], std::move(untangled[n].before), std::move(untangled[n].after)));
  }
  return results;
}

RepairCounts countsOf(const RepairedSurface& surface) {
  return {surface.before.size(), surface.after.size(),
          surface.moved.size(),  surface.putBackFar + surface.putBackOther,
          surface.moveMean,      surface.moveMax};
}

RepairSummary summaryOf(std::span<const RepairedSurface> surfaces,
                        std::span<const std::string> names) {
  RepairSummary summary;
  RepairCounts& all = summary.all;
  for (std::size_t n = 0; n < surfaces.size(); ++n) {
    const RepairCounts one = countsOf(surfaces[n]);
    summary.surfaces.push_back({names[n], one});
    all.before += one.before;
    all.after += one.after;
    all.moved += one.moved;
    all.putBack += one.putBack;
    all.moveMean += one.moveMean * static_cast<double>(one.moved);
    all.moveMax = std::max(all.moveMax, one.moveMax);
  }
  all.moveMean /= static_cast<double>(std::max<std::size_t>(all.moved, 1));
  return summary;
}

}  // namespace explica::collision
