// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Repulsion/ThesisTree.h"

#include "Assembly.h"
#include "Explica/Core/Errors.h"
#include "Explica/Core/Parallel.h"
#include "Explica/Repulsion/PairIntegral.h"
#include "MovingSet.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <queue>

namespace explica::repulsion {
namespace {

struct Candidate {
  double squaredDistance;
  std::int32_t a;
  std::int32_t b;
};

/// Order of a heap whose top is the closest pair.
struct Farther {
  bool operator()(const Candidate& l, const Candidate& r) const {
    if (l.squaredDistance != r.squaredDistance) return l.squaredDistance > r.squaredDistance;
    return l.a != r.a ? l.a > r.a : l.b > r.b;
  }
};
using Heap = std::priority_queue<Candidate, std::vector<Candidate>, Farther>;

void adopt(MergingTree& tree, std::int32_t parent, std::int32_t child) {
  MergingTree::Node& p = tree.nodes[parent];
  MergingTree::Node& c = tree.nodes[child];
  const double area = p.area + c.area;
  if (p.children.empty()) {
    p.centroid = c.centroid;
  } else if (area > 0) {
    p.centroid = (p.area * p.centroid + c.area * c.centroid) / area;
  }
  p.area = area;
  p.children.push_back(child);
  c.parent = parent;
}

/// Neighbours of the nodes of the next round: parents of the neighbours of their children.
std::vector<std::vector<std::int32_t>> neighboursAbove(
    const MergingTree& tree, const std::vector<std::int32_t>& round,
    const std::vector<std::vector<std::int32_t>>& below) {
  std::vector<std::vector<std::int32_t>> result(tree.nodes.size());
  for (const std::int32_t n : round) {
    for (const std::int32_t child : tree.nodes[n].children) {
      for (const std::int32_t other : below[child]) {
        const std::int32_t above = tree.nodes[other].parent;
        if (above >= 0 && above != n) result[n].push_back(above);
      }
    }
    auto& list = result[n];
    std::ranges::sort(list);
    list.erase(std::unique(list.begin(), list.end()), list.end());
  }
  return result;
}

}  // namespace

MergingTree buildMergingTree(const std::vector<Point>& centroids, const std::vector<double>& areas,
                             const std::vector<std::vector<std::int32_t>>& neighbours) {
  MergingTree tree;
  for (std::size_t i = 0; i < centroids.size(); ++i) {
    MergingTree::Node node;
    node.centroid = centroids[i];
    node.area = areas[i];
    tree.nodes.push_back(node);
  }
  std::vector<std::int32_t> round(centroids.size());
  for (std::size_t i = 0; i < round.size(); ++i) round[i] = static_cast<std::int32_t>(i);
  std::vector<std::vector<std::int32_t>> nearby = neighbours;
  std::vector<std::int32_t> alone;  // whole parts without neighbours

  while (round.size() > 1) {
    std::vector<Candidate> pairs;  // steps 2 and 3
    for (const std::int32_t n : round) {
      for (const std::int32_t m : nearby[n]) {
        if (m > n) {
          pairs.push_back({(tree.nodes[n].centroid - tree.nodes[m].centroid).squaredNorm(), n, m});
        }
      }
    }
    const auto merged = [&](std::int32_t n) { return tree.nodes[n].parent >= 0; };
    std::vector<std::int32_t> next;
    for (Heap heap(Farther{}, pairs); !heap.empty(); heap.pop()) {  // step 4
      const Candidate top = heap.top();
      if (merged(top.a) || merged(top.b)) continue;
      const auto parent = static_cast<std::int32_t>(tree.nodes.size());
      tree.nodes.emplace_back();
      adopt(tree, parent, top.a);
      adopt(tree, parent, top.b);
      next.push_back(parent);
    }
    std::vector<Candidate> halfMerged;  // step 5
    for (const Candidate& c : pairs) {
      if (merged(c.a) != merged(c.b)) halfMerged.push_back(c);
    }
    for (Heap heap(Farther{}, halfMerged); !heap.empty(); heap.pop()) {  // step 6
      const Candidate top = heap.top();
      if (merged(top.a) && merged(top.b)) continue;
      const std::int32_t in = merged(top.a) ? top.a : top.b;
      const std::int32_t out = merged(top.a) ? top.b : top.a;
      adopt(tree, tree.nodes[in].parent, out);
    }
    for (const std::int32_t n : round) {
      if (!merged(n)) alone.push_back(n);
    }
    nearby = neighboursAbove(tree, next, nearby);
    round = std::move(next);
  }
  alone.insert(alone.end(), round.begin(), round.end());
  if (alone.size() > 1) {
    const auto root = static_cast<std::int32_t>(tree.nodes.size());
    tree.nodes.emplace_back();
    for (const std::int32_t n : alone) adopt(tree, root, n);
  }
  return tree;
}

namespace {

/// Steps 1 to 5 of the fast algorithm but for what is done at each start.
template <class Visit>
void forRecursionStarts(const MergingTree& tree, std::int32_t face,
                        const std::vector<std::int32_t>& exact, std::vector<char>& visited,
                        const Visit& visit) {
  visited.assign(tree.nodes.size(), 0);
  const auto markPath = [&](std::int32_t n) {
    for (; n >= 0 && !visited[n]; n = tree.nodes[n].parent) visited[n] = 1;
  };
  markPath(face);
  for (const std::int32_t n : exact) markPath(n);
  // Below a start everything is visited: 2 tells it from the paths.
  for (auto n = static_cast<std::int32_t>(tree.nodes.size()); n-- > 0;) {
    if (visited[n] == 1) continue;
    const std::int32_t parent = tree.nodes[n].parent;
    if (parent < 0 || visited[parent] != 2) visit(n);
    visited[n] = 2;
  }
}

/// Force of a node on the corners of a face.
struct NodeForce {
  double value = 0;
  std::array<Vector, 3> byCorner;
};

class Recursion {
 public:
  /// @param weightedAreas  of each node: faces that do not move count twice
  Recursion(const MergingTree& tree, const std::vector<double>& weightedAreas, double relativeError)
      : tree_(tree), weightedAreas_(weightedAreas), relativeError_(relativeError) {}

