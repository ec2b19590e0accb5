// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Geometry/MeshTopology.h"

#include "Explica/Core/Errors.h"
#include "Explica/Geometry/Predicates.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <string>

namespace explica::geometry {
namespace {

/// A face's side: its two vertices in ascending order, and which side of which face it is.
struct HalfEdge {
  std::int32_t low;
  std::int32_t high;
  std::int32_t face;
  std::int32_t side;
  bool operator<(const HalfEdge& other) const {
    if (low != other.low) return low < other.low;
    if (high != other.high) return high < other.high;
    return face < other.face;
  }
  [[nodiscard]] bool sameEdge(const HalfEdge& other) const {
    return low == other.low && high == other.high;
  }
};

std::vector<HalfEdge> sortedHalfEdges(const Faces& faces) {
  std::vector<HalfEdge> sides;
  sides.reserve(static_cast<std::size_t>(faces.rows()) * 3);
  for (std::int32_t f = 0; f < faces.rows(); ++f) {
    for (std::int32_t k = 0; k < 3; ++k) {
      const std::int32_t a = faces(f, k), b = faces(f, (k + 1) % 3);
      sides.push_back({std::min(a, b), std::max(a, b), f, k});
    }
  }
  std::sort(sides.begin(), sides.end());
  return sides;
}

/// Calls visit(begin, end) for each run of half edges on the same edge.
template <class Visit>
void forEachEdge(const std::vector<HalfEdge>& sides, const Visit& visit) {
  for (std::size_t begin = 0; begin < sides.size();) {
    std::size_t end = begin + 1;
    while (end < sides.size() && sides[end].sameEdge(sides[begin])) ++end;
    visit(begin, end);
    begin = end;
  }
}

/// Union-find without ranks: roots are the smallest members, so that numbering is canonical.
class DisjointSets {
 public:
  explicit DisjointSets(std::size_t count) : parent_(count) {
    std::iota(parent_.begin(), parent_.end(), 0);
  }
  std::int32_t root(std::int32_t x) {
    while (parent_[x] != x) x = parent_[x] = parent_[parent_[x]];
    return x;
  }
  void join(std::int32_t a, std::int32_t b) {
    a = root(a);
    b = root(b);
    if (a != b) parent_[std::max(a, b)] = std::min(a, b);
  }

