// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Collision/CollisionScene.h"

#include "MotionTree.h"

#include "Explica/Core/Errors.h"
#include "Explica/Core/Parallel.h"

#include <algorithm>
#include <cmath>

namespace explica::collision {
namespace {

using geometry::Box;

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

struct VertexRow {
  std::int32_t vertex;
  static constexpr Eigen::Index size() { return 1; }
  std::int32_t operator[](Eigen::Index) const { return vertex; }
};

}  // namespace

struct CollisionScene::Surroundings {
  std::vector<std::int32_t> vertices, edges, faces;
  MotionTree vertexTree, edgeTree, faceTree;
};

CollisionScene::CollisionScene(const TriangleMesh& mesh, const std::vector<bool>& vertexMoves)
    : faces_(mesh.faces), edges_(edgesOf(mesh.faces)) {
  if (static_cast<Eigen::Index>(vertexMoves.size()) != mesh.vertexCount()) {
    throw InvalidInput("vertexMoves: " + std::to_string(vertexMoves.size()) + " flags for " +
                       std::to_string(mesh.vertexCount()) + " vertices");
  }
  Surroundings fixed;
  std::vector<bool> used(vertexMoves.size(), false);
  for (Eigen::Index n = 0; n < faces_.size(); ++n) used[faces_.data()[n]] = true;
  for (std::int32_t v = 0; v < static_cast<std::int32_t>(used.size()); ++v) {
    if (used[v]) (vertexMoves[v] ? moving_.vertices : fixed.vertices).push_back(v);
  }
  for (std::int32_t e = 0; e < edges_.rows(); ++e) {
    const bool moves = vertexMoves[edges_(e, 0)] || vertexMoves[edges_(e, 1)];
    (moves ? moving_.edges : fixed.edges).push_back(e);
  }
  for (std::int32_t f = 0; f < faces_.rows(); ++f) {
    const bool moves =
        vertexMoves[faces_(f, 0)] || vertexMoves[faces_(f, 1)] || vertexMoves[faces_(f, 2)];
    (moves ? moving_.faces : fixed.faces).push_back(f);
  }
  const Positions still = Positions::Zero(mesh.vertexCount(), 3);
  const auto treeOf = [&](const std::vector<std::int32_t>& items, const auto& rowOf) {
    std::vector<MovingBox> boxes;
    boxes.reserve(items.size());
    for (const std::int32_t i : items) boxes.push_back(movingBox(rowOf(i), mesh.positions, still));
    return MotionTree(std::move(boxes));
  };
  fixed.vertexTree = treeOf(fixed.vertices, [](std::int32_t v) { return VertexRow{v}; });
  fixed.edgeTree = treeOf(fixed.edges, [this](std::int32_t e) { return edges_.row(e); });
  fixed.faceTree = treeOf(fixed.faces, [this](std::int32_t f) { return faces_.row(f); });
  fixed_ = std::make_shared<const Surroundings>(std::move(fixed));
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
  const auto boxesOf = [&](const std::vector<std::int32_t>& items, const auto& rowOf) {
    std::vector<MovingBox> boxes(items.size());
    parallelFor(items.size(), kGrain,
                [&](std::size_t n) { boxes[n] = movingBox(rowOf(items[n]), start, motion); });
    return boxes;
  };
  const auto edgeRow = [this](std::int32_t e) { return edges_.row(e); };
  const auto faceRow = [this](std::int32_t f) { return faces_.row(f); };
  const auto vertexBoxes = boxesOf(moving_.vertices, [](std::int32_t v) { return VertexRow{v}; });
  const auto edgeBoxes = boxesOf(moving_.edges, edgeRow);
  const auto faceBoxes = boxesOf(moving_.faces, faceRow);
  std::array<MotionTree, 2> movingTrees;
  parallelFor(2, 1,
              [&](std::size_t n) { movingTrees[n] = MotionTree(n == 0 ? edgeBoxes : faceBoxes); });
  const MotionTree &movingEdgeTree = movingTrees[0], &movingFaceTree = movingTrees[1];

  // Boxes come near more often than what is in them: the distance at the start less the bound of
  // their approach decides.
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
  const std::array<Query, 3> queries = {
      Query{moving_.vertices.size(),
            [&](std::size_t n, std::vector<Pair>& pairs) {
              const std::int32_t v = moving_.vertices[n];
              const auto visit = [&](std::int32_t f) {
                keepIfNear(pairs, {PairKind::VertexFace, v, f});
              };
              movingFaceTree.visitMeetings(vertexBoxes[n], reach,
                                           [&](std::int32_t i) { visit(moving_.faces[i]); });
              fixed_->faceTree.visitMeetings(vertexBoxes[n], reach,
                                             [&](std::int32_t i) { visit(fixed_->faces[i]); });
            }},
      Query{moving_.faces.size(),
            [&](std::size_t n, std::vector<Pair>& pairs) {
              fixed_->vertexTree.visitMeetings(faceBoxes[n], reach, [&](std::int32_t i) {
                keepIfNear(pairs, {PairKind::VertexFace, fixed_->vertices[i], moving_.faces[n]});
              });
            }},
      Query{moving_.edges.size(), [&](std::size_t n, std::vector<Pair>& pairs) {
              const std::int32_t e = moving_.edges[n];
              movingEdgeTree.visitMeetings(edgeBoxes[n], reach, [&](std::int32_t i) {
                if (moving_.edges[i] > e) {
                  keepIfNear(pairs, {PairKind::EdgeEdge, e, moving_.edges[i]});
                }
              });
              fixed_->edgeTree.visitMeetings(edgeBoxes[n], reach, [&](std::int32_t i) {
                const std::int32_t other = fixed_->edges[i];
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
