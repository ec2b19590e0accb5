// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "ClusterTree.h"

#include "Explica/Core/Parallel.h"
#include "MovingSet.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
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
  m.second = {};
  double farthest = 0;
  for (int k = 0; k < 3; ++k) {
    const Vector d = c[k] - m.centroid;
    farthest = std::max(farthest, d.squaredNorm());
    const auto square = outer(d);
    for (int i = 0; i < 6; ++i) m.second[i] += m.area / 12 * square[i];
  }
  m.radius = std::sqrt(farthest);
  return m;
}

constexpr std::int32_t kLeafFaces = 2;
constexpr std::int32_t kBlockFaces = 8 * kernels::kLanes;
// Nodes of at most this many faces are cut to the leaves by one task each.
constexpr std::int32_t kTaskFaces = 4096;

/// Index of the first face of the right half; 0 if the node is a leaf.
std::int32_t cutOf(std::int32_t count) {
  const std::int32_t grain = count > kernels::kLanes ? kernels::kLanes : kLeafFaces;
  const std::int32_t parts = (count + grain - 1) / grain;
  return parts < 2 ? 0 : parts / 2 * grain;
}

/// Moves the keys that `chosen` holds for to the front, without branches.
/// @return how many
template <class Chosen>
std::int32_t gatherFront(Key* keys, std::int32_t count, const Chosen& chosen) {
  std::int32_t front = 0;
  for (std::int32_t i = 0; i < count; ++i) {
    const Key key = keys[i];
    keys[i] = keys[front];
    keys[front] = key;
    front += chosen(key) ? 1 : 0;
  }
  return front;
}

/// Puts the `cut` least keys along the longest side of the keys' box first; ties by member.
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

  // Only the bucket in which the cut falls is left to be selected from.
  constexpr std::int32_t kBuckets = 256;
  const std::int32_t buckets = std::min(count / 2, kBuckets);
  const float scale = static_cast<float>(buckets) / (high[axis] - low[axis]);
  if (count > kernels::kLanes && std::isfinite(scale)) {
    const auto bucketOf = [axis, scale, from = low[axis], last = buckets - 1](const Key& key) {
      return std::min(static_cast<std::int32_t>((key.centroid[axis] - from) * scale), last);
    };
    std::array<std::int32_t, kBuckets> counts;
    std::fill_n(counts.begin(), buckets, 0);
    for (std::int32_t i = 0; i < count; ++i) ++counts[bucketOf(keys[i])];
    std::int32_t bucket = 0;
    std::int32_t before = 0;
    while (before + counts[bucket] <= cut) before += counts[bucket++];
    gatherFront(keys, count, [&](const Key& key) { return bucketOf(key) < bucket; });
    keys += before;
    gatherFront(keys, count - before, [&](const Key& key) { return bucketOf(key) == bucket; });
    count = counts[bucket];
    cut -= before;
  }
  std::nth_element(keys, keys + cut, keys + count, [axis](const Key& l, const Key& r) {
    return l.centroid[axis] != r.centroid[axis] ? l.centroid[axis] < r.centroid[axis]
                                                : l.member < r.member;
  });
}

/// Cuts a node and all below it; the faces of a leaf end up in the order of their numbers.
void partitionBelow(Key* keys, std::int32_t count) {
  const std::int32_t cut = cutOf(count);
  if (cut == 0) {
    std::sort(keys, keys + count, [](const Key& l, const Key& r) { return l.member < r.member; });
    return;
  }
  partitionAt(keys, count, cut);
  partitionBelow(keys, cut);
  partitionBelow(keys + cut, count - cut);
}

// Distance from a target face, in radii of the largest source face, from which second moments stand
// for the extent of both.
constexpr double kCarry = 2.5;

}  // namespace

kernels::FarNode farNode(const ClusterTree::Moments& m, const std::array<double, 3>& origin) {
  kernels::FarNode node{};
  for (int a = 0; a < 3; ++a) node.centre[a] = static_cast<float>(m.centre[a] - origin[a]);
  node.mass = m.mass;
  node.xx = m.second[0];
  node.yy = m.second[1];
  node.zz = m.second[2];
  node.xy = m.second[3];
  node.xz = m.second[4];
  node.yz = m.second[5];
  return node;
}

