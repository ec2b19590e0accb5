// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "ClusterTree.h"

#include "Explica/Core/Parallel.h"
#include "MovingSet.h"

#include <algorithm>
#include <numeric>

namespace explica::repulsion {
namespace {

constexpr std::int32_t kLeafFaces = 2;

Cluster clusterOf(const Corners& c) {
  Cluster face;
  face.centre = (c[0] + c[1] + c[2]) / 3;
  face.area = faceArea(c).area;
  for (const Point& corner : c) {
    const Vector offset = corner - face.centre;
    face.second += face.area / 12 * offset * offset.transpose();
    face.radius = std::max(face.radius, offset.norm());
  }
  face.largestFace = face.radius;
  return face;
}

Cluster joined(std::span<const Cluster> parts) {
  Cluster sum;
  Point moment = Point::Zero(), mean = Point::Zero();
  for (const Cluster& part : parts) {
    sum.area += part.area;
    moment += part.area * part.centre;
    mean += part.centre / static_cast<double>(parts.size());
    sum.largestFace = std::max(sum.largestFace, part.largestFace);
  }
  sum.centre = sum.area > 0 ? Point(moment / sum.area) : mean;
  for (const Cluster& part : parts) {
    const Vector offset = part.centre - sum.centre;
    sum.second += part.second + part.area * offset * offset.transpose();
  }
  return sum;
}

}  // namespace

ClusterTree::ClusterTree(const Positions& positions, const Faces& meshFaces,
                         const std::vector<std::int32_t>& members, int groupSize)
    : order(members.size()) {
  if (members.empty()) return;
  std::vector<Cluster> faceOf(members.size());
  parallelFor(members.size(), [&](std::size_t i) {
    faceOf[i] = clusterOf(cornersOf(positions, meshFaces, members[i]));
  });
  std::iota(order.begin(), order.end(), 0);
  nodes.push_back({0, static_cast<std::int32_t>(members.size())});
  cut(0, faceOf, groupSize);

  for (const std::int32_t i : order) {
    faces.push_back(faceOf[i]);
    const Corners c = cornersOf(positions, meshFaces, members[i]);
    const Point m = faceOf[i].centre;
    points.push_back({(m + c[0]) / 2, (m + c[1]) / 2, (m + c[2]) / 2});
  }
  clusters.resize(nodes.size());
  for (std::size_t n = nodes.size(); n-- > 0;) {
    const Node& node = nodes[n];
    clusters[n] = joined(node.left < 0 ? facesOf(node) : std::span(clusters).subspan(node.left, 2));
  }
  parallelFor(nodes.size(), 64, [&](std::size_t n) {
    Cluster& cluster = clusters[n];
    for (const Cluster& face : facesOf(nodes[n])) {
      cluster.radius =
          std::max(cluster.radius, (face.centre - cluster.centre).norm() + face.radius);
    }
  });
}

void ClusterTree::cut(std::int32_t n, const std::vector<Cluster>& faceOf, int groupSize) {
  const auto [first, count, none] = nodes[n];
  if (count <= groupSize && first == groupSize * static_cast<std::int32_t>(groups.size())) {
    groups.push_back(n);
  }
  if (count <= kLeafFaces) return;
  const std::int32_t grain = count > groupSize ? groupSize : kLeafFaces;
  const std::int32_t half = (count + grain - 1) / grain / 2 * grain;
  const auto begin = order.begin() + first, end = begin + count;
  Eigen::AlignedBox3d box;
  for (auto i = begin; i != end; ++i) box.extend(faceOf[*i].centre);
  Eigen::Index axis = 0;
  box.sizes().maxCoeff(&axis);
  std::nth_element(begin, begin + half, end, [&](std::int32_t a, std::int32_t b) {
    return std::pair(faceOf[a].centre[axis], a) < std::pair(faceOf[b].centre[axis], b);
  });
  const auto left = static_cast<std::int32_t>(nodes.size());
  nodes[n].left = left;
  nodes.push_back({first, half});
  nodes.push_back({first + half, count - half});
  cut(left, faceOf, groupSize);
  cut(left + 1, faceOf, groupSize);
}

}  // namespace explica::repulsion
