// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/TriangleMesh.h"
#include "Kernels.h"

#include <array>
#include <vector>

namespace explica::repulsion {

/// Binary tree over faces with the moments of their area.  Each cut runs across the longest side of
/// the centroids' box, at a multiple of sixteen faces next to the median, so that all leaves but
/// the last are full.
class ClusterTree {
 public:
  struct Node {
    Point centre = Point::Zero();    ///< centroid of the area, mm
    double mass = 0;                 ///< area, mm^2
    std::array<double, 6> second{};  ///< xx, yy, zz, xy, xz, yz of the area about the centre, mm^4
    double radius = 0;               ///< of the ball about the centre that holds the faces, mm
    double largestFace = 0;          ///< largest distance of a face's corner from its centroid, mm
    std::int32_t first = 0;          ///< its faces are first .. first + count of the tree's order
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
  [[nodiscard]] const std::vector<std::int32_t>& leaves() const { return leaves_; }
  /// Position in `members` of the k-th face of the tree.
  [[nodiscard]] const std::vector<std::int32_t>& order() const { return order_; }
  [[nodiscard]] const std::vector<kernels::SourceFace>& sources() const { return sources_; }
  /// Corner k, axis a of each face at 3 k + a, relative to its leaf's centre, in units.
  [[nodiscard]] const std::vector<std::array<float, 9>>& corners() const { return corners_; }
  /// Vertices of each face.
  [[nodiscard]] const std::vector<std::array<std::int32_t, 3>>& vertices() const {
    return vertices_;
  }
  /// The leaf of the k-th face.
  [[nodiscard]] const Node& leafOf(std::int32_t k) const {
    return nodes_[leaves_[k / kernels::kLanes]];
  }

 private:
  std::vector<Node> nodes_;  // parents before children, level by level
  std::vector<std::int32_t> leaves_;
  std::vector<std::int32_t> order_;
  std::vector<kernels::SourceFace> sources_;
  std::vector<std::array<float, 9>> corners_;
  std::vector<std::array<std::int32_t, 3>> vertices_;
};

}  // namespace explica::repulsion
