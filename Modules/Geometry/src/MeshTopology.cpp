// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Geometry/MeshTopology.h"

#include "Explica/Core/DisjointSets.h"
#include "Explica/Core/Errors.h"
#include "Explica/Core/Parallel.h"
#include "Explica/Geometry/FacePieces.h"
#include "Explica/Geometry/Predicates.h"

#include <algorithm>
#include <array>
#include <bit>
#include <numeric>
#include <string>

namespace explica::geometry {
namespace {

constexpr std::size_t kTopologyGrain = 2048;  // elements a task

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

/// By edge, then face: a pass that counts by the lower vertex, whose few sides are sorted then.
std::vector<HalfEdge> sortedHalfEdges(const Faces& faces, Eigen::Index vertexCount) {
  std::vector<std::int32_t> begin(static_cast<std::size_t>(vertexCount) + 1, 0);
  for (Eigen::Index f = 0; f < faces.rows(); ++f) {
    for (int k = 0; k < 3; ++k) ++begin[std::min(faces(f, k), faces(f, (k + 1) % 3)) + 1];
  }
  std::partial_sum(begin.begin(), begin.end(), begin.begin());
  std::vector<HalfEdge> sides(static_cast<std::size_t>(faces.rows()) * 3);
  std::vector<std::int32_t> at(begin.begin(), begin.end() - 1);
  for (std::int32_t f = 0; f < faces.rows(); ++f) {
    for (std::int32_t k = 0; k < 3; ++k) {
      const std::int32_t a = faces(f, k), b = faces(f, (k + 1) % 3);
      sides[at[std::min(a, b)]++] = {std::min(a, b), std::max(a, b), f, k};
    }
  }
  parallelFor(static_cast<std::size_t>(vertexCount), [&](std::size_t v) {
    std::sort(sides.begin() + begin[v], sides.begin() + begin[v + 1]);
  });
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

/// Lists of the values that each key has, from pairs in any order; lists come out ascending.
IndexLists groupByKey(std::size_t keys, const std::vector<std::array<std::int32_t, 2>>& pairs) {
  IndexLists lists;
  lists.begin.assign(keys + 1, 0);
  lists.values.resize(pairs.size());
  for (const auto& [key, value] : pairs) ++lists.begin[key + 1];
  std::partial_sum(lists.begin.begin(), lists.begin.end(), lists.begin.begin());
  std::vector<std::int32_t> next(lists.begin.begin(), lists.begin.end() - 1);
  for (const auto& [key, value] : pairs) lists.values[next[key]++] = value;
  parallelFor(keys, [&](std::size_t key) {
    std::sort(lists.values.begin() + lists.begin[key], lists.values.begin() + lists.begin[key + 1]);
  });
  return lists;
}

IndexLists facesOfVertices(const Faces& faces, Eigen::Index vertexCount) {
  IndexLists lists;
  lists.begin.assign(static_cast<std::size_t>(vertexCount) + 1, 0);
  lists.values.resize(static_cast<std::size_t>(faces.size()));
  for (Eigen::Index n = 0; n < faces.size(); ++n) ++lists.begin[faces.data()[n] + 1];
  std::partial_sum(lists.begin.begin(), lists.begin.end(), lists.begin.begin());
  std::vector<std::int32_t> next(lists.begin.begin(), lists.begin.end() - 1);
  for (std::int32_t f = 0; f < faces.rows(); ++f) {
    for (int k = 0; k < 3; ++k) lists.values[next[faces(f, k)]++] = f;
  }
  return lists;
}

bool inRange(const Faces& faces, std::int32_t f, Eigen::Index vertexCount) {
  return faces.row(f).minCoeff() >= 0 && faces.row(f).maxCoeff() < vertexCount;
}

bool repeatsVertex(const Faces& faces, std::int32_t f) {
  return faces(f, 0) == faces(f, 1) || faces(f, 1) == faces(f, 2) || faces(f, 2) == faces(f, 0);
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

/// Groups [0, count) by hash, so that equals stand together; each group is sorted by `before`.
/// @return how many items equal the one before them
template <class Hash, class Before>
std::int64_t countRepeated(std::size_t count, const Hash& hash, const Before& before) {
  constexpr std::size_t kPerBin = 4;
  std::size_t bins = 1;
  while (kPerBin * bins < count) bins *= 2;
  std::vector<std::uint32_t> binOf(count);
  parallelFor(count, [&](std::size_t i) {
    std::uint64_t mixed = hash(i);
    mixed = (mixed ^ (mixed >> 29)) * 0xBF58476D1CE4E5B9U;
    binOf[i] = static_cast<std::uint32_t>((mixed ^ (mixed >> 32)) & (bins - 1));
  });
  std::vector<std::uint32_t> begin(bins + 1, 0), order(count);
  for (const std::uint32_t b : binOf) ++begin[b + 1];
  std::partial_sum(begin.begin(), begin.end(), begin.begin());
  std::vector<std::uint32_t> at(begin.begin(), begin.end() - 1);
  for (std::size_t i = 0; i < count; ++i) order[at[binOf[i]]++] = static_cast<std::uint32_t>(i);
  return parallelSum(bins, kTopologyGrain, std::int64_t{0},
                     [&](std::size_t first, std::size_t last) {
                       std::int64_t repeated = 0;
                       for (std::size_t b = first; b < last; ++b) {
                         std::sort(order.begin() + begin[b], order.begin() + begin[b + 1], before);
                         for (std::size_t n = begin[b] + 1; n < begin[b + 1]; ++n) {
                           repeated += !before(order[n - 1], order[n]);
                         }
                       }
                       return repeated;
                     });
}

std::int64_t countCoincident(const TriangleMesh& mesh, const std::vector<bool>& used) {
  std::vector<std::int32_t> vertices;
  for (std::int32_t v = 0; v < mesh.vertexCount(); ++v) {
    if (used[v] && mesh.positions.row(v).allFinite()) vertices.push_back(v);
  }
  const auto at = [&](std::uint32_t i, int k) { return mesh.positions(vertices[i], k) + 0.0; };
  return countRepeated(
      vertices.size(),
      [&](std::size_t i) {
        std::uint64_t sum = 0;
        for (int k = 0; k < 3; ++k) {
          sum = sum * 0x9E3779B97F4A7C15U +
                std::bit_cast<std::uint64_t>(at(static_cast<std::uint32_t>(i), k));
        }
        return sum;
      },
      [&](std::uint32_t a, std::uint32_t b) {
        for (int k = 0; k < 3; ++k) {
          if (at(a, k) != at(b, k)) return at(a, k) < at(b, k);
        }
        return false;
      });
}

std::int64_t countDuplicateFaces(const Faces& faces, const std::vector<std::int32_t>& sound) {
  std::vector<std::array<std::int32_t, 3>> keys(sound.size());
  parallelFor(sound.size(), [&](std::size_t i) {
    keys[i] = {faces(sound[i], 0), faces(sound[i], 1), faces(sound[i], 2)};
    std::ranges::sort(keys[i]);
  });
  return countRepeated(
      keys.size(),
      [&](std::size_t i) {
        std::uint64_t sum = 0;
        for (const std::int32_t v : keys[i]) {
          sum = sum * 0x9E3779B97F4A7C15U + static_cast<std::uint32_t>(v);
        }
        return sum;
      },
      [&](std::uint32_t a, std::uint32_t b) { return keys[a] < keys[b]; });
}

/// How many of [0, count) have a property.
template <class Has>
std::int64_t countOf(std::size_t count, const Has& has) {
  return parallelSum(count, kTopologyGrain, std::int64_t{0},
                     [&](std::size_t begin, std::size_t end) {
                       std::int64_t found = 0;
                       for (std::size_t i = begin; i < end; ++i) found += has(i);
                       return found;
                     });
}

MeshCondition require(const TriangleMesh& mesh, std::string_view name, bool closed) {
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
  if (findings.empty()) return c;
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
  const std::vector<HalfEdge> sides = sortedHalfEdges(faces, vertexCount);
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
  MeshCondition condition{.vertices = mesh.vertexCount(), .faces = mesh.faceCount()};
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
  }
  condition.zeroAreaFaces = countOf(sound.size(), [&](std::size_t i) {
    const std::int32_t f = sound[i];
    return collinear(mesh.corner(f, 0), mesh.corner(f, 1), mesh.corner(f, 2));
  });
  Faces soundFaces(static_cast<Eigen::Index>(sound.size()), 3);
  for (std::size_t i = 0; i < sound.size(); ++i) {
    soundFaces.row(i) = mesh.faces.row(sound[i]);
  }
  const std::int64_t usedCount = std::ranges::count(used, true);
  condition.unusedVertices = condition.vertices - usedCount;
  condition.duplicateFaces = countDuplicateFaces(mesh.faces, sound);
  condition.coincidentVertices = countCoincident(mesh, used);

  const std::vector<HalfEdge> sides = sortedHalfEdges(soundFaces, mesh.vertexCount());
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
  condition.nonManifoldVertices = countOf(around.size(), [&](std::size_t v) {
    return around[v].size() > 1 &&
           fansAt(soundFaces, static_cast<std::int32_t>(v), around[v]).size() > 1;
  });
  for (const std::int32_t component : faceComponents(soundFaces, mesh.vertexCount())) {
    condition.components = std::max<std::int64_t>(condition.components, component + 1);
  }
  condition.eulerCharacteristic =
      usedCount - condition.edges + static_cast<std::int64_t>(sound.size());
  return condition;
}

MeshCondition requireManifold(const TriangleMesh& mesh, std::string_view name) {
  return require(mesh, name, false);
}

MeshCondition requireClosedManifold(const TriangleMesh& mesh, std::string_view name) {
  return require(mesh, name, true);
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

std::vector<std::int32_t> facePieces(const MeshTopology& topology,
                                     const std::vector<bool>& chosen) {
  std::vector<std::int32_t> piece(chosen.size(), -1), waiting;
  std::int32_t pieces = 0;
  for (std::size_t first = 0; first < chosen.size(); ++first) {
    if (!chosen[first] || piece[first] >= 0) continue;
    piece[first] = pieces;
    waiting.assign(1, static_cast<std::int32_t>(first));
    while (!waiting.empty()) {
      const std::int32_t f = waiting.back();
      waiting.pop_back();
      for (int k = 0; k < 3; ++k) {
        for (const std::int32_t g : topology.edgeFaces.row(topology.faceEdges(f, k))) {
          if (g < 0 || !chosen[g] || piece[g] >= 0) continue;
          piece[g] = pieces;
          waiting.push_back(g);
        }
      }
    }
    ++pieces;
  }
  return piece;
}

std::vector<std::vector<std::int32_t>> boundaryLoops(const Faces& faces, Eigen::Index vertexCount) {
  const MeshTopology topology = buildTopology(faces, vertexCount);
  std::vector<std::int32_t> next(static_cast<std::size_t>(vertexCount), -1);
  for (Eigen::Index f = 0; f < faces.rows(); ++f) {
    for (int k = 0; k < 3; ++k) {
      if (topology.edgeFaces(topology.faceEdges(f, k), 1) >= 0) continue;
      next[faces(f, k)] = faces(f, (k + 1) % 3);
    }
  }
  std::vector<std::vector<std::int32_t>> loops;
  std::vector<bool> done(next.size(), false);
  for (std::size_t v = 0; v < next.size(); ++v) {
    if (next[v] < 0 || done[v]) continue;
    std::vector<std::int32_t>& loop = loops.emplace_back();
    for (auto at = static_cast<std::int32_t>(v); at >= 0 && !done[at]; at = next[at]) {
      done[at] = true;
      loop.push_back(at);
    }
  }
  return loops;
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
    part.mesh.positions.row(v) = mesh.positions.row(part.vertexOrigin[v]);
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