  [[nodiscard]] NodeForce on(const Corners& corners, std::int32_t node) const {
    const AreaGradient area = areaGradient(corners);
    const Point centroid = (corners[0] + corners[1] + corners[2]) / 3;
    return refine(area, centroid, node, estimate(area, centroid, node));
  }

 private:
  /// [Thesis, Eq. 5.45] with the squared distance of the centroids in its first term.
  [[nodiscard]] NodeForce estimate(const AreaGradient& area, const Point& centroid,
                                   std::int32_t node) const {
    const MergingTree::Node& n = tree_.nodes[node];
    const Vector z = centroid - n.centroid;
    const double inverse = 1 / z.squaredNorm();
    NodeForce force;
    force.value = area.area * weightedAreas_[node] * inverse;
    const Vector pull = (-2.0 / 3 * area.area * n.area * inverse * inverse) * z;
    for (int k = 0; k < 3; ++k) force.byCorner[k] = n.area * inverse * area.byCorner[k] + pull;
    return force;
  }

  [[nodiscard]] NodeForce refine(const AreaGradient& area, const Point& centroid, std::int32_t node,
                                 const NodeForce& own) const {
    const auto& children = tree_.nodes[node].children;
    if (children.empty()) return own;
    std::vector<NodeForce> parts;
    NodeForce sum{0, {Vector::Zero(), Vector::Zero(), Vector::Zero()}};
    const auto addTo = [](NodeForce& total, const NodeForce& part) {
      total.value += part.value;
      for (int k = 0; k < 3; ++k) total.byCorner[k] += part.byCorner[k];
    };
    for (const std::int32_t child : children) {
      parts.push_back(estimate(area, centroid, child));
      addTo(sum, parts.back());
    }
    double error = 0;
    for (int k = 0; k < 3; ++k) {
      error += (own.byCorner[k] - sum.byCorner[k]).norm() / (3 * sum.byCorner[k].norm());
    }
    if (error <= relativeError_) return sum;
    NodeForce finer{0, {Vector::Zero(), Vector::Zero(), Vector::Zero()}};
    for (std::size_t i = 0; i < children.size(); ++i) {
      addTo(finer, refine(area, centroid, children[i], parts[i]));
    }
    return finer;
  }

