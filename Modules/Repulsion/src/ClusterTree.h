// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "MovingSet.h"

#include <array>
#include <vector>

namespace explica::repulsion {

/// Faces seen as one.
struct Cluster {
  Point centre = Point::Zero();                      ///< centroid of the area, mm
  double area = 0;                                   ///< mm^2
  Eigen::Matrix3d second = Eigen::Matrix3d::Zero();  ///< of the area about the centre, mm^4
  double radius = 0;       ///< of the ball about the centre that holds the faces, mm
  std::int32_t first = 0;  ///< its faces in the tree's order
  std::int32_t count = 0;
  std::int32_t left = -1;  ///< children are left and left + 1; -1: a single face
};

/// Binary tree over faces, cut at the median across the longest side of their centroids' box.
class ClusterTree {
 public:
  ClusterTree(const Positions& positions, const Faces& faces, std::vector<std::int32_t> members);

  /// Walks down until what is met is far from a ball, or a single face.
  /// @param opening  share of the distance that both radii together may be for a cluster to be far
  /// @param far      far(cluster)
  /// @param near     near(face)
  template <class Far, class Near>
  void visit(const Point& centre, double radius, double opening, const Far& far,
             const Near& near) const {
    if (nodes_.empty()) return;
    std::array<std::int32_t, 64> open;  // cut in halves: no deeper
    int count = 0;
    open[count++] = 0;
    while (count > 0) {
      const Cluster& node = nodes_[open[--count]];
      if (node.radius + radius < opening * (node.centre - centre).norm()) {
        far(node);
      } else if (node.left < 0) {
        near(members_[node.first]);
      } else {
        open[count++] = node.left + 1;
        open[count++] = node.left;
      }
    }
  }

 private:
  std::vector<std::int32_t> members_;
  std::vector<Cluster> nodes_;
};

}  // namespace explica::repulsion
