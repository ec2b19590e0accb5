// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Geometry/FaceTree.h"

#include "Explica/Core/Parallel.h"

#include <algorithm>
#include <array>
#include <numeric>

namespace explica::geometry {
namespace {

constexpr std::int32_t kLeafSize = 4;  // faces of a leaf at most

bool overlap(const Box& a, const Box& b) {
  return (a.min().array() <= b.max().array()).all() && (b.min().array() <= a.max().array()).all();
}

/// Visits items whose boxes overlap; Visit may be a concrete lambda, so that it inlines.
template <class Visit>
void visitOverlaps(const BoxTree& tree, const Box& box, const Visit& visit) {
  const auto& nodes = tree.nodes();
  if (nodes.empty()) return;
  std::array<std::int32_t, BoxTree::kStackDepth> stack;
  std::size_t depth = 0;
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

}  // namespace

BoxTree::BoxTree(const std::vector<Box>& boxes) : items_(boxes.size()), boxes_(boxes) {
  if (boxes.empty()) return;
  std::iota(items_.begin(), items_.end(), 0);
  std::vector<Point> centres(boxes.size());
  for (std::size_t i = 0; i < boxes.size(); ++i) centres[i] = boxes[i].center();

  nodes_.reserve(boxes.size());
  nodes_.push_back({Box(), -1, 0, static_cast<std::int32_t>(boxes.size())});
  for (std::size_t n = 0; n < nodes_.size(); ++n) {
    Node node = nodes_[n];
    Box spread;
    for (std::int32_t i = node.first; i < node.first + node.count; ++i) {
      node.box.extend(boxes[items_[i]]);
      spread.extend(centres[items_[i]]);
    }
    if (node.count > kLeafSize) {
      int axis = 0;
      (void)spread.sizes().maxCoeff(&axis);
      const std::int32_t half = node.count / 2;
      const auto begin = items_.begin() + node.first;
      std::nth_element(begin, begin + half, begin + node.count,
                       [&](std::int32_t a, std::int32_t b) {
                         const double x = centres[a][axis], y = centres[b][axis];
                         return x < y || (x == y && a < b);
                       });
      node.left = static_cast<std::int32_t>(nodes_.size());
      nodes_.push_back({Box(), -1, node.first, half});
      nodes_.push_back({Box(), -1, node.first + half, node.count - half});
      node.count = 0;
    }
    nodes_[n] = node;
  }
}

void BoxTree::refit(const std::vector<Box>& boxes) {
  boxes_ = boxes;
  for (std::size_t n = nodes_.size(); n-- > 0;) {  // children stand after their parent
    Node& node = nodes_[n];
    node.box.setEmpty();
    if (node.count > 0) {
      for (std::int32_t i = node.first; i < node.first + node.count; ++i) {
        node.box.extend(boxes_[items_[i]]);
      }
    } else {
      node.box.extend(nodes_[node.left].box);
      node.box.extend(nodes_[node.left + 1].box);
    }
  }
}

void BoxTree::forOverlaps(const Box& box, const std::function<void(std::int32_t)>& visit) const {
  visitOverlaps(*this, box, visit);
}

std::vector<std::array<std::int32_t, 2>> BoxTree::overlappingPairs() const {
  constexpr std::size_t kGrain = 512;  // elements a task
  std::vector<std::vector<std::array<std::int32_t, 2>>> found((boxes_.size() + kGrain - 1) /
                                                              kGrain);
  parallelForBlocks(boxes_.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    auto& mine = found[begin / kGrain];
    for (std::size_t i = begin; i < end; ++i) {
      const auto first = static_cast<std::int32_t>(i);
      visitOverlaps(*this, boxes_[i], [&](std::int32_t second) {
        if (second > first) mine.push_back({first, second});
      });
    }
  });
  std::vector<std::array<std::int32_t, 2>> pairs;
  for (const auto& block : found) pairs.insert(pairs.end(), block.begin(), block.end());
  std::ranges::sort(pairs);
  return pairs;
}

std::vector<Box> faceBoxes(const TriangleMesh& mesh, double margin) {
  std::vector<Box> boxes(static_cast<std::size_t>(mesh.faceCount()));
  for (std::size_t f = 0; f < boxes.size(); ++f) {
    for (int k = 0; k < 3; ++k) boxes[f].extend(mesh.corner(static_cast<Eigen::Index>(f), k));
    boxes[f].min().array() -= margin;
    boxes[f].max().array() += margin;
  }
  return boxes;
}

}  // namespace explica::geometry
