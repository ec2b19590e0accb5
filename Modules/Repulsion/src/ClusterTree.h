// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/TriangleMesh.h"
#include "Kernels.h"

#include <array>
#include <vector>

namespace explica::repulsion {

/// Binary tree over faces with the moments of their area.  Each cut runs across the longest side of
/// the centroids' box, next to the median: at a multiple of sixteen faces, so that all groups but
/// the last are full, and within a group at a multiple of four.
class ClusterTree {
 public:
  struct Node {
    Point centre = Point::Zero();  ///< centroid of the area, mm
    double radius = 0;             ///< of the ball about the centre that holds the faces, mm
    double largestFace = 0;        ///< largest distance of a face's corner from its centroid, mm
    std::int32_t first = 0;        ///< its faces are first .. first + count of the tree's order
    std::int32_t count = 0;
    std::int32_t left = -1;  ///< children are left and left + 1; -1 for a leaf

    [[nodiscard]] bool isLeaf() const { return left < 0; }
  };

  ClusterTree() = default;
  /// @param unit  lengths of SourceFace are in multiples of it, mm
  ClusterTree(const Positions& positions, const Faces& faces,
              const std::vector<std::int32_t>& members, double unit);

  [[nodiscard]] bool empty() const { return order_.empty(); }
  [[nodiscard]] const std::vector<Node>& nodes() const { return nodes_; }
  /// Mass and second moments of each node, in units; the centre is left to the reader.
  [[nodiscard]] const std::vector<kernels::FarNode>& moments() const { return moments_; }
  /// What decides whether a node is far, single precision: centre about the root's, in units.
  struct Ball {
    float x, y, z;
    float radius;
    float largestFace;
    std::int32_t left;
  };
  [[nodiscard]] const std::vector<Ball>& balls() const { return balls_; }
  /// Nodes of up to sixteen faces, in the order of their faces.
  [[nodiscard]] const std::vector<std::int32_t>& groups() const { return groups_; }
  /// Position in `members` of the k-th face of the tree.
  [[nodiscard]] const std::vector<std::int32_t>& order() const { return order_; }
  [[nodiscard]] const std::vector<kernels::SourceFace>& sources() const { return sources_; }
  /// Corner k, axis a of each face at 3 k + a, relative to its group's centre, in units.
  [[nodiscard]] const std::vector<std::array<float, 9>>& corners() const { return corners_; }
  /// Vertices of each face.
  [[nodiscard]] const std::vector<std::array<std::int32_t, 3>>& vertices() const {
    return vertices_;
  }
  /// The group of the k-th face.
  [[nodiscard]] const Node& groupOf(std::int32_t k) const {
    return nodes_[groups_[k / kernels::kLanes]];
  }

 private:
  std::vector<Node> nodes_;  // parents before children, level by level
  std::vector<kernels::FarNode> moments_;
  std::vector<Ball> balls_;
  std::vector<std::int32_t> groups_;
  std::vector<std::int32_t> order_;
  std::vector<kernels::SourceFace> sources_;
  std::vector<std::array<float, 9>> corners_;
  std::vector<std::array<std::int32_t, 3>> vertices_;
};

}  // namespace explica::repulsion
