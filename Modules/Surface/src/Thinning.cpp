// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Thinning.h"

#include "Explica/Core/Parallel.h"
#include "Explica/Geometry/MeshTopology.h"
#include "Explica/Geometry/SelfIntersection.h"
#include "GuardedMesh.h"
#include "MoveTogether.h"
#include "OntoLevel.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <optional>
#include <utility>
#include <vector>

namespace explica::surface {
namespace {

using Corners = GuardedMesh::Corners;
using Edge = GuardedMesh::Edge;

/// Edges shorter than these shares of the aim are collapsed, one share after the other.
constexpr std::array<double, 2> kEdgeShares = {0.4, 0.6};
/// Edges are taken by length in classes of this share of the aim, each in the order of memory.
constexpr double kLengthClass = 0.05;
/// Cosine of the greatest turn of a face, and least quality of a new one.
constexpr double kLeastCosine = 0.3, kLeastQuality = 0.15;
/// Faces at an edge's two ends at most.
constexpr std::size_t kMostAround = 40;
/// Vertices of a region of memory.
constexpr std::int32_t kRegion = 1 << 14;

/// Vertices joined to others, without a look at faces that are not theirs.
class Thinner {
 public:
  Thinner(const TriangleMesh& mesh, const LevelSet& level, double edge)
      : mesh_(mesh),
        level_(level),
        edge_(edge),
        positions_(mesh.vertexCount()),
        rings_(mesh.vertexCount()),
        joined_(mesh.vertexCount()),
        faces_(mesh.faceCount()) {
    most_ = 0.5 * std::min(edge, 2 * voxelSize(level.grid));
    std::iota(joined_.begin(), joined_.end(), 0);
    parallelFor(positions_.size(), 4096, [&](std::size_t v) {
      positions_[v] = mesh.positions.row(static_cast<Eigen::Index>(v));
    });
    for (Eigen::Index f = 0; f < mesh.faceCount(); ++f) {
      faces_[f] = {mesh.faces(f, 0), mesh.faces(f, 1), mesh.faces(f, 2)};
      for (const std::int32_t v : faces_[f]) rings_[v].add(static_cast<std::int32_t>(f));
    }
    onRim_.resize(positions_.size());
    parallelFor(onRim_.size(), 4096,
                [&](std::size_t v) { onRim_[v] = endsAt(static_cast<std::int32_t>(v)); });
  }

  void run() {
    // Regions shifted by half come to the edges that run from one into the next.
    for (const std::int32_t shift : {0, kRegion / 2}) {
      const std::int32_t count =
          (static_cast<std::int32_t>(positions_.size()) + shift) / kRegion + 1;
      parallelFor(count, 1, [&](std::size_t n) {
        const auto region = static_cast<std::int32_t>(n);
        const Range range = {region * kRegion - shift, (region + 1) * kRegion - shift};
        for (const double share : kEdgeShares) collapseShort(range, share * edge_);
      });
    }
  }

  /// For each vertex the one that it was joined to, in the end; itself if none.
  [[nodiscard]] std::vector<std::int32_t> joined() const {
    std::vector<std::int32_t> root(joined_.size());
    parallelFor(root.size(), 4096, [&](std::size_t v) {
      std::int32_t r = joined_[v];
      while (joined_[r] != r) r = joined_[r];
      root[v] = r;
    });
    return root;
  }
  [[nodiscard]] const std::vector<Point>& positions() const { return positions_; }

 private:
  /// Vertices from the first one to before the second one.
  using Range = std::array<std::int32_t, 2>;

  /// The corners after and before v in a face.
  [[nodiscard]] std::array<std::int32_t, 2> nextTo(std::int32_t v, std::int32_t f) const {
    const Corners& c = faces_[f];
    const int k = c[0] == v ? 0 : (c[1] == v ? 1 : 2);
    return {c[(k + 1) % 3], c[(k + 2) % 3]};
  }
  /// True if the faces at v do not close: some neighbour then is in one of them only.
  [[nodiscard]] bool endsAt(std::int32_t v) const {
    std::int32_t odd = 0;
    for (const std::int32_t f : rings_[v]) {
      const auto [next, before] = nextTo(v, f);
      odd ^= next ^ before;
    }
    return odd != 0;
  }

