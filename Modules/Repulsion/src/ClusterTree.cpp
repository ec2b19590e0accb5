// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "ClusterTree.h"

#include "Explica/Core/Parallel.h"
#include "MovingSet.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

namespace explica::repulsion {
namespace {

struct Key {
  std::array<float, 3> centroid;
  std::int32_t member;
};

struct FaceMoments {
  Point centroid;
  double area;
  double radius;
  std::array<double, 6> second;
};

std::array<double, 6> outer(const Vector& d) {
  return {d.x() * d.x(), d.y() * d.y(), d.z() * d.z(), d.x() * d.y(), d.x() * d.z(), d.y() * d.z()};
}

FaceMoments momentsOf(const Corners& c) {
  FaceMoments m;
  m.centroid = (c[0] + c[1] + c[2]) / 3;
  m.area = (c[1] - c[0]).cross(c[2] - c[0]).norm() / 2;
  m.radius = 0;
  m.second = {};
  for (int k = 0; k < 3; ++k) {
    const Vector d = c[k] - m.centroid;
    m.radius = std::max(m.radius, d.norm());
    const auto square = outer(d);
    for (int i = 0; i < 6; ++i) m.second[i] += m.area / 12 * square[i];
  }
  return m;
}

constexpr std::int32_t kLeafFaces = 4;

/// Index of the first face of the right half; 0 if the node is a leaf.
std::int32_t cutOf(std::int32_t count) {
  const std::int32_t grain = count > kernels::kLanes ? kernels::kLanes : kLeafFaces;
  const std::int32_t parts = (count + grain - 1) / grain;
  return parts < 2 ? 0 : parts / 2 * grain;
}

void partitionAt(Key* keys, std::int32_t count, std::int32_t cut) {
  std::array<float, 3> low = keys[0].centroid;
  std::array<float, 3> high = low;
  for (std::int32_t i = 1; i < count; ++i) {
    for (int a = 0; a < 3; ++a) {
      low[a] = std::min(low[a], keys[i].centroid[a]);
      high[a] = std::max(high[a], keys[i].centroid[a]);
    }
  }
  int axis = 0;
  for (int a = 1; a < 3; ++a) {
    if (high[a] - low[a] > high[axis] - low[axis]) axis = a;
  }
  std::nth_element(keys, keys + cut, keys + count, [axis](const Key& l, const Key& r) {
    return l.centroid[axis] != r.centroid[axis] ? l.centroid[axis] < r.centroid[axis]
                                                : l.member < r.member;
  });
}

}  // namespace

ClusterTree::ClusterTree(const Positions& positions, const Faces& faces,
                         const std::vector<std::int32_t>& members, double unit) {
  const auto count = static_cast<std::int32_t>(members.size());
  if (count == 0) return;
  std::vector<FaceMoments> faceMoments(members.size());
  std::vector<Key> keys(members.size());
  parallelFor(members.size(), 1024, [&](std::size_t i) {
    faceMoments[i] = momentsOf(cornersOf(positions, faces, members[i]));
    for (int a = 0; a < 3; ++a) {
      keys[i].centroid[a] = static_cast<float>(faceMoments[i].centroid[a]);
    }
    keys[i].member = static_cast<std::int32_t>(i);
  });

  nodes_.reserve(static_cast<std::size_t>(count) / kLeafFaces * 2 + 2);
  Node root;
  root.count = count;
  nodes_.push_back(root);
  std::vector<std::size_t> levels = {0};
  for (std::size_t begin = 0; begin < nodes_.size();) {
    const std::size_t end = nodes_.size();
    for (std::size_t n = begin; n < end; ++n) {
      const std::int32_t cut = cutOf(nodes_[n].count);
      if (cut == 0) continue;
      nodes_[n].left = static_cast<std::int32_t>(nodes_.size());
      Node left;
      left.first = nodes_[n].first;
      left.count = cut;
      Node right;
      right.first = nodes_[n].first + cut;
      right.count = nodes_[n].count - cut;
      nodes_.push_back(left);
      nodes_.push_back(right);
    }
    parallelFor(end - begin, std::max<std::size_t>(1, (end - begin) / 64), [&](std::size_t i) {
      const Node& node = nodes_[begin + i];
      const std::int32_t cut = cutOf(node.count);
      if (cut > 0) partitionAt(keys.data() + node.first, node.count, cut);
    });
    begin = end;
    levels.push_back(end);
  }

  order_.resize(members.size());
  std::vector<FaceMoments> sorted(members.size());
  parallelFor(members.size(), 1024, [&](std::size_t i) {
    order_[i] = keys[i].member;
    sorted[i] = faceMoments[keys[i].member];
  });

  struct Moments {
    double mass = 0;                 // area, mm^2
    std::array<double, 6> second{};  // xx, yy, zz, xy, xz, yz of the area about the centre, mm^4
  };
  std::vector<Moments> moments(nodes_.size());
  moments_.resize(nodes_.size());
  const auto measure = [&](std::size_t n) {
    Node& node = nodes_[n];
    Moments& m = moments[n];
    const FaceMoments* face = sorted.data() + node.first;
    if (node.isLeaf()) {
      Point mean = Point::Zero();
      for (std::int32_t i = 0; i < node.count; ++i) {
        m.mass += face[i].area;
        node.centre += face[i].area * face[i].centroid;
        mean += face[i].centroid;
      }
      node.centre = m.mass > 0 ? Point(node.centre / m.mass) : Point(mean / node.count);
      for (std::int32_t i = 0; i < node.count; ++i) {
        const auto square = outer(face[i].centroid - node.centre);
        for (int k = 0; k < 6; ++k) m.second[k] += face[i].second[k] + face[i].area * square[k];
      }
    } else {
      const Node* child = nodes_.data() + node.left;
      const Moments* part = moments.data() + node.left;
      m.mass = part[0].mass + part[1].mass;
      node.centre =
          m.mass > 0
              ? Point((part[0].mass * child[0].centre + part[1].mass * child[1].centre) / m.mass)
              : Point((child[0].centre + child[1].centre) / 2);
      for (int c = 0; c < 2; ++c) {
        const auto square = outer(child[c].centre - node.centre);
        for (int k = 0; k < 6; ++k) m.second[k] += part[c].second[k] + part[c].mass * square[k];
      }
    }
    for (std::int32_t i = 0; i < node.count; ++i) {
      node.radius = std::max(node.radius, (face[i].centroid - node.centre).norm() + face[i].radius);
      node.largestFace = std::max(node.largestFace, face[i].radius);
    }
    const double area = 1 / (unit * unit);
    const auto second = [&](int k) { return static_cast<float>(m.second[k] * area * area); };
    moments_[n] = {{0, 0, 0},
                   static_cast<float>(m.mass * area),
                   second(0),
                   second(1),
                   second(2),
                   second(3),
                   second(4),
                   second(5),
                   second(0) + second(1) + second(2)};
  };
  for (std::size_t level = levels.size() - 1; level-- > 0;) {
    const std::size_t size = levels[level + 1] - levels[level];
    parallelFor(size, std::max<std::size_t>(1, size / 64),
                [&](std::size_t i) { measure(levels[level] + i); });
  }

  balls_.resize(nodes_.size());
  parallelFor(nodes_.size(), 4096, [&](std::size_t n) {
    const Vector offset = (nodes_[n].centre - nodes_[0].centre) / unit;
    balls_[n] = {static_cast<float>(offset[0]),
                 static_cast<float>(offset[1]),
                 static_cast<float>(offset[2]),
                 static_cast<float>(nodes_[n].radius / unit),
                 static_cast<float>(nodes_[n].largestFace / unit),
                 nodes_[n].left};
  });

  for (std::size_t n = 0; n < nodes_.size(); ++n) {
    const Node& node = nodes_[n];
    const bool ends = node.count == kernels::kLanes || node.first + node.count == count;
    if (node.first % kernels::kLanes == 0 && node.count <= kernels::kLanes && ends) {
      groups_.push_back(static_cast<std::int32_t>(n));
    }
  }
  std::sort(groups_.begin(), groups_.end(),
            [&](std::int32_t a, std::int32_t b) { return nodes_[a].first < nodes_[b].first; });

  sources_.resize(members.size());
  corners_.resize(members.size());
  vertices_.resize(members.size());
  parallelFor(groups_.size(), 32, [&](std::size_t g) {
    const Node& node = nodes_[groups_[g]];
    for (std::int32_t i = node.first; i < node.first + node.count; ++i) {
      const std::int32_t face = members[order_[i]];
      const Corners c = cornersOf(positions, faces, face);
      for (int k = 0; k < 3; ++k) {
        vertices_[i][k] = faces(face, k);
        for (int a = 0; a < 3; ++a) {
          corners_[i][3 * k + a] = static_cast<float>((c[k][a] - node.centre[a]) / unit);
        }
      }
      kernels::SourceFace& source = sources_[i];
      const Vector middle = (sorted[i].centroid - node.centre) / unit;
      for (int a = 0; a < 3; ++a) {
        source.centroid[a] = static_cast<float>(middle[a]);
        for (int q = 0; q < 3; ++q) {
          const double x = (sorted[i].centroid[a] + c[q][a]) / 2 - node.centre[a];
          source.point[q][a] = static_cast<float>(x / unit);
        }
      }
      for (auto& point : source.point) {
        point[3] = static_cast<float>(sorted[i].area / 3 / (unit * unit));
      }
      source.radius = static_cast<float>(sorted[i].radius / unit);
    }
  });
}

}  // namespace explica::repulsion
