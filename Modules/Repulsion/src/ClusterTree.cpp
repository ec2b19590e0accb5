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

using Key = FaceKey;
using Part = ClusterSum;

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

constexpr std::int32_t kLeafFaces = 2;                     // in the smallest leaves
constexpr std::int32_t kBlockFaces = 8 * kernels::kLanes;  // eight rows of lanes
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

Part partOf(const FaceMoments* faces, std::int32_t count) {
  Part part;
  Point mean = Point::Zero();
  for (std::int32_t i = 0; i < count; ++i) {
    part.area += faces[i].area;
    part.centre += faces[i].area * faces[i].centroid;
    mean += faces[i].centroid;
    part.largestFace = std::max(part.largestFace, faces[i].radius);
  }
  part.centre = part.area > 0 ? Point(part.centre / part.area) : Point(mean / count);
  for (std::int32_t i = 0; i < count; ++i) {
    const Vector offset = faces[i].centroid - part.centre;
    const auto square = outer(offset);
    for (int k = 0; k < 6; ++k) {
      part.second[k] += faces[i].second[k] + faces[i].area * square[k];
    }
    part.radius = std::max(part.radius, offset.norm() + faces[i].radius);
  }
  return part;
}

/// Both parts, but for the radius.
Part merged(const Part& a, const Part& b) {
  Part part;
  part.area = a.area + b.area;
  part.centre = part.area > 0 ? Point((a.area * a.centre + b.area * b.centre) / part.area)
                              : Point((a.centre + b.centre) / 2);
  part.largestFace = std::max(a.largestFace, b.largestFace);
  for (const Part* child : {&a, &b}) {
    const auto square = outer(child->centre - part.centre);
    for (int k = 0; k < 6; ++k) part.second[k] += child->second[k] + child->area * square[k];
  }
  return part;
}

}  // namespace

/// Writes groups of faces as the kernels read them.
class SourcePacker {
 public:
  SourcePacker(double unit, double opening, double nearRatio)
      : inverseUnit_(1 / unit),
        inverseOpening_(1 / opening),
        nearRatio_(nearRatio),
        inverseArea_(inverseUnit_ * inverseUnit_) {}

  /// Distance from the targets from which the moments of a part are enough, in units.
  [[nodiscard]] double reach(const Part& part) const {
    return std::max(part.radius * inverseOpening_, kCarry * part.largestFace) * inverseUnit_;
  }
  /// Its radius and what `nearRatio` adds to its largest face's, in units.
  [[nodiscard]] double margin(const Part& part) const {
    return (part.radius + (nearRatio_ - 1) * part.largestFace) * inverseUnit_;
  }

  /// Quadrature points of a face; also writes its corners.
  [[nodiscard]] kernels::SourceFace source(const Corners& c, const FaceMoments& moments,
                                           const Point& centre,
                                           std::array<float, 9>& corners) const {
    kernels::SourceFace source{};
    const Vector middle = moments.centroid - centre;
    for (int a = 0; a < 3; ++a) {
      source.centroid[a] = static_cast<float>(middle[a] * inverseUnit_);
      for (int k = 0; k < 3; ++k) {
        const double corner = c[k][a] - centre[a];
        corners[3 * k + a] = static_cast<float>(corner * inverseUnit_);
        source.point[k][a] = static_cast<float>((middle[a] + corner) * (inverseUnit_ / 2));
      }
    }
    for (auto& point : source.point) point[3] = static_cast<float>(moments.area * inverseArea_ / 3);
    source.radius = static_cast<float>(moments.radius * inverseUnit_);
    return source;
  }

  /// @param first   number of the first face
  /// @param leaves  number of the first of the four packs at `quarters`
  void pack(const FaceMoments* moments, std::int32_t first, std::int32_t count, const Part& whole,
            std::int32_t leaves, kernels::SourcePack& pack, kernels::SourcePack* quarters) const {
    pack.present = 0;
    for (int q = 0; q < 4; ++q) quarters[q].present = 0;
    set(pack, 0, whole, whole.centre);
    const auto halves = partsOf({0, count});
    for (int h = 0; h < 2 && halves[h].count > 0; ++h) {
      set(pack, 1 + h, partOf(moments + halves[h].first, halves[h].count), whole.centre);
      const auto parts = partsOf(halves[h]);
      for (int q = 0; q < 2 && parts[q].count > 0; ++q) {
        const int number = 2 * h + q;
        const Part quarter = partOf(moments + parts[q].first, parts[q].count);
        set(pack, 3 + number, quarter, whole.centre);
        pack.first[number] = leaves + number;
        packLeaf(moments, first, parts[q], quarter, whole.centre, quarters[number]);
      }
    }
  }