 private:
  std::vector<std::int32_t> parent_;
};

/// Lists of the values that each key has, from pairs in any order; lists come out ascending.
IndexLists groupByKey(std::size_t keys, const std::vector<std::array<std::int32_t, 2>>& pairs) {
  IndexLists lists;
  lists.begin.assign(keys + 1, 0);
  lists.values.resize(pairs.size());
  for (const auto& [key, value] : pairs) ++lists.begin[key + 1];
  std::partial_sum(lists.begin.begin(), lists.begin.end(), lists.begin.begin());
  std::vector<std::int32_t> next(lists.begin.begin(), lists.begin.end() - 1);
  for (const auto& [key, value] : pairs) lists.values[next[key]++] = value;
  for (std::size_t key = 0; key < keys; ++key) {
    std::sort(lists.values.begin() + lists.begin[key], lists.values.begin() + lists.begin[key + 1]);
  }
  return lists;
}

IndexLists facesOfVertices(const Faces& faces, Eigen::Index vertexCount) {
  std::vector<std::array<std::int32_t, 2>> pairs;
  pairs.reserve(static_cast<std::size_t>(faces.rows()) * 3);
  for (std::int32_t f = 0; f < faces.rows(); ++f) {
    for (int k = 0; k < 3; ++k) pairs.push_back({faces(f, k), f});
  }
  return groupByKey(static_cast<std::size_t>(vertexCount), pairs);
}

bool inRange(const Faces& faces, std::int32_t f, Eigen::Index vertexCount) {
  return faces.row(f).minCoeff() >= 0 && faces.row(f).maxCoeff() < vertexCount;
}

bool repeatsVertex(const Faces& faces, std::int32_t f) {
  return faces(f, 0) == faces(f, 1) || faces(f, 1) == faces(f, 2) || faces(f, 2) == faces(f, 0);
}

/// Number of fans that a vertex's faces form: faces are in one fan if a chain of common edges at
/// the vertex joins them.
int fansAt(const Faces& faces, std::int32_t vertex, std::span<const std::int32_t> around) {
  DisjointSets fans(around.size());
  int count = static_cast<int>(around.size());
  for (std::size_t i = 0; i < around.size(); ++i) {
    for (std::size_t j = i + 1; j < around.size(); ++j) {
      int common = 0;
      for (int a = 0; a < 3; ++a) {
        for (int b = 0; b < 3; ++b) {
          common += faces(around[i], a) == faces(around[j], b) && faces(around[i], a) != vertex;
        }
      }
      const auto ri = fans.root(static_cast<std::int32_t>(i));
      const auto rj = fans.root(static_cast<std::int32_t>(j));
      if (common > 0 && ri != rj) {
        fans.join(ri, rj);
        --count;
      }
    }
  }
  return count;
}

bool collinear(const Point& a, const Point& b, const Point& c) {
  for (int axis = 0; axis < 3; ++axis) {
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    if (orientation(Eigen::Vector2d(a[u], a[v]), Eigen::Vector2d(b[u], b[v]),
                    Eigen::Vector2d(c[u], c[v])) != 0) {
      return false;
    }
  }
  return true;
}

std::int64_t countCoincident(const TriangleMesh& mesh, const std::vector<bool>& used) {
  std::vector<std::int32_t> order;
  for (std::int32_t v = 0; v < mesh.vertexCount(); ++v) {
    if (used[v] && mesh.positions.row(v).allFinite()) order.push_back(v);
  }
  const auto before = [&](std::int32_t a, std::int32_t b) {
    for (int k = 0; k < 3; ++k) {
      if (mesh.positions(a, k) != mesh.positions(b, k)) {
        return mesh.positions(a, k) < mesh.positions(b, k);
      }
    }
    return false;
  };
  std::sort(order.begin(), order.end(), before);
  std::int64_t count = 0;
  for (std::size_t i = 1; i < order.size(); ++i) count += !before(order[i - 1], order[i]);
  return count;
}

std::int64_t countDuplicateFaces(const Faces& faces, const std::vector<std::int32_t>& sound) {
  std::vector<std::array<std::int32_t, 3>> keys;
  keys.reserve(sound.size());
  for (const std::int32_t f : sound) {
    std::array<std::int32_t, 3> key = {faces(f, 0), faces(f, 1), faces(f, 2)};
    std::sort(key.begin(), key.end());
    keys.push_back(key);
  }
  std::sort(keys.begin(), keys.end());
  std::int64_t count = 0;
  for (std::size_t i = 1; i < keys.size(); ++i) count += keys[i] == keys[i - 1];
  return count;
}

void require(const TriangleMesh& mesh, std::string_view name, bool closed) {
  const MeshCondition c = inspectMesh(mesh);
  std::string findings;
  const auto note = [&](std::int64_t count, const char* what) {
    if (count == 0) return;
    if (!findings.empty()) findings += ", ";
    findings += std::to_string(count) + " " + what;
  };
  if (c.faces == 0) findings = "no faces";
  note(c.nonFiniteVertices, "vertices that are not finite");
  note(c.indicesOutOfRange, "faces that name vertices which do not exist");
  note(c.repeatedVertexFaces, "faces that name a vertex twice");
  note(c.duplicateFaces, "duplicate faces");
  note(c.nonManifoldEdges, "edges of more than two faces");
  note(c.nonManifoldVertices, "vertices where the surface touches itself");
  note(c.inconsistentEdges, "edges whose two faces are oriented against each other");
  if (closed) note(c.boundaryEdges, "boundary edges");
  if (findings.empty()) return;
  throw InvalidInput(std::string(name) + ": has " + findings + "; a" + (closed ? " closed," : "n") +
                     " oriented manifold surface is needed (repair the mesh, or extract it anew)");
}

}  // namespace

MeshTopology buildTopology(const Faces& faces, Eigen::Index vertexCount) {
  for (std::int32_t f = 0; f < faces.rows(); ++f) {
    if (!inRange(faces, f, vertexCount)) {
      throw InvalidInput("faces: face " + std::to_string(f) + " names a vertex outside 0.." +
                         std::to_string(vertexCount - 1));
    }
    if (repeatsVertex(faces, f)) {
      throw InvalidInput("faces: face " + std::to_string(f) + " names a vertex twice");
    }
  }
  const std::vector<HalfEdge> sides = sortedHalfEdges(faces);
  std::size_t edgeCount = 0;
  forEachEdge(sides, [&](std::size_t begin, std::size_t end) {
    if (end - begin > 2) {
      throw InvalidInput("faces: the edge from vertex " + std::to_string(sides[begin].low) +
                         " to " + std::to_string(sides[begin].high) + " has " +
                         std::to_string(end - begin) + " faces; at most two are possible");
    }
    ++edgeCount;
  });

  MeshTopology topology;
  topology.edges.resize(static_cast<Eigen::Index>(edgeCount), 2);
  topology.edgeFaces.resize(static_cast<Eigen::Index>(edgeCount), 2);
  topology.faceEdges.resize(faces.rows(), 3);
  std::vector<std::array<std::int32_t, 2>> neighbours;
  neighbours.reserve(2 * edgeCount);
  std::int32_t edge = 0;
  forEachEdge(sides, [&](std::size_t begin, std::size_t end) {
    const HalfEdge& side = sides[begin];
    topology.edges.row(edge) << side.low, side.high;
    topology.edgeFaces.row(edge) << side.face, (end - begin == 2 ? sides[begin + 1].face : -1);
    for (std::size_t s = begin; s < end; ++s)
      topology.faceEdges(sides[s].face, sides[s].side) = edge;
    neighbours.push_back({side.low, side.high});
    neighbours.push_back({side.high, side.low});
    ++edge;
  });
  topology.vertexFaces = facesOfVertices(faces, vertexCount);
  topology.vertexVertices = groupByKey(static_cast<std::size_t>(vertexCount), neighbours);
  return topology;
}

MeshCondition inspectMesh(const TriangleMesh& mesh) {
  MeshCondition condition;
  condition.vertices = mesh.vertexCount();
  condition.faces = mesh.faceCount();
  for (Eigen::Index v = 0; v < mesh.vertexCount(); ++v) {
    condition.nonFiniteVertices += !mesh.positions.row(v).allFinite();
  }
  std::vector<std::int32_t> sound;
  std::vector<bool> used(static_cast<std::size_t>(mesh.vertexCount()), false);
  for (std::int32_t f = 0; f < mesh.faceCount(); ++f) {
    if (!inRange(mesh.faces, f, mesh.vertexCount())) {
      ++condition.indicesOutOfRange;
      continue;
    }
    for (int k = 0; k < 3; ++k) used[mesh.faces(f, k)] = true;
    if (repeatsVertex(mesh.faces, f)) {
      ++condition.repeatedVertexFaces;
      continue;
    }
    sound.push_back(f);
    condition.zeroAreaFaces += collinear(mesh.corner(f, 0), mesh.corner(f, 1), mesh.corner(f, 2));
  }
  Faces soundFaces(static_cast<Eigen::Index>(sound.size()), 3);
  for (std::size_t i = 0; i < sound.size(); ++i) {
    soundFaces.row(static_cast<Eigen::Index>(i)) = mesh.faces.row(sound[i]);
  }
  const std::int64_t usedCount = std::count(used.begin(), used.end(), true);
  condition.unusedVertices = condition.vertices - usedCount;
  condition.duplicateFaces = countDuplicateFaces(mesh.faces, sound);
  condition.coincidentVertices = countCoincident(mesh, used);

  const std::vector<HalfEdge> sides = sortedHalfEdges(soundFaces);
  forEachEdge(sides, [&](std::size_t begin, std::size_t end) {
    ++condition.edges;
    condition.boundaryEdges += end - begin == 1;
    condition.nonManifoldEdges += end - begin > 2;
    if (end - begin == 2) {
      const auto startsAt = [&](const HalfEdge& s) { return soundFaces(s.face, s.side); };
      condition.inconsistentEdges += startsAt(sides[begin]) == startsAt(sides[begin + 1]);
    }
  });
  const IndexLists around = facesOfVertices(soundFaces, mesh.vertexCount());
  for (std::size_t v = 0; v < around.size(); ++v) {
    condition.nonManifoldVertices +=
        around[v].size() > 1 && fansAt(soundFaces, static_cast<std::int32_t>(v), around[v]) > 1;
  }
  for (const std::int32_t component : faceComponents(soundFaces, mesh.vertexCount())) {
    condition.components = std::max<std::int64_t>(condition.components, component + 1);
  }
  condition.eulerCharacteristic =
      usedCount - condition.edges + static_cast<std::int64_t>(sound.size());
  return condition;
}

void requireManifold(const TriangleMesh& mesh, std::string_view name) {
  require(mesh, name, false);
}

void requireClosedManifold(const TriangleMesh& mesh, std::string_view name) {
  require(mesh, name, true);
}

std::vector<std::int32_t> faceComponents(const Faces& faces, Eigen::Index vertexCount) {
  DisjointSets sets(static_cast<std::size_t>(vertexCount));
  for (Eigen::Index f = 0; f < faces.rows(); ++f) {
    sets.join(faces(f, 0), faces(f, 1));
    sets.join(faces(f, 0), faces(f, 2));
  }
  std::vector<std::int32_t> number(static_cast<std::size_t>(vertexCount), -1);
  std::vector<std::int32_t> component(static_cast<std::size_t>(faces.rows()));
  std::int32_t next = 0;
  for (Eigen::Index f = 0; f < faces.rows(); ++f) {
    std::int32_t& n = number[sets.root(faces(f, 0))];
    if (n < 0) n = next++;
    component[f] = n;
  }
  return component;
}

SubMesh extractFaces(const TriangleMesh& mesh, std::span<const std::int32_t> faces) {
  SubMesh part;
  part.faceOrigin.assign(faces.begin(), faces.end());
  std::vector<std::int32_t> number(static_cast<std::size_t>(mesh.vertexCount()), -1);
  for (const std::int32_t f : faces) {
    for (int k = 0; k < 3; ++k) number[mesh.faces(f, k)] = 0;
  }
  for (std::int32_t v = 0; v < mesh.vertexCount(); ++v) {
    if (number[v] < 0) continue;
    number[v] = static_cast<std::int32_t>(part.vertexOrigin.size());
    part.vertexOrigin.push_back(v);
  }
  part.mesh.positions.resize(static_cast<Eigen::Index>(part.vertexOrigin.size()), 3);
  for (std::size_t v = 0; v < part.vertexOrigin.size(); ++v) {
    part.mesh.positions.row(static_cast<Eigen::Index>(v)) =
        mesh.positions.row(part.vertexOrigin[v]);
  }
  part.mesh.faces.resize(static_cast<Eigen::Index>(faces.size()), 3);
  for (std::size_t f = 0; f < faces.size(); ++f) {
    for (int k = 0; k < 3; ++k) {
      part.mesh.faces(static_cast<Eigen::Index>(f), k) = number[mesh.faces(faces[f], k)];
    }
  }
  return part;
}

}  // namespace explica::geometry
