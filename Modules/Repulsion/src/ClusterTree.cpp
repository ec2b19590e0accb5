// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "ClusterTree.h"

#include "Explica/Core/Parallel.h"

#include <algorithm>
#include <cmath>

namespace explica::repulsion {
namespace {

struct FaceMoments {
  Corners corners;
  Point centroid;
  double area;
};

/// Puts the lower half along the longest side of the centroids' box first; ties by number.
void halve(const std::vector<FaceMoments>& faces, std::int32_t* first, std::int32_t count) {
  Eigen::Array3d low = Eigen::Array3d::Constant(kInfinity), high = -low;
  for (std::int32_t n = 0; n < count; ++n) {
    low = low.min(faces[first[n]].centroid.array());
    high = high.max(faces[first[n]].centroid.array());
  }
  Eigen::Index axis = 0;
  (high - low).maxCoeff(&axis);
  std::nth_element(first, first + count / 2, first + count, [&](std::int32_t l, std::int32_t r) {
    const double a = faces[l].centroid[axis], b = faces[r].centroid[axis];
    return a != b ? a < b : l < r;
  });
}

/// The second moments of a triangle are a twelfth of its area times those of its corners.
void sum(const std::vector<FaceMoments>& faces, const std::int32_t* first, Cluster& cluster) {
  Point mean = Point::Zero();
  for (std::int32_t n = 0; n < cluster.count; ++n) {
    const FaceMoments& face = faces[first[n]];
    cluster.area += face.area;
    cluster.centre += face.area * face.centroid;
    mean += face.centroid;
  }
  cluster.centre =
      cluster.area > 0 ? Point(cluster.centre / cluster.area) : Point(mean / cluster.count);
  double farthest = 0;
  for (std::int32_t n = 0; n < cluster.count; ++n) {
    const FaceMoments& face = faces[first[n]];
    const Vector offset = face.centroid - cluster.centre;
    cluster.second += face.area * offset * offset.transpose();
    for (const Point& corner : face.corners) {
      const Vector arm = corner - face.centroid;
      cluster.second += face.area / 12 * arm * arm.transpose();
      farthest = std::max(farthest, (corner - cluster.centre).squaredNorm());
    }
  }
  cluster.radius = std::sqrt(farthest);
}

}  // namespace

ClusterTree::ClusterTree(const Positions& positions, const Faces& faces,
                         std::vector<std::int32_t> members)
    : members_(std::move(members)) {
  if (members_.empty()) return;
  std::vector<FaceMoments> moments(members_.size());
  std::vector<std::int32_t> order(members_.size());
  for (std::size_t n = 0; n < order.size(); ++n) {
    const Corners c = cornersOf(positions, faces, members_[n]);
    moments[n] = {c, (c[0] + c[1] + c[2]) / 3, areaGradient(c).area};
    order[n] = static_cast<std::int32_t>(n);
  }
  nodes_.reserve(2 * members_.size());
  nodes_.emplace_back().count = static_cast<std::int32_t>(members_.size());
  for (std::size_t n = 0; n < nodes_.size(); ++n) {
    if (nodes_[n].count == 1) continue;
    const std::int32_t first = nodes_[n].first, count = nodes_[n].count, half = count / 2;
    halve(moments, order.data() + first, count);
    nodes_[n].left = static_cast<std::int32_t>(nodes_.size());
    for (const bool right : {false, true}) {
      Cluster& child = nodes_.emplace_back();
      child.first = right ? first + half : first;
      child.count = right ? count - half : half;
    }
  }
  constexpr std::size_t kGrain = 64;  // nodes a task
  parallelFor(nodes_.size(), kGrain,
              [&](std::size_t n) { sum(moments, order.data() + nodes_[n].first, nodes_[n]); });
  for (std::int32_t& n : order) n = members_[n];
  members_ = std::move(order);
}

}  // namespace explica::repulsion
