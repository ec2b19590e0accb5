// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/TriangleMesh.h"
#include "Explica/Repulsion/PairIntegral.h"

#include <array>
#include <span>
#include <vector>

namespace explica::repulsion {

/// Faces seen as one from afar.
struct Cluster {
  Point centre = Point::Zero();                      ///< centroid of the area, mm
  double area = 0;                                   ///< mm^2
  Eigen::Matrix3d second = Eigen::Matrix3d::Zero();  ///< of the area about the centre, mm^4
  double radius = 0;       ///< of a ball about the centre that holds the faces, mm
  double largestFace = 0;  ///< radius of the largest face, mm
};

/// Some of a mesh's faces in a binary tree, each node with its moments.  Nodes are cut next to the
/// median across the longest side of their centroids' box, above a group at a multiple of its size,
/// so that all groups but the last are full.
struct ClusterTree {
  struct Node {
    std::int32_t first = 0;  ///< its faces are first .. first + count in the tree's order
    std::int32_t count = 0;
    std::int32_t left = -1;  ///< children are left and left + 1; -1 for a leaf
  };

  ClusterTree(const Positions& positions, const Faces& meshFaces,
              const std::vector<std::int32_t>& members, int groupSize);

  /// The faces of a node, each as a cluster of one.
  [[nodiscard]] std::span<const Cluster> facesOf(const Node& node) const {
    return std::span(faces).subspan(node.first, node.count);
  }

  std::vector<std::int32_t> order;           ///< place in `members` of the k-th face
  std::vector<std::array<Point, 3>> points;  ///< of each face, half way from centroid to corners:
                                             ///< they have its area, centroid and second moments
  std::vector<Cluster> faces;                ///< in the tree's order
  std::vector<Node> nodes;                   ///< parents before children
  std::vector<Cluster> clusters;             ///< of each node
  std::vector<std::int32_t> groups;  ///< largest nodes of at most `groupSize` faces, in order

 private:
  void cut(std::int32_t n, const std::vector<Cluster>& faceOf, int groupSize);
};

}  // namespace explica::repulsion