 private:
  struct Range {
    std::int32_t first = 0;
    std::int32_t count = 0;
  };

  /// Both halves; the second is empty if the range is not cut.
  static std::array<Range, 2> partsOf(Range range) {
    const std::int32_t cut = cutOf(range.count);
    if (cut == 0) return {range, Range{}};
    return {Range{range.first, cut}, Range{range.first + cut, range.count - cut}};
  }

  void packLeaf(const FaceMoments* moments, std::int32_t first, Range range, const Part& quarter,
                const Point& centre, kernels::SourcePack& leaf) const {
    set(leaf, 0, quarter, centre);
    const auto pairs = partsOf(range);
    for (int p = 0; p < 2 && pairs[p].count > 0; ++p) {
      set(leaf, 1 + p, partOf(moments + pairs[p].first, pairs[p].count), centre);
      for (std::int32_t i = 0; i < pairs[p].count; ++i) {
        const std::int32_t face = pairs[p].first + i;
        const FaceMoments& m = moments[face];
        set(leaf, 3 + 2 * p + i, {m.centroid, m.area, m.second, m.radius, m.radius}, centre);
        leaf.first[2 * p + i] = first + face;
      }
    }
  }

  void set(kernels::SourcePack& pack, int entry, const Part& part, const Point& centre) const {
    const Vector offset = (part.centre - centre) * inverseUnit_;
    pack.x[entry] = static_cast<float>(offset[0]);
    pack.y[entry] = static_cast<float>(offset[1]);
    pack.z[entry] = static_cast<float>(offset[2]);
    pack.reach[entry] = static_cast<float>(reach(part));
    pack.margin[entry] = static_cast<float>(margin(part));
    const double square = inverseArea_ * inverseArea_;
    const auto second = [&](int k) { return static_cast<float>(part.second[k] * square); };
    pack.part[entry] = {static_cast<float>(part.area * inverseArea_),
                        second(0),
                        second(1),
                        second(2),
                        second(3),
                        second(4),
                        second(5)};
    pack.present |= 1U << entry;
  }

  double inverseUnit_;
  double inverseOpening_;
  double nearRatio_;
  double inverseArea_;
};

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

