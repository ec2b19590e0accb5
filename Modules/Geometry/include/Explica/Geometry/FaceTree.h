// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/TriangleMesh.h"

#include <Eigen/Geometry>

#include <array>
#include <functional>
#include <vector>

namespace explica::geometry {

using Box = Eigen::AlignedBox3d;

/// Nearest point of a surface.
struct ClosestPoint {
  Point point = Point::Constant(kNaN);
  std::int32_t face = -1;
  double squaredDistance = kInfinity;  ///< mm^2
};

/// Bounding-volume hierarchy over boxes, built once; for faces, edges or anything that has a box.
class BoxTree {
 public:
  /// Nodes that wait while a walk from the root goes down: one a level, and 2^31 items need 31.
  static constexpr int kStackDepth = 64;

  BoxTree() = default;
  /// Builds over `boxes`; item i is boxes[i].  O(n log n).
  explicit BoxTree(const std::vector<Box>& boxes);

  /// Calls visit(item) for every item whose box overlaps `box` (touching counts), in tree order.
  void forOverlaps(const Box& box, const std::function<void(std::int32_t item)>& visit) const;

  /// All pairs i < j of items whose boxes overlap, sorted.  Threaded; deterministic.
  [[nodiscard]] std::vector<std::array<std::int32_t, 2>> overlappingPairs() const;

  /// New boxes for the same items: keeps the hierarchy, updates its boxes.
  void refit(const std::vector<Box>& boxes);

  /// One node: children are `left` and `left + 1`; a leaf has count > 0 items from `first`.
  struct Node {
    Box box;
    std::int32_t left = -1;
    std::int32_t first = 0;
    std::int32_t count = 0;
  };
  [[nodiscard]] const std::vector<Node>& nodes() const { return nodes_; }
  [[nodiscard]] const std::vector<std::int32_t>& items() const { return items_; }
  [[nodiscard]] const std::vector<Box>& boxes() const { return boxes_; }

 private:
  std::vector<Node> nodes_;
  std::vector<std::int32_t> items_;
  std::vector<Box> boxes_;
};

/// Eight boxes side by side, for vector arithmetic: single precision, rounded outwards.
struct alignas(64) BoxBlock {
  static constexpr int kLanes = 8;
  float lower[3][kLanes], upper[3][kLanes];
};

/// Hierarchy over a mesh's faces, eight to a node, with distance queries.  Keeps a copy of the
/// mesh.
class FaceTree {
 public:
  explicit FaceTree(TriangleMesh mesh);

  /// Of faces that are equally near, to the last bit, the first.
  [[nodiscard]] ClosestPoint closestPoint(const Point& query) const;
  /// The same, looking at face `near` first: the sooner done, the nearer that is.
  [[nodiscard]] ClosestPoint closestPoint(const Point& query, std::int32_t near) const;
  [[nodiscard]] const TriangleMesh& mesh() const { return mesh_; }

 private:
  [[nodiscard]] ClosestPoint nearerThan(ClosestPoint best, const Point& query) const;
  void fillLevels();

  TriangleMesh mesh_;
  Point origin_ = Point::Zero();
  double perMm_ = 1;                           ///< boxes count in half sizes of the mesh
  std::vector<std::int32_t> items_;            ///< faces in the order of level 0's lanes
  std::vector<std::array<Point, 3>> corners_;  ///< theirs
  /// Lane n of the level above bounds block n of a level.
  std::vector<std::vector<BoxBlock>> levels_;
};

/// Boxes of a mesh's faces, widened by `margin` mm on every side.
[[nodiscard]] std::vector<Box> faceBoxes(const TriangleMesh& mesh, double margin = 0);

/// A face at each vertex, the last of them; 0 where there is none.
[[nodiscard]] std::vector<std::int32_t> faceOfEachVertex(const TriangleMesh& mesh);

/// Nearest point of the triangle (a, b, c) to q.
[[nodiscard]] Point closestPointOnTriangle(const Point& q, const Point& a, const Point& b,
                                           const Point& c);

}  // namespace explica::geometry
