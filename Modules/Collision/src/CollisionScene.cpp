// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Collision/CollisionScene.h"

#include "Explica/Core/Errors.h"
#include "Explica/Core/Parallel.h"

#include <algorithm>
#include <cmath>

namespace explica::collision {
namespace {

using geometry::Box;
using geometry::BoxTree;

bool overlap(const Box& a, const Box& b) {
  return a.min()[0] <= b.max()[0] && b.min()[0] <= a.max()[0] && a.min()[1] <= b.max()[1] &&
         b.min()[1] <= a.max()[1] && a.min()[2] <= b.max()[2] && b.min()[2] <= a.max()[2];
}

/// BoxTree::forOverlaps with the visitor inlined; this is the innermost loop of a step.
template <class Visit>
void visitOverlaps(const BoxTree& tree, const Box& box, const Visit& visit) {
  constexpr int kStackDepth = 64;  // two per level of a balanced tree of 2^31 items
  const auto& nodes = tree.nodes();
  if (nodes.empty()) return;
  std::array<std::int32_t, kStackDepth> stack;
  int depth = 0;
  stack[depth++] = 0;
  while (depth > 0) {
    const BoxTree::Node& node = nodes[stack[--depth]];
    if (!overlap(node.box, box)) continue;
    if (node.count > 0) {
      for (std::int32_t n = node.first; n < node.first + node.count; ++n) {
        const std::int32_t item = tree.items()[n];
        if (overlap(tree.boxes()[item], box)) visit(item);
      }
    } else {
      stack[depth++] = node.left + 1;
      stack[depth++] = node.left;
    }
  }
}

Edges edgesOf(const Faces& faces) {
  std::vector<std::array<std::int32_t, 2>> all;
  all.reserve(3 * faces.rows());
  for (Eigen::Index f = 0; f < faces.rows(); ++f) {
    for (int k = 0; k < 3; ++k) {
      const std::int32_t a = faces(f, k), b = faces(f, (k + 1) % 3);
      all.push_back({std::min(a, b), std::max(a, b)});
    }
  }
  std::sort(all.begin(), all.end());
  all.erase(std::unique(all.begin(), all.end()), all.end());
  Edges edges(static_cast<Eigen::Index>(all.size()), 2);
  for (std::size_t e = 0; e < all.size(); ++e) edges.row(e) << all[e][0], all[e][1];
  return edges;
}

/// Box of the places that the listed vertices pass.
template <class Row>
Box sweptBox(const Row& vertices, const Positions& start, const Positions& motion, double margin) {
  Box box;
  for (Eigen::Index k = 0; k < vertices.size(); ++k) {
    const Point p = start.row(vertices[k]).transpose();
    box.extend(p);
    box.extend(Point(p + motion.row(vertices[k]).transpose()));
  }
  box.min().array() -= margin;
  box.max().array() += margin;
  return box;
}

struct VertexRow {
  std::int32_t vertex;
  static constexpr Eigen::Index size() { return 1; }
  std::int32_t operator[](Eigen::Index) const { return vertex; }
};

}  // namespace

CollisionScene::CollisionScene(const TriangleMesh& mesh, const std::vector<bool>& vertexMoves)
    : faces_(mesh.faces), edges_(edgesOf(mesh.faces)) {
  if (static_cast<Eigen::Index>(vertexMoves.size()) != mesh.vertexCount()) {
    throw InvalidInput("vertexMoves: " + std::to_string(vertexMoves.size()) + " flags for " +
                       std::to_string(mesh.vertexCount()) + " vertices");
  }
  std::vector<bool> used(vertexMoves.size(), false);
  for (Eigen::Index n = 0; n < faces_.size(); ++n) used[faces_.data()[n]] = true;
  for (std::int32_t v = 0; v < static_cast<std::int32_t>(used.size()); ++v) {
    if (used[v]) (vertexMoves[v] ? moving_ : fixed_).vertices.push_back(v);
  }
  for (std::int32_t e = 0; e < edges_.rows(); ++e) {
    const bool moves = vertexMoves[edges_(e, 0)] || vertexMoves[edges_(e, 1)];
    (moves ? moving_ : fixed_).edges.push_back(e);
  }
  for (std::int32_t f = 0; f < faces_.rows(); ++f) {
    const bool moves =
        vertexMoves[faces_(f, 0)] || vertexMoves[faces_(f, 1)] || vertexMoves[faces_(f, 2)];
    (moves ? moving_ : fixed_).faces.push_back(f);
  }
  const Positions& still = mesh.positions;
  const auto boxOf = [&](const auto& row) {
    Box box;
    for (Eigen::Index k = 0; k < row.size(); ++k) box.extend(Point(still.row(row[k]).transpose()));
    return box;
  };
  std::vector<Box> boxes;
  for (const std::int32_t v : fixed_.vertices) boxes.push_back(boxOf(VertexRow{v}));
  fixedVertexTree_ = BoxTree(boxes);
  boxes.clear();
  for (const std::int32_t e : fixed_.edges) boxes.push_back(boxOf(edges_.row(e)));
  fixedEdgeTree_ = BoxTree(boxes);
  boxes.clear();
  for (const std::int32_t f : fixed_.faces) boxes.push_back(boxOf(faces_.row(f)));
  fixedFaceTree_ = BoxTree(boxes);
}

std::array<std::int32_t, 4> CollisionScene::vertices(const Pair& pair) const {
  if (pair.kind == PairKind::VertexFace) {
    return {pair.first, faces_(pair.second, 0), faces_(pair.second, 1), faces_(pair.second, 2)};
  }
  return {edges_(pair.first, 0), edges_(pair.first, 1), edges_(pair.second, 0),
          edges_(pair.second, 1)};
}

FourPoints CollisionScene::points(const Pair& pair, const Positions& positions) const {
  const auto v = vertices(pair);
  FourPoints x;
  for (int i = 0; i < 4; ++i) x[i] = positions.row(v[i]).transpose();
  return x;
}

std::vector<Pair> CollisionScene::findPairs(const Positions& start, const Positions& motion,
                                            double reach) const {
  constexpr std::size_t kGrain = 256;
  const auto boxesOf = [&](const std::vector<std::int32_t>& items, const auto& rowOf,
                           double margin) {
    std::vector<Box> boxes(items.size());
    parallelFor(items.size(), kGrain, [&](std::size_t n) {
      boxes[n] = sweptBox(rowOf(items[n]), start, motion, margin);
    });
    return boxes;
  };
  const auto vertexRow = [](std::int32_t v) { return VertexRow{v}; };
  const auto edgeRow = [this](std::int32_t e) { return edges_.row(e); };
  const auto faceRow = [this](std::int32_t f) { return faces_.row(f); };
  const std::vector<Box> vertexBoxes = boxesOf(moving_.vertices, vertexRow, reach);
  const std::vector<Box> edgeBoxes = boxesOf(moving_.edges, edgeRow, reach);
  const std::vector<Box> faceBoxes = boxesOf(moving_.faces, faceRow, reach);
  const BoxTree movingEdgeTree(edgeBoxes), movingFaceTree(faceBoxes);

  // Boxes overlap far more often than pairs come near: neighbours move together.  Distance at the
  // start less the bound of their approach decides.
  const auto keepIfNear = [&](std::vector<Pair>& pairs, const Pair& pair) {
    const auto v = vertices(pair);
    for (int i = 0; i < (pair.kind == PairKind::VertexFace ? 1 : 2); ++i) {
      for (int j = pair.kind == PairKind::VertexFace ? 1 : 2; j < 4; ++j) {
        if (v[i] == v[j]) return;
      }
    }
    FourPoints x, along;
    for (int i = 0; i < 4; ++i) {
      x[i] = start.row(v[i]).transpose();
      along[i] = motion.row(v[i]).transpose();
    }
    const double near = reach + approachBound(pair.kind, along);
    if (squaredDistance(pair.kind, x) <= near * near * (1 + 1e-12)) pairs.push_back(pair);
  };

  struct Query {
    std::size_t count;
    std::function<void(std::size_t, std::vector<Pair>&)> run;
  };
  // Fixed trees hold bare boxes, so the moving boxes carry the whole reach.
  const std::array<Query, 3> queries = {
      Query{moving_.vertices.size(),
            [&](std::size_t n, std::vector<Pair>& pairs) {
              const std::int32_t v = moving_.vertices[n];
              const auto visit = [&](std::int32_t f) {
                keepIfNear(pairs, {PairKind::VertexFace, v, f});
              };
              Box bare = vertexBoxes[n];
              bare.min().array() += reach;
              bare.max().array() -= reach;
              visitOverlaps(movingFaceTree, bare, [&](std::int32_t i) { visit(moving_.faces[i]); });
              visitOverlaps(fixedFaceTree_, vertexBoxes[n],
                            [&](std::int32_t i) { visit(fixed_.faces[i]); });
            }},
      Query{moving_.faces.size(),
            [&](std::size_t n, std::vector<Pair>& pairs) {
              visitOverlaps(fixedVertexTree_, faceBoxes[n], [&](std::int32_t i) {
                keepIfNear(pairs, {PairKind::VertexFace, fixed_.vertices[i], moving_.faces[n]});
              });
            }},
      Query{moving_.edges.size(), [&](std::size_t n, std::vector<Pair>& pairs) {
              const std::int32_t e = moving_.edges[n];
              Box bare = edgeBoxes[n];
              bare.min().array() += reach;
              bare.max().array() -= reach;
              visitOverlaps(movingEdgeTree, bare, [&](std::int32_t i) {
                if (moving_.edges[i] > e)
                  keepIfNear(pairs, {PairKind::EdgeEdge, e, moving_.edges[i]});
              });
              visitOverlaps(fixedEdgeTree_, edgeBoxes[n], [&](std::int32_t i) {
                const std::int32_t other = fixed_.edges[i];
                keepIfNear(pairs, {PairKind::EdgeEdge, std::min(e, other), std::max(e, other)});
              });
            }}};

  std::vector<Pair> all;
  for (const Query& query : queries) {
    std::vector<std::vector<Pair>> found((query.count + kGrain - 1) / kGrain);
    parallelForBlocks(query.count, kGrain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t n = begin; n < end; ++n) query.run(n, found[begin / kGrain]);
    });
    for (const auto& block : found) all.insert(all.end(), block.begin(), block.end());
  }
  return all;
}

double largestSafeStep(const CollisionScene& scene, std::span<const Pair> pairs,
                       const Positions& start, const Positions& motion, double limit,
                       const AdvanceOptions& options) {
  constexpr std::size_t kGrain = 512;
  std::vector<double> safe((pairs.size() + kGrain - 1) / kGrain, limit);
  parallelForBlocks(pairs.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    double& mine = safe[begin / kGrain];
    for (std::size_t n = begin; n < end; ++n) {
      mine = std::min(mine, safeTime(pairs[n].kind, scene.points(pairs[n], start),
                                     scene.points(pairs[n], motion), mine, options));
    }
  });
  for (const double t : safe) limit = std::min(limit, t);
  return limit;
}

}  // namespace explica::collision
