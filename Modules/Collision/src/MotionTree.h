// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Types.h"
#include "Explica/Geometry/FaceTree.h"

#include <algorithm>
#include <array>
#include <vector>

namespace explica::collision {

/// Where points start and how they move: all of them begin in `start`, pass `swept` only, and have
/// motions within `deviation` of `mean`.
struct MovingBox {
  geometry::Box start;
  geometry::Box swept;
  Vector mean = Vector::Zero();
  double deviation = 0;  ///< mm per unit time

  /// True if points of the two may come within `reach` of each other at some time in [0, 1].
  ///
  /// Swept boxes alone do not tell neighbours that move together apart; the boxes of the start less
  /// the bound on relative motion do.
  [[nodiscard]] bool mayMeet(const MovingBox& other, double reach) const {
    for (int k = 0; k < 3; ++k) {
      if (swept.min()[k] - reach > other.swept.max()[k]) return false;
      if (other.swept.min()[k] - reach > swept.max()[k]) return false;
    }
    double squared = 0;
    for (int k = 0; k < 3; ++k) {
      const double gap = std::max(
          {0.0, start.min()[k] - other.start.max()[k], other.start.min()[k] - start.max()[k]});
      squared += gap * gap;
    }
    constexpr double kRoundUp = 1 + 1e-12;
    const double bound =
        kRoundUp * (reach + (mean - other.mean).norm() + deviation + other.deviation);
    return squared <= bound * bound;
  }

  void extend(const MovingBox& other);
};

/// Of the vertices listed in `row`, anything with size() and [].
template <class Row>
MovingBox movingBox(const Row& row, const Positions& start, const Positions& motion) {
  MovingBox box;
  for (Eigen::Index k = 0; k < row.size(); ++k) {
    const Point p = start.row(row[k]).transpose();
    const Vector along = motion.row(row[k]).transpose();
    box.start.extend(p);
    box.swept.extend(p);
    box.swept.extend(Point(p + along));
    box.mean += along / static_cast<double>(row.size());
  }
  for (Eigen::Index k = 0; k < row.size(); ++k) {
    box.deviation =
        std::max(box.deviation, (motion.row(row[k]).transpose() - box.mean).norm() * (1 + 1e-15));
  }
  return box;
}

/// Hierarchy over moving boxes, by where they start.
class MotionTree {
 public:
  MotionTree() = default;
  explicit MotionTree(std::vector<MovingBox> items);

  /// Calls visit(item) for every item that may meet `box` within `reach`, in tree order.
  template <class Visit>
  void visitMeetings(const MovingBox& box, double reach, const Visit& visit) const {
    const auto& nodes = tree_.nodes();
    if (nodes.empty()) return;
    std::array<std::int32_t, geometry::BoxTree::kStackDepth> stack;
    int depth = 0;
    stack[depth++] = 0;
    while (depth > 0) {
      const std::int32_t at = stack[--depth];
      if (!nodeBoxes_[at].mayMeet(box, reach)) continue;
      const geometry::BoxTree::Node& node = nodes[at];
      if (node.count > 0) {
        for (std::int32_t n = node.first; n < node.first + node.count; ++n) {
          const std::int32_t item = tree_.items()[n];
          if (items_[item].mayMeet(box, reach)) visit(item);
        }
      } else {
        stack[depth++] = node.left + 1;
        stack[depth++] = node.left;
      }
    }
  }

 private:
  std::vector<MovingBox> items_;
  geometry::BoxTree tree_;
  std::vector<MovingBox> nodeBoxes_;
};

}  // namespace explica::collision
