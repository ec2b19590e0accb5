// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "EdgeTree.h"

#include "Explica/Core/StopScope.h"

#include <algorithm>

namespace explica::planar {

EdgeTree::EdgeTree(const Curve& curve, const std::function<bool(int edge)>& moves) {
  const int n = curve.edgeCount();
  for (int first = 0; first < n;) {
    int end = first + 1;
    while (end < n && moves(end) == moves(first)) ++end;
    roots_.push_back(build(curve, first, end - first, moves(first)));
    first = end;
  }
}

int EdgeTree::build(const Curve& curve, int firstEdge, int edgeCount, bool moves) {
  constexpr int kLeafSize = 1;   // edges of a leaf
  constexpr int kAtOnce = 1024;  // edges before a stop is heard
  if (edgeCount > kAtOnce) checkpoint();
  Node node;
  node.firstEdge = firstEdge;
  node.edgeCount = edgeCount;
  node.anyMoves = moves;
  for (int e = firstEdge; e < firstEdge + edgeCount; ++e) {
    const Point2 a = curve.point(e);
    const Point2 b = curve.point(curve.next(e));
    const double length = (b - a).norm();
    node.charge += length;
    node.centre += length * (a + b) / 2;
  }
  node.centre /= node.charge;
  for (int e = firstEdge; e < firstEdge + edgeCount; ++e) {
    const Point2 a = curve.point(e) - node.centre;
    const Point2 b = curve.point(curve.next(e)) - node.centre;
    const double length = (b - a).norm();
    const Point2 middle = (a + b) / 2;
    node.moments += length * (middle * middle.transpose() + (b - a) * (b - a).transpose() / 12);
    node.radius = std::max({node.radius, a.norm(), b.norm()});
  }
  if (edgeCount > kLeafSize) {
    const int half = edgeCount / 2;
    node.left = build(curve, firstEdge, half, moves);
    node.right = build(curve, firstEdge + half, edgeCount - half, moves);
  }
  nodes_.push_back(node);
  return static_cast<int>(nodes_.size()) - 1;
}

}  // namespace explica::planar
