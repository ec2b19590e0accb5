// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Planar/Curve.h"

#include <functional>
#include <vector>

namespace explica::planar {

/// Binary tree over a curve's edges with the charge and second moments of every cluster.
///
/// Edges are consecutive along the curve, so halving their sequence keeps clusters compact; a
/// cluster holds either edges that move or edges at rest.
class EdgeTree {
 public:
  struct Node {
    Point2 centre = Point2::Zero();                     ///< of charge
    Eigen::Matrix2d moments = Eigen::Matrix2d::Zero();  ///< second moments about the centre, mm^3
    double charge = 0;                                  ///< length, mm
    double radius = 0;                                  ///< of a disc about the centre, mm
    int firstEdge = 0;
    int edgeCount = 0;
    int left = -1;  ///< children are left and right; -1 in a leaf
    int right = -1;
    bool anyMoves = false;
  };

  EdgeTree() = default;
  EdgeTree(const Curve& curve, const std::function<bool(int edge)>& moves);

  /// Calls far(node) for clusters that look smaller than the ratio from edge (a, b) and near(edge)
  /// for every edge of the others.
  template <class Far, class Near>
  void traverse(const Point2& a, const Point2& b, double openingRatio, const Far& far,
                const Near& near) const {
    const Point2 middle = (a + b) / 2;
    const double reach = (b - a).norm() / 2;
    for (int root : roots_) visit(root, middle, reach, openingRatio, far, near);
  }

 private:
  int build(const Curve& curve, int firstEdge, int edgeCount, bool moves);

  template <class Far, class Near>
  void visit(int index, const Point2& middle, double reach, double ratio, const Far& far,
             const Near& near) const {
    const Node& node = nodes_[index];
    const double distance = (middle - node.centre).norm();
    if (node.radius + reach < ratio * distance) {
      far(node);
    } else if (node.left < 0) {
      for (int e = node.firstEdge; e < node.firstEdge + node.edgeCount; ++e) near(e);
    } else {
      visit(node.left, middle, reach, ratio, far, near);
      visit(node.right, middle, reach, ratio, far, near);
    }
  }

  std::vector<Node> nodes_;
  std::vector<int> roots_;
};

}  // namespace explica::planar