  void collapseShort(const Range& range, double limit) {
    std::vector<std::pair<int, Edge>> edges;
    const double perClass = 1 / (kLengthClass * edge_);
    const std::int32_t last = std::min(range[1], static_cast<std::int32_t>(positions_.size()));
    for (std::int32_t a = std::max(range[0], 0); a < last; ++a) {
      if (onRim_[a]) continue;
      for (const std::int32_t f : rings_[a]) {
        const std::int32_t b = nextTo(a, f)[0];
        if (b < a || b >= last || onRim_[b]) continue;
        const double length = (positions_[a] - positions_[b]).norm();
        if (length < limit) edges.push_back({static_cast<int>(length * perClass), {a, b}});
      }
    }
    std::stable_sort(edges.begin(), edges.end(),
                     [](const auto& a, const auto& b) { return a.first < b.first; });
    for (const auto& [length, e] : edges) {
      if (joined_[e[0]] != e[0] || joined_[e[1]] != e[1]) continue;
      if ((positions_[e[0]] - positions_[e[1]]).squaredNorm() >= limit * limit) continue;
      collapse(e[0], e[1], range);
    }
  }

  /// The faces at an edge's ends.
  struct Star {
    std::array<std::int32_t, kMostAround> faces;  ///< with one end among their corners
    std::size_t count = 0;
    std::array<std::int32_t, 2> gone = {-1, -1};  ///< the edge's own
  };

  /// Nothing if the topology would change or a neighbour lies beyond the range.
  [[nodiscard]] std::optional<Star> starOf(std::int32_t u, std::int32_t v,
                                           const Range& range) const {
    if (rings_[u].size() + rings_[v].size() > kMostAround) return {};
    if (rings_[u].size() + rings_[v].size() < 8) return {};
    Star star;
    std::size_t gone = 0;
    std::array<std::int32_t, kMostAround> around;
    std::size_t aroundCount = 0;
    for (const std::int32_t f : rings_[u]) {
      const auto [next, before] = nextTo(u, f);
      if (next < range[0] || next >= range[1]) return {};
      around[aroundCount++] = next;
      if (next != v && before != v) {
        star.faces[star.count++] = f;
      } else {
        if (gone == 2) return {};
        star.gone[gone++] = f;
      }
    }
    int common = 0;
    for (const std::int32_t f : rings_[v]) {
      const auto [next, before] = nextTo(v, f);
      if (next < range[0] || next >= range[1]) return {};
      common += next != u && std::find(around.begin(), around.begin() + aroundCount, next) !=
                                 around.begin() + aroundCount;
      if (next != u && before != u) star.faces[star.count++] = f;
    }
    // Link condition: the ends have exactly the corners that face the edge in common.
    if (gone != 2 || common != 2) return {};
    return star;
  }

  /// True if the faces that are left are well shaped with both ends at `to`.
  [[nodiscard]] bool staysShaped(const Star& star, std::int32_t u, std::int32_t v,
                                 const Point& to) const {
    const double longest = kLong * kLong * edge_ * edge_;
    for (std::size_t n = 0; n < star.count; ++n) {
      const Corners& c = faces_[star.faces[n]];
      const int k = c[0] == u || c[0] == v ? 0 : (c[1] == u || c[1] == v ? 1 : 2);
      const Point &from = positions_[c[k]], &p = positions_[c[(k + 1) % 3]],
                  &q = positions_[c[(k + 2) % 3]];
      const Vector side = q - p, a = to - p, b = to - q;
      const double aa = a.squaredNorm(), bb = b.squaredNorm();
      if (aa > longest || bb > longest) return false;
      const Vector after = side.cross(a), before = side.cross(from - p);
      const double doubleArea = after.norm();
      if (2 * std::sqrt(3.0) * doubleArea < kLeastQuality * (aa + bb + side.squaredNorm())) {
        return false;
      }
      if (before.dot(after) < kLeastCosine * before.norm() * doubleArea) return false;
    }
    return true;
  }