ClusterTree::ClusterTree(const Positions& positions, const Faces& faces,
                         const std::vector<std::int32_t>& members, double unit, double opening,
                         double nearRatio) {
  const auto count = static_cast<std::int32_t>(members.size());
  if (count == 0) return;
  std::vector<Key> keys(members.size());
  parallelFor(members.size(), 4096, [&](std::size_t i) {
    const Corners c = cornersOf(positions, faces, members[i]);
    const Point centroid = (c[0] + c[1] + c[2]) / 3;
    for (int a = 0; a < 3; ++a) keys[i].centroid[a] = static_cast<float>(centroid[a]);
    keys[i].member = static_cast<std::int32_t>(i);
  });

  nodes_.reserve(static_cast<std::size_t>(count) / kLeafFaces * 3 + 2);
  Node root;
  root.count = count;
  nodes_.push_back(root);
  std::vector<std::size_t> levels = {0};
  std::vector<std::int32_t> tasks;
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
    begin = end;
    levels.push_back(end);
  }
  for (std::size_t level = 0; level + 1 < levels.size(); ++level) {
    std::vector<std::int32_t> large;
    for (std::size_t n = levels[level]; n < levels[level + 1]; ++n) {
      if (nodes_[n].count > kTaskFaces) large.push_back(static_cast<std::int32_t>(n));
    }
    if (large.empty()) break;
    parallelFor(large.size(), 1, [&](std::size_t i) {
      const Node& node = nodes_[large[i]];
      partitionAt(keys.data() + node.first, node.count, cutOf(node.count));
    });
  }
  const auto listParts = [this](std::int32_t largest, std::vector<std::int32_t>& parts) {
    const auto descend = [&](const auto& self, std::int32_t n) -> void {
      if (nodes_[n].count <= largest) {
        parts.push_back(n);
      } else {
        self(self, nodes_[n].left);
        self(self, nodes_[n].left + 1);
      }
    };
    descend(descend, 0);
  };
  listParts(kTaskFaces, tasks);
  listParts(kBlockFaces, blocks_);
  listParts(kernels::kLanes, groups_);
  parallelFor(tasks.size(), 1, [&](std::size_t i) {
    const Node& node = nodes_[tasks[i]];
    partitionBelow(keys.data() + node.first, node.count);
  });

  order_.resize(members.size());
  std::vector<FaceMoments> sorted(members.size());
  parallelFor(members.size(), 1024, [&](std::size_t i) {
    order_[i] = keys[i].member;
    sorted[i] = momentsOf(cornersOf(positions, faces, members[order_[i]]));
  });

  struct Sums {
    double mass = 0;                 // area, mm^2
    std::array<double, 6> second{};  // of the area about the centre, mm^4
  };
  std::vector<Sums> sums(nodes_.size());
  moments_.resize(nodes_.size());
  const double inverseUnit = 1 / unit;
  const double area = inverseUnit * inverseUnit;
  const auto measure = [&](std::size_t n) {
    Node& node = nodes_[n];
    Sums& m = sums[n];
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
        node.largestFace = std::max(node.largestFace, face[i].radius);
      }
    } else {
      const Node* child = nodes_.data() + node.left;
      const Sums* part = sums.data() + node.left;
      m.mass = part[0].mass + part[1].mass;
      node.centre =
          m.mass > 0
              ? Point((part[0].mass * child[0].centre + part[1].mass * child[1].centre) / m.mass)
              : Point((child[0].centre + child[1].centre) / 2);
      for (int c = 0; c < 2; ++c) {
        const auto square = outer(child[c].centre - node.centre);
        for (int k = 0; k < 6; ++k) m.second[k] += part[c].second[k] + part[c].mass * square[k];
        node.largestFace = std::max(node.largestFace, child[c].largestFace);
      }
    }
    if (node.count <= 2 * kernels::kLanes) {
      for (std::int32_t i = 0; i < node.count; ++i) {
        node.radius =
            std::max(node.radius, (face[i].centroid - node.centre).norm() + face[i].radius);
      }
    } else {  // the ball of its groups' balls
      const std::int32_t end = (node.first + node.count - 1) / kernels::kLanes;
      for (std::int32_t g = node.first / kernels::kLanes; g <= end; ++g) {
        const Node& group = nodes_[groups_[g]];
        node.radius = std::max(node.radius, (group.centre - node.centre).norm() + group.radius);
      }
    }
    Moments& moments = moments_[n];
    for (int a = 0; a < 3; ++a) moments.centre[a] = node.centre[a] * inverseUnit;
    moments.mass = static_cast<float>(m.mass * area);
    for (int k = 0; k < 6; ++k) moments.second[k] = static_cast<float>(m.second[k] * area * area);
  };
  for (std::size_t level = levels.size() - 1; level-- > 0;) {
    const std::size_t size = levels[level + 1] - levels[level];
    parallelFor(size, std::max<std::size_t>(64, size / 64),
                [&](std::size_t i) { measure(levels[level] + i); });
  }

  const auto reachOf = [&](double radius, double largest) {
    return static_cast<float>(std::max(radius / opening, kCarry * largest));
  };
  balls_.resize(nodes_.size());
  parallelFor(nodes_.size(), 4096, [&](std::size_t n) {
    const Node& node = nodes_[n];
    const Vector offset = (node.centre - nodes_[0].centre) * inverseUnit;
    const double radius = node.radius * inverseUnit;
    const double largest = node.largestFace * inverseUnit;
    Ball& ball = balls_[n];
    ball = {static_cast<float>(offset[0]),
            static_cast<float>(offset[1]),
            static_cast<float>(offset[2]),
            reachOf(radius, largest),
            static_cast<float>(radius + (nearRatio - 1) * largest),
            node.count > kernels::kLanes ? node.left : -1};
  });

  sources_.resize(members.size());
  corners_.resize(members.size());
  vertices_.resize(members.size());
  groupPacks_.resize(groups_.size());
  leafPacks_.resize(4 * groups_.size());
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
    const auto set = [&](kernels::SourcePack& pack, int entry, const Point& centre, float mass,
                         const std::array<float, 6>& second, double reach) {
      pack.x[entry] = static_cast<float>((centre[0] - node.centre[0]) * inverseUnit);
      pack.y[entry] = static_cast<float>((centre[1] - node.centre[1]) * inverseUnit);
      pack.z[entry] = static_cast<float>((centre[2] - node.centre[2]) * inverseUnit);
      pack.reach[entry] = static_cast<float>(reach);
      pack.part[entry] = {mass, second[0], second[1], second[2], second[3], second[4], second[5]};
      pack.present |= 1U << entry;
    };
    const auto setNode = [&](kernels::SourcePack& pack, int entry, std::int32_t n) {
      set(pack, entry, nodes_[n].centre, moments_[n].mass, moments_[n].second,
          std::max(balls_[n].reach, balls_[n].margin));
    };
    const auto setFace = [&](kernels::SourcePack& pack, int entry, std::int32_t i) {
      std::array<float, 6> second;
      for (int k = 0; k < 6; ++k) {
        second[k] = static_cast<float>(sorted[i].second[k] * area * area);
      }
      const double radius = sorted[i].radius * inverseUnit;
      set(pack, entry, sorted[i].centroid, static_cast<float>(sorted[i].area * area), second,
          std::max<double>(reachOf(radius, radius), nearRatio * radius));
      pack.first[entry - 3] = i;
    };
    const auto partsOf = [&](std::int32_t n) {
      const std::int32_t left = nodes_[n].left;
      return left < 0 ? std::array{n, -1} : std::array{left, left + 1};
    };
    kernels::SourcePack& pack = groupPacks_[g];
    setNode(pack, 0, groups_[g]);
    const auto halves = partsOf(groups_[g]);
    for (int h = 0; h < 2 && halves[h] >= 0; ++h) {
      setNode(pack, 1 + h, halves[h]);
      const auto quarters = partsOf(halves[h]);
      for (int q = 0; q < 2 && quarters[q] >= 0; ++q) {
        const int quarter = 2 * h + q;
        setNode(pack, 3 + quarter, quarters[q]);
        pack.first[quarter] = static_cast<std::int32_t>(4 * g) + quarter;
        kernels::SourcePack& leaf = leafPacks_[4 * g + static_cast<std::size_t>(quarter)];
        setNode(leaf, 0, quarters[q]);
        const auto pairs = partsOf(quarters[q]);
        for (int p = 0; p < 2 && pairs[p] >= 0; ++p) {
          setNode(leaf, 1 + p, pairs[p]);
          const Node& pair = nodes_[pairs[p]];
          for (std::int32_t i = 0; i < pair.count; ++i) {
            setFace(leaf, 3 + 2 * p + i, pair.first + i);
          }
        }
      }
    }
  });
}

}  // namespace explica::repulsion