std::vector<std::size_t> ClusterTree::cutNodes(std::int32_t count) {
  nodes_.clear();
  nodes_.reserve(static_cast<std::size_t>(count) / kernels::kLanes * 2 + 2);
  Node root;
  root.count = count;
  nodes_.push_back(root);
  std::vector<std::size_t> levels = {0};
  for (std::size_t begin = 0; begin < nodes_.size();) {
    const std::size_t end = nodes_.size();
    for (std::size_t n = begin; n < end; ++n) {
      if (nodes_[n].count <= kernels::kLanes) continue;
      const std::int32_t cut = cutOf(nodes_[n].count);
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
  return levels;
}

std::vector<std::int32_t> ClusterTree::partsOf(std::int32_t largest) const {
  std::vector<std::int32_t> parts;
  const auto descend = [&](const auto& self, std::int32_t n) -> void {
    if (nodes_[n].count <= largest) {
      parts.push_back(n);
    } else {
      self(self, nodes_[n].left);
      self(self, nodes_[n].left + 1);
    }
  };
  descend(descend, 0);
  return parts;
}

void ClusterTree::sortKeys(const std::vector<std::size_t>& levels) {
  for (std::size_t level = 0; level + 1 < levels.size(); ++level) {
    std::vector<std::int32_t> large;
    for (std::size_t n = levels[level]; n < levels[level + 1]; ++n) {
      if (nodes_[n].count > kTaskFaces) large.push_back(static_cast<std::int32_t>(n));
    }
    if (large.empty()) break;
    parallelFor(large.size(), 1, [&](std::size_t i) {
      const Node& node = nodes_[large[i]];
      partitionAt(keys_.data() + node.first, node.count, cutOf(node.count));
    });
  }
  const std::vector<std::int32_t> tasks = partsOf(kTaskFaces);
  parallelFor(tasks.size(), 1, [&](std::size_t i) {
    const Node& node = nodes_[tasks[i]];
    partitionBelow(keys_.data() + node.first, node.count);
  });
}

void ClusterTree::packGroup(std::size_t group, const Positions& positions, const Faces& faces,
                            const std::vector<std::int32_t>& members, const SourcePacker& packer) {
  const std::int32_t first = nodes_[groups_[group]].first;
  const std::int32_t count = nodes_[groups_[group]].count;
  std::array<Corners, kernels::kLanes> corners;
  std::array<FaceMoments, kernels::kLanes> moments;
  for (std::int32_t i = 0; i < count; ++i) {
    const std::int32_t member = keys_[first + i].member;
    const std::int32_t face = members[member];
    order_[first + i] = member;
    for (int k = 0; k < 3; ++k) vertices_[first + i][k] = faces(face, k);
    corners[i] = cornersOf(positions, faces, face);
    moments[i] = momentsOf(corners[i]);
  }
  const Part whole = partOf(moments.data(), count);
  sums_[groups_[group]] = whole;
  for (std::int32_t i = 0; i < count; ++i) {
    sources_[first + i] = packer.source(corners[i], moments[i], whole.centre, corners_[first + i]);
  }
  packer.pack(moments.data(), first, count, whole, static_cast<std::int32_t>(4 * group),
              groupPacks_[group], leafPacks_.data() + 4 * group);
}

void ClusterTree::mergeSums(const std::vector<std::size_t>& levels) {
  for (std::size_t level = levels.size() - 1; level-- > 0;) {
    const std::size_t size = levels[level + 1] - levels[level];
    parallelFor(size, std::max<std::size_t>(64, size / 64), [&](std::size_t i) {
      const std::size_t n = levels[level] + i;
      const Node& node = nodes_[n];
      if (node.isGroup()) return;
      Part& sum = sums_[n];
      sum = merged(sums_[node.left], sums_[node.left + 1]);
      // The ball of its groups' balls.
      const std::int32_t end = (node.first + node.count - 1) / kernels::kLanes;
      for (std::int32_t g = node.first / kernels::kLanes; g <= end; ++g) {
        const Part& group = sums_[groups_[g]];
        sum.radius = std::max(sum.radius, (group.centre - sum.centre).norm() + group.radius);
      }
    });
  }
}

void ClusterTree::writeMoments(const SourcePacker& packer, double unit) {
  const double inverseUnit = 1 / unit;
  const double area = inverseUnit * inverseUnit;
  moments_.resize(nodes_.size());
  balls_.resize(nodes_.size());
  parallelFor(nodes_.size(), [&](std::size_t n) {
    const Part& part = sums_[n];
    Node& node = nodes_[n];
    node.centre = part.centre;
    node.radius = part.radius;
    node.largestFace = part.largestFace;
    Moments& moments = moments_[n];
    for (int a = 0; a < 3; ++a) moments.centre[a] = part.centre[a] * inverseUnit;
    moments.mass = static_cast<float>(part.area * area);
    for (int k = 0; k < 6; ++k) {
      moments.second[k] = static_cast<float>(part.second[k] * area * area);
    }
    const Vector offset = (part.centre - sums_[0].centre) * inverseUnit;
    balls_[n] = {static_cast<float>(offset[0]),           static_cast<float>(offset[1]),
                 static_cast<float>(offset[2]),           static_cast<float>(packer.reach(part)),
                 static_cast<float>(packer.margin(part)), node.left};
  });
}

void ClusterTree::build(const Positions& positions, const Faces& faces,
                        const std::vector<std::int32_t>& members, double unit, double opening,
                        double nearRatio) {
  order_.resize(members.size());
  nodes_.clear();
  blocks_.clear();
  groups_.clear();
  if (members.empty()) return;
  keys_.resize(members.size());
  parallelFor(members.size(), [&](std::size_t i) {
    const Corners c = cornersOf(positions, faces, members[i]);
    const Point centroid = (c[0] + c[1] + c[2]) / 3;
    for (int a = 0; a < 3; ++a) keys_[i].centroid[a] = static_cast<float>(centroid[a]);
    keys_[i].member = static_cast<std::int32_t>(i);
  });
  const std::vector<std::size_t> levels = cutNodes(static_cast<std::int32_t>(members.size()));
  blocks_ = partsOf(kBlockFaces);
  groups_ = partsOf(kernels::kLanes);
  sortKeys(levels);

  sources_.resize(members.size());
  corners_.resize(members.size());
  vertices_.resize(members.size());
  groupPacks_.resize(groups_.size());
  leafPacks_.resize(4 * groups_.size());
  sums_.assign(nodes_.size(), Part());
  const SourcePacker packer(unit, opening, nearRatio);
  parallelFor(groups_.size(), 32,
              [&](std::size_t g) { packGroup(g, positions, faces, members, packer); });
  mergeSums(levels);
  writeMoments(packer, unit);
}

}  // namespace explica::repulsion