  const MergingTree& tree_;
  const std::vector<double>& weightedAreas_;
  double relativeError_;
};

}  // namespace

ThesisTree::ThesisTree(const TriangleMesh& mesh, const std::vector<bool>& vertexMoves,
                       const ThesisTreeOptions& options)
    : set_(std::make_unique<MovingSet>(mesh, vertexMoves)), options_(options) {
  if (!(options.nearDistance >= 0) || !(options.relativeError > 0)) {
    throw InvalidInput(
        "knot energy: near distance must not be negative, relative error be positive");
  }
  const auto count = static_cast<std::size_t>(mesh.faceCount());
  std::vector<Point> centroids(count);
  std::vector<double> areas(count);
  std::vector<std::vector<std::int32_t>> at(static_cast<std::size_t>(mesh.vertexCount()));
  double edges = 0;
  for (std::size_t f = 0; f < count; ++f) {
    const Corners c = cornersOf(mesh.positions, mesh.faces, static_cast<std::int32_t>(f));
    centroids[f] = (c[0] + c[1] + c[2]) / 3;
    areas[f] = areaGradient(c).area;
    for (int k = 0; k < 3; ++k) {
      edges += (c[(k + 1) % 3] - c[k]).norm();
      at[mesh.faces(static_cast<Eigen::Index>(f), k)].push_back(static_cast<std::int32_t>(f));
    }
  }
  nearDistance_ = count > 0 ? options.nearDistance * edges / (3 * static_cast<double>(count)) : 0;
  std::vector<std::vector<std::int32_t>> neighbours(count);
  for (std::size_t f = 0; f < count; ++f) {
    auto& list = neighbours[f];
    for (int k = 0; k < 3; ++k) {
      const auto& around = at[mesh.faces(static_cast<Eigen::Index>(f), k)];
      list.insert(list.end(), around.begin(), around.end());
    }
    std::ranges::sort(list);
    list.erase(std::unique(list.begin(), list.end()), list.end());
    list.erase(std::ranges::find(list, static_cast<std::int32_t>(f)));
  }
  tree_ = buildMergingTree(centroids, areas, neighbours);
}

ThesisTree::~ThesisTree() = default;

KnotValue ThesisTree::evaluate(const Positions& positions) const {
  set_->requireVertexCount(positions);
  MergingTree tree = tree_;
  std::vector<double> weightedAreas(tree.nodes.size(), 0.0);
  const auto faceCount = static_cast<std::int32_t>(set_->faces.rows());
  for (std::int32_t n = 0; n < static_cast<std::int32_t>(tree.nodes.size()); ++n) {
    MergingTree::Node& node = tree.nodes[n];
    if (n < faceCount) {
      const Corners c = cornersOf(positions, set_->faces, n);
      node.centroid = (c[0] + c[1] + c[2]) / 3;
      node.area = areaGradient(c).area;
      weightedAreas[n] = (set_->faceMoves[n] ? 1 : 2) * node.area;
      continue;
    }
    node.area = 0;
    Point moment = Point::Zero();
    Point mean = Point::Zero();
    for (const std::int32_t child : node.children) {
      node.area += tree.nodes[child].area;
      moment += tree.nodes[child].area * tree.nodes[child].centroid;
      mean += tree.nodes[child].centroid;
      weightedAreas[n] += weightedAreas[child];
    }
    node.centroid = node.area > 0 ? Point(moment / node.area)
                                  : Point(mean / static_cast<double>(node.children.size()));
  }

  const Recursion recursion(tree, weightedAreas, options_.relativeError);
  const double squaredNear = nearDistance_ * nearDistance_;
  std::vector<FaceForce> forces(set_->moving.size());
  parallelForBlocks(forces.size(), 8, [&](std::size_t begin, std::size_t end) {
    std::vector<char> visited;
    std::vector<std::int32_t> exact;
    for (std::size_t k = begin; k < end; ++k) {
      const std::int32_t s = set_->moving[k];
      const Corners corners = cornersOf(positions, set_->faces, s);
      FaceForce& force = forces[k];
      const auto touching = set_->touching(k);
      exact.assign(touching.begin(), touching.end());
      for (std::int32_t t = 0; t < faceCount; ++t) {
        if ((tree.nodes[t].centroid - tree.nodes[s].centroid).squaredNorm() >= squaredNear)
          continue;
        if (std::ranges::binary_search(touching, t)) continue;
        exact.push_back(t);
        const PairIntegral pair =
            integrateApart(corners, cornersOf(positions, set_->faces, t), PairAccuracy::Coarse);
        force.value += (set_->faceMoves[t] ? 1 : 2) * pair.value;
        for (int c = 0; c < 3; ++c) force.byCorner[c] += 2 * pair.byS[c];
      }
      forRecursionStarts(tree, s, exact, visited, [&](std::int32_t n) {
        const NodeForce far = recursion.on(corners, n);
        force.value += far.value;
        for (int c = 0; c < 3; ++c) force.byCorner[c] += 2 * far.byCorner[c];
      });
    }
  });
  return assemble(*set_, positions, forces, PairAccuracy::Coarse);
}

}  // namespace explica::repulsion
