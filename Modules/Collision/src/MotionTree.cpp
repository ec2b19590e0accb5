// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "MotionTree.h"

namespace explica::collision {

void MovingBox::extend(const MovingBox& other) {
  if (other.start.isEmpty()) return;
  if (start.isEmpty()) {
    *this = other;
    return;
  }
  start.extend(other.start);
  swept.extend(other.swept);
  // Smallest ball about both balls of motions.
  const Vector apart = other.mean - mean;
  const double distance = apart.norm();
  if (distance + other.deviation <= deviation) return;
  if (distance + deviation <= other.deviation) {
    mean = other.mean;
    deviation = other.deviation;
    return;
  }
  constexpr double kRoundUp = 1 + 1e-14;
  const double radius = 0.5 * (distance + deviation + other.deviation);
  mean += (radius - deviation) / distance * apart;
  deviation = radius * kRoundUp;
}

MotionTree::MotionTree(std::vector<MovingBox> items) : items_(std::move(items)) {
  std::vector<geometry::Box> starts;
  starts.reserve(items_.size());
  for (const MovingBox& item : items_) starts.push_back(item.start);
  tree_ = geometry::BoxTree(starts);
  const auto& nodes = tree_.nodes();
  nodeBoxes_.resize(nodes.size());
  for (std::size_t n = nodes.size(); n-- > 0;) {  // children stand after their parent
    const auto& node = nodes[n];
    if (node.count > 0) {
      for (std::int32_t i = node.first; i < node.first + node.count; ++i) {
        nodeBoxes_[n].extend(items_[tree_.items()[i]]);
      }
    } else {
      nodeBoxes_[n].extend(nodeBoxes_[node.left]);
      nodeBoxes_[n].extend(nodeBoxes_[node.left + 1]);
    }
  }
}

}  // namespace explica::collision