  void collapse(std::int32_t u, std::int32_t v, const Range& range) {
    const std::optional<Star> star = starOf(u, v, range);
    if (!star) return;
    Vector normal = Vector::Zero();
    for (const std::int32_t f : rings_[v]) {
      const Corners& c = faces_[f];
      normal += (positions_[c[1]] - positions_[c[0]]).cross(positions_[c[2]] - positions_[c[0]]);
    }
    const Point middle = 0.5 * (positions_[u] + positions_[v]);
    const Point onto = asStored(ontoLevel(level_, middle, normal, most_));
    const Point atU = positions_[u], atV = positions_[v];
    for (const Point& to : {onto, atV, atU}) {
      if (!staysShaped(*star, u, v, to)) continue;
      join(*star, u, v, to);
      return;
    }
  }

  void join(const Star& star, std::int32_t u, std::int32_t v, const Point& to) {
    for (const std::int32_t f : star.gone) {
      for (const std::int32_t w : faces_[f]) {
        if (w != u) rings_[w].remove(f);
      }
    }
    for (const std::int32_t f : rings_[u]) {
      if (f == star.gone[0] || f == star.gone[1]) continue;
      for (std::int32_t& w : faces_[f]) {
        if (w == u) w = v;
      }
      rings_[v].add(f);
    }
    joined_[u] = v;
    positions_[v] = to;
  }

  const TriangleMesh& mesh_;
  const LevelSet& level_;
  double edge_;
  double most_;  ///< way to the level, mm
  std::vector<Point> positions_;
  std::vector<FaceRing> rings_;
  std::vector<std::int32_t> joined_;
  std::vector<Corners> faces_;
  std::vector<std::uint8_t> onRim_;
};

/// A mesh some of whose vertices are joined, and may part again.
class Joined {
 public:
  Joined(const TriangleMesh& mesh, const Thinner& thinner)
      : mesh_(mesh), root_(thinner.joined()), positions_(mesh.positions) {
    for (std::size_t v = 0; v < root_.size(); ++v) {
      if (root_[v] == static_cast<std::int32_t>(v)) {
        positions_.row(static_cast<Eigen::Index>(v)) = thinner.positions()[v];
      }
    }
    takeFaces();
  }

  /// On all vertices of the mesh, also those that are joined to others.
  [[nodiscard]] TriangleMesh mesh() const { return {positions_, faces_}; }

  /// Parts what is joined to the marked vertices; marks what has parted, and nothing else.
  /// @return false if nothing was joined to them
  bool part(std::vector<std::uint8_t>& marked) {
    bool any = false;
    const std::vector<std::uint8_t> asked =
        std::exchange(marked, std::vector<std::uint8_t>(marked.size(), 0));
    for (std::size_t v = 0; v < root_.size(); ++v) {
      const std::int32_t root = root_[v];
      if (root == static_cast<std::int32_t>(v) || !asked[root]) continue;
      any = true;
      marked[v] = marked[root] = 1;
      root_[v] = static_cast<std::int32_t>(v);
      positions_.row(root) = mesh_.positions.row(root);
    }
    if (any) takeFaces();
    return any;
  }

 private:
  void takeFaces() {
    Eigen::Index count = 0;
    faces_.resize(mesh_.faceCount(), 3);
    for (Eigen::Index f = 0; f < mesh_.faceCount(); ++f) {
      const std::int32_t a = root_[mesh_.faces(f, 0)], b = root_[mesh_.faces(f, 1)],
                         c = root_[mesh_.faces(f, 2)];
      if (a != b && b != c && c != a) faces_.row(count++) << a, b, c;
    }
    faces_.conservativeResize(count, 3);
  }

