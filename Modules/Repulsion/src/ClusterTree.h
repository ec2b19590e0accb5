// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/TriangleMesh.h"
#include "Kernels.h"

#include <array>
#include <vector>

namespace explica::repulsion {

/// What a face is sorted by.
struct FaceKey {
  std::array<float, 3> centroid;
  std::int32_t member;
};

/// Faces seen as one.
struct ClusterSum {
  Point centre = Point::Zero();    ///< centroid of the area, mm
  double area = 0;                 ///< mm^2
  std::array<double, 6> second{};  ///< xx, yy, zz, xy, xz, yz of the area about the centre, mm^4
  double radius = 0;               ///< of the ball about the centre that holds the faces, mm
  double largestFace = 0;          ///< largest distance of a face's corner from its centroid, mm
};

class SourcePacker;

/// Binary tree over faces, down to groups of sixteen, with the moments of their area.  Each cut
/// runs across the longest side of the centroids' box, next to the median: at a multiple of sixteen
/// faces, so that all groups but the last are full, and within a group at a multiple of two.
class ClusterTree {
 public:
  struct Node {
    Point centre = Point::Zero();  ///< centroid of the area, mm
    double radius = 0;             ///< of the ball about the centre that holds the faces, mm
    double largestFace = 0;        ///< largest distance of a face's corner from its centroid, mm
    std::int32_t first = 0;        ///< its faces are first .. first + count of the tree's order
    std::int32_t count = 0;
    std::int32_t left = -1;  ///< children are left and left + 1; -1 for a group

    [[nodiscard]] bool isGroup() const { return left < 0; }
  };

  /// What a node acts by from afar: centre about the origin, everything in units.
  struct Moments {
    std::array<double, 3> centre;
    float mass;
    std::array<float, 6> second;  ///< xx, yy, zz, xy, xz, yz of the area about the centre
  };
  /// What decides whether a node is far, single precision: centre about the root's, in units.
  struct Ball {
    float x, y, z;
    float reach;        ///< distance from the targets from which its moments are enough
    float margin;       ///< its radius and what `nearRatio` adds to its largest face's
    std::int32_t left;  ///< -1 for groups
  };

  /// A tree over no faces.
  ClusterTree() = default;
  /// Builds the tree, in the memory of the one before.
  /// @param unit       lengths are in multiples of it unless said otherwise, mm
  /// @param opening    share of the distance up to which a node's radius may be for it to act as
  /// one
  /// @param nearRatio  faces are near whose centroids are nearer than this many sums of radii
  void build(const Positions& positions, const Faces& faces,
             const std::vector<std::int32_t>& members, double unit, double opening,
             double nearRatio);

  [[nodiscard]] bool empty() const { return order_.empty(); }
  [[nodiscard]] const std::vector<Node>& nodes() const { return nodes_; }
  [[nodiscard]] const std::vector<Moments>& moments() const { return moments_; }
  [[nodiscard]] const std::vector<Ball>& balls() const { return balls_; }
  /// Each group with its parts of at least about four faces.
  [[nodiscard]] const std::vector<kernels::SourcePack>& groupPacks() const { return groupPacks_; }
  /// The quarters of the k-th group at 4 k, with their parts.
  [[nodiscard]] const std::vector<kernels::SourcePack>& leafPacks() const { return leafPacks_; }
  /// Nodes of up to sixteen faces, in the order of their faces.
  [[nodiscard]] const std::vector<std::int32_t>& groups() const { return groups_; }
  /// Nodes of up to four groups, in the order of their faces.
  [[nodiscard]] const std::vector<std::int32_t>& blocks() const { return blocks_; }
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
  /// Cuts the faces into nodes by count alone; the first node of each level, and one more.
  [[nodiscard]] std::vector<std::size_t> cutNodes(std::int32_t count);
  /// Nodes of at most `largest` faces whose parents are larger, in the order of their faces.
  [[nodiscard]] std::vector<std::int32_t> partsOf(std::int32_t largest) const;
  /// Sorts the keys until each lies in its node.
  void sortKeys(const std::vector<std::size_t>& levels);
  void packGroup(std::size_t group, const Positions& positions, const Faces& faces,
                 const std::vector<std::int32_t>& members, const SourcePacker& packer);
  /// Sums of the nodes above the groups, from those of the groups.
  void mergeSums(const std::vector<std::size_t>& levels);
  void writeMoments(const SourcePacker& packer, double unit);

  std::vector<FaceKey> keys_;
  std::vector<ClusterSum> sums_;  // of each node
  std::vector<Node> nodes_;       // parents before children, level by level
  std::vector<Moments> moments_;
  std::vector<Ball> balls_;
  std::vector<kernels::SourcePack> groupPacks_;
  std::vector<kernels::SourcePack> leafPacks_;
  std::vector<std::int32_t> groups_;
  std::vector<std::int32_t> blocks_;
  std::vector<std::int32_t> order_;
  std::vector<kernels::SourceFace> sources_;
  std::vector<std::array<float, 9>> corners_;
  std::vector<std::array<std::int32_t, 3>> vertices_;
};

/// A node as seen from `origin`, in units.
[[nodiscard]] kernels::FarNode farNode(const ClusterTree::Moments& moments,
                                       const std::array<double, 3>& origin);

}  // namespace explica::repulsion