  const TriangleMesh& mesh_;
  std::vector<std::int32_t> root_;
  Positions positions_;
  Faces faces_;
};

/// The corners after and before a vertex in one of its faces.
using Sides = std::array<std::int32_t, 2>;

/// True if the faces at a vertex follow each other around it, once round or from rim to rim.
bool isFan(const std::vector<Sides>& sides) {
  std::size_t count = 1;
  for (const int way : {0, 1}) {
    std::size_t at = 0;
    for (;;) {
      const auto found = std::find_if(sides.begin(), sides.end(),
                                      [&](const Sides& s) { return s[1 - way] == sides[at][way]; });
      if (found == sides.end()) break;  // a rim: the other way round
      at = found - sides.begin();
      if (at == 0 || ++count > sides.size()) return at == 0 && count == sides.size();
    }
  }
  return count == sides.size();
}

/// Marks vertices whose faces form anything but one fan, and their neighbours.
void markBranched(const Faces& faces, std::vector<std::uint8_t>& marked) {
  std::vector<std::vector<Sides>> sides(marked.size());
  for (Eigen::Index f = 0; f < faces.rows(); ++f) {
    for (int k = 0; k < 3; ++k) {
      sides[faces(f, k)].push_back({faces(f, (k + 1) % 3), faces(f, (k + 2) % 3)});
    }
  }
  std::vector<std::uint8_t> branched(marked.size(), 0);
  parallelFor(sides.size(), 2048,
              [&](std::size_t v) { branched[v] = !sides[v].empty() && !isFan(sides[v]); });
  for (Eigen::Index f = 0; f < faces.rows(); ++f) {
    if (!branched[faces(f, 0)] && !branched[faces(f, 1)] && !branched[faces(f, 2)]) continue;
    for (int k = 0; k < 3; ++k) marked[faces(f, k)] = 1;
  }
}

/// V - E + F with E = 3 F / 2, twice: of meshes with the same rims it differs as their topology.
std::int64_t characteristicOf(const TriangleMesh& mesh) {
  return 2 * mesh.vertexCount() - mesh.faceCount();
}

}  // namespace

TriangleMesh thinned(const TriangleMesh& given, const LevelSet& level, double edge) {
  TriangleMesh mesh = given;
  parallelFor(static_cast<std::size_t>(mesh.vertexCount()), 4096, [&](std::size_t v) {
    const auto row = static_cast<Eigen::Index>(v);
    mesh.positions.row(row) = asStored(given.positions.row(row));
  });
  Thinner thinner(mesh, level, edge);
  thinner.run();
  Joined joined(mesh, thinner);
  TriangleMesh found = joined.mesh();
  std::vector<geometry::FacePair> pairs = geometry::findSelfIntersections(found);
  std::vector<std::uint8_t> marked(static_cast<std::size_t>(mesh.vertexCount()), 0);
  for (;;) {
    for (const geometry::FacePair& pair : pairs) {
      for (const std::int32_t f : pair) {
        for (int k = 0; k < 3; ++k) marked[found.faces(f, k)] = 1;
      }
    }
    if (!joined.part(marked)) break;
    found = joined.mesh();
    std::vector<bool> changed(static_cast<std::size_t>(found.faceCount()));
    for (std::size_t f = 0; f < changed.size(); ++f) {
      const auto row = static_cast<Eigen::Index>(f);
      changed[f] =
          marked[found.faces(row, 0)] || marked[found.faces(row, 1)] || marked[found.faces(row, 2)];
    }
    pairs = geometry::findSelfIntersections(found, changed);
    std::fill(marked.begin(), marked.end(), std::uint8_t{0});
    markBranched(found.faces, marked);
  }
  found = geometry::extractFaces(found, found.allFaces()).mesh;
  // Parting could in principle leave another topology: then the way of care is the only one.
  return pairs.empty() && characteristicOf(found) == characteristicOf(given) ? found : mesh;
}

}  // namespace explica::surface
