// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Kernels.h"

#include "Quadrature.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <utility>
#include <vector>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "Kernels.cpp"
#include <hwy/foreach_target.h>  // IWYU pragma: keep
#include <hwy/highway.h>

#ifndef EXPLICA_REPULSION_KERNEL_TABLES
#define EXPLICA_REPULSION_KERNEL_TABLES
namespace explica::repulsion::kernels {

// Added to squared distances so that a pair that is left out anyway cannot divide by zero; edges
// are about one long.
constexpr float kTiny = 1e-18F;

struct Weighted {
  float weight;
  float lambda[3];
};

template <std::size_t N>
inline std::array<Weighted, N> asFloats(Rule rule) {
  std::array<Weighted, N> result{};
  for (std::size_t i = 0; i < N; ++i) {
    result[i].weight = static_cast<float>(rule[i].weight);
    for (int k = 0; k < 3; ++k) result[i].lambda[k] = static_cast<float>(rule[i].lambda[k]);
  }
  return result;
}

/// A quadrature point of a reduced integral: z is this combination of the arms.
template <int kArms>
struct ArmPoint {
  float weight;
  float coefficient[kArms];
};

// Distance of the domain's centre from the singularity, in its radii, from which each rule errs by
// less than about 1e-3 of a pair's gradient (measured on a pial surface).
constexpr float kEdgeRatio[kRules] = {1.0F, 0.5F, 0.25F, 0.125F};
constexpr float kVertexRatio[kRules] = {1.0F, 0.7F, 0.35F, 0.175F};

using Corner = std::array<double, 3>;

/// The similar parts that `halvings` bisections of every edge leave, corners as coordinates.
inline std::vector<std::vector<Corner>> partsOfTriangle(int halvings) {
  std::vector<std::vector<Corner>> parts = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  const auto middle = [](const Corner& a, const Corner& b) {
    return Corner{(a[0] + b[0]) / 2, (a[1] + b[1]) / 2, (a[2] + b[2]) / 2};
  };
  for (; halvings > 0; --halvings) {
    std::vector<std::vector<Corner>> finer;
    for (const auto& t : parts) {
      const Corner ab = middle(t[0], t[1]);
      const Corner bc = middle(t[1], t[2]);
      const Corner ca = middle(t[2], t[0]);
      finer.push_back({t[0], ab, ca});
      finer.push_back({ab, t[1], bc});
      finer.push_back({ca, bc, t[2]});
      finer.push_back({ab, bc, ca});
    }
    parts = std::move(finer);
  }
  return parts;
}

inline std::vector<std::vector<Corner>> partsOfSegment(int halvings) {
  const int count = 1 << halvings;
  std::vector<std::vector<Corner>> parts;
  for (int i = 0; i < count; ++i) {
    const double from = static_cast<double>(i) / count;
    const double to = static_cast<double>(i + 1) / count;
    parts.push_back({{1 - from, from, 0}, {1 - to, to, 0}});
  }
  return parts;
}

/// A rule on each part, as a rule of the whole.
inline std::vector<RulePoint> composite(Rule rule, const std::vector<std::vector<Corner>>& parts) {
  std::vector<RulePoint> points;
  for (const auto& part : parts) {
    for (const RulePoint& p : rule) {
      RulePoint point{{0, 0, 0}, p.weight / static_cast<double>(parts.size())};
      for (std::size_t k = 0; k < part.size(); ++k) {
        for (int axis = 0; axis < 3; ++axis) point.lambda[axis] += p.lambda[k] * part[k][axis];
      }
      points.push_back(point);
    }
  }
  return points;
}

inline std::vector<ArmPoint<3>> edgePoints(int halvings) {
  static constexpr int kCorners[6][3][3] = {
      {{0, 1, 0}, {1, 0, 0}, {1, 0, -1}},   {{0, 1, 0}, {1, 0, -1}, {0, 1, -1}},
      {{0, 0, -1}, {1, 0, -1}, {0, 1, -1}}, {{0, 0, -1}, {-1, 0, 0}, {-1, 1, 0}},
      {{0, 0, -1}, {-1, 1, 0}, {0, 1, -1}}, {{0, 1, 0}, {-1, 1, 0}, {0, 1, -1}}};
  std::vector<ArmPoint<3>> result;
  for (const auto& triangle : kCorners) {
    const Rule rule = halvings == 0 ? triangleRule12() : triangleRule16();
    for (const RulePoint& p : composite(rule, partsOfTriangle(halvings))) {
      ArmPoint<3> point{};
      point.weight = static_cast<float>(p.weight);
      for (int arm = 0; arm < 3; ++arm) {
        double c = 0;
        for (int k = 0; k < 3; ++k) c += p.lambda[k] * triangle[k][arm];
        point.coefficient[arm] = static_cast<float>(c);
      }
      result.push_back(point);
    }
  }
  return result;
}

/// A product rule: each point of an edge with each point of a triangle, in coordinates of the
/// corners that are not common.
struct ProductRule {
  struct EdgePoint {
    float weight;
    float first;  // coordinate of the first corner; that of the second is the rest
  };
  struct FacePoint {
    float weight;
    float lambda[2];
  };
  std::vector<EdgePoint> edge;
  std::vector<FacePoint> face;
};

inline ProductRule productRule(Rule segment, Rule triangle, int halvings) {
  ProductRule result;
  for (const RulePoint& p : composite(segment, partsOfSegment(halvings))) {
    result.edge.push_back({static_cast<float>(p.weight), static_cast<float>(p.lambda[0])});
  }
  for (const RulePoint& p : composite(triangle, partsOfTriangle(halvings))) {
    result.face.push_back({static_cast<float>(p.weight),
                           {static_cast<float>(p.lambda[1]), static_cast<float>(p.lambda[2])}});
  }
  return result;
}

inline const std::vector<ArmPoint<3>>& edgeRule(int rule) {
  static const std::array<std::vector<ArmPoint<3>>, kRules> rules = {edgePoints(0), edgePoints(1),
                                                                     edgePoints(2), edgePoints(3)};
  return rules[rule];
}

inline const ProductRule& vertexRule(int rule) {
  static const std::array<ProductRule, kRules> rules = {
      productRule(segmentRule3(), triangleRule7(), 0),
      productRule(segmentRule4(), triangleRule12(), 0),
      productRule(segmentRule4(), triangleRule12(), 1),
      productRule(segmentRule4(), triangleRule12(), 2)};
  return rules[rule];
}

/// Entries of a pack that act as one, and quarters that do not.
struct Choice {
  std::uint32_t nodes;
  std::uint32_t opened;
};

/// The choice for each set of entries that may act as one, all being present.
inline constexpr std::array<Choice, 128> kChoices = [] {
  std::array<Choice, 128> choices{};
  for (std::uint32_t clear = 0; clear < choices.size(); ++clear) {
    Choice& choice = choices[clear];
    if ((clear & 1) != 0) {
      choice = {1, 0};
      continue;
    }
    for (std::uint32_t half = 0; half < 2; ++half) {
      const std::uint32_t itself = 2U << half;
      const std::uint32_t quarters = 0x18U << (2 * half);
      if ((clear & itself) != 0) {
        choice.nodes |= itself;
      } else {
        choice.nodes |= clear & quarters;
        choice.opened |= ~clear & quarters;
      }
    }
  }
  return choices;
}();

inline Choice choose(std::uint32_t clear, std::uint32_t present) {
  const Choice choice = kChoices[(clear | ~present) & 0x7F];
  return {choice.nodes & present, choice.opened & present};
}

}  // namespace explica::repulsion::kernels
#endif  // EXPLICA_REPULSION_KERNEL_TABLES

HWY_BEFORE_NAMESPACE();
namespace explica::repulsion::kernels::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Tag = hn::CappedTag<float, kLanes>;
using Vec = hn::Vec<Tag>;

template <class D, class V = hn::Vec<D>>
HWY_INLINE V reciprocal(D d, V x) {
  const V two = hn::Set(d, 2.0F);
  V r = hn::ApproximateReciprocal(x);
  r = hn::Mul(r, hn::NegMulAdd(x, r, two));
#if !HWY_ARCH_X86
  r = hn::Mul(r, hn::NegMulAdd(x, r, two));
#endif
  return r;
}

template <class D, class V = hn::Vec<D>>
HWY_INLINE V squaredNorm(D d, V x, V y, V z) {
  return hn::MulAdd(x, x, hn::MulAdd(y, y, hn::MulAdd(z, z, hn::Set(d, kTiny))));
}

HWY_INLINE void AddTo(Tag d, Vec value, float* to) {
  hn::Store(hn::Add(value, hn::Load(d, to)), d, to);
}

/// Adds the field at the centroids, carried to the quadrature points by its second derivatives xx,
/// yy, zz, xy, xz, yz; phi is the mean over the face already.
HWY_INLINE void Carry(Tag d, TargetLeaf& target, int set, int lane, Vec phi, const Vec (&g)[3],
                      const Vec (&h)[6]) {
  for (int q = 0; q < 3; ++q) {
    Vec by[3];
    for (int a = 0; a < 3; ++a) {
      by[a] =
          hn::Sub(hn::Load(d, target.point[q][a] + lane), hn::Load(d, target.centroid[a] + lane));
    }
    const Vec change[3] = {hn::MulAdd(h[0], by[0], hn::MulAdd(h[3], by[1], hn::Mul(h[4], by[2]))),
                           hn::MulAdd(h[3], by[0], hn::MulAdd(h[1], by[1], hn::Mul(h[5], by[2]))),
                           hn::MulAdd(h[4], by[0], hn::MulAdd(h[5], by[1], hn::Mul(h[2], by[2])))};
    AddTo(d, phi, target.phi[set][q] + lane);
    for (int a = 0; a < 3; ++a) AddTo(d, hn::Add(g[a], change[a]), target.g[q][a] + lane);
  }
}

void FarNodes(TargetLeaf& target, int set, const FarNode* HWY_RESTRICT nodes, std::size_t count,
              const float* shift) {
  const Tag d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  for (int lane = 0; lane < kLanes; lane += lanes) {
    const Vec x = hn::Add(hn::Load(d, target.centroid[0] + lane), hn::Set(d, shift[0]));
    const Vec y = hn::Add(hn::Load(d, target.centroid[1] + lane), hn::Set(d, shift[1]));
    const Vec z = hn::Add(hn::Load(d, target.centroid[2] + lane), hn::Set(d, shift[2]));
    const Vec four = hn::Set(d, 4.0F);
    Vec phi = hn::Zero(d), gx = hn::Zero(d), gy = hn::Zero(d), gz = hn::Zero(d);
    // Second derivatives: diagonal I + the rest.
    Vec diagonal = hn::Zero(d), hxx = hn::Zero(d), hyy = hn::Zero(d), hzz = hn::Zero(d);
    Vec hxy = hn::Zero(d), hxz = hn::Zero(d), hyz = hn::Zero(d);
    for (std::size_t i = 0; i < count; ++i) {
      const FarNode& n = nodes[i];
      const Vec rx = hn::Sub(x, hn::Set(d, n.centre[0]));
      const Vec ry = hn::Sub(y, hn::Set(d, n.centre[1]));
      const Vec rz = hn::Sub(z, hn::Set(d, n.centre[2]));
      const Vec s = reciprocal(d, squaredNorm(d, rx, ry, rz));
      const Vec mass = hn::Set(d, n.mass);
      // Q: the node's second moments and those that its mass has by the target's extent.
      const Vec xx = hn::MulAdd(mass, hn::Load(d, target.second[0] + lane), hn::Set(d, n.xx));
      const Vec yy = hn::MulAdd(mass, hn::Load(d, target.second[1] + lane), hn::Set(d, n.yy));
      const Vec zz = hn::MulAdd(mass, hn::Load(d, target.second[2] + lane), hn::Set(d, n.zz));
      const Vec xy = hn::MulAdd(mass, hn::Load(d, target.second[3] + lane), hn::Set(d, n.xy));
      const Vec xz = hn::MulAdd(mass, hn::Load(d, target.second[4] + lane), hn::Set(d, n.xz));
      const Vec yz = hn::MulAdd(mass, hn::Load(d, target.second[5] + lane), hn::Set(d, n.yz));
      const Vec trace = hn::Add(xx, hn::Add(yy, zz));
      const Vec ux = hn::MulAdd(xx, rx, hn::MulAdd(xy, ry, hn::Mul(xz, rz)));
      const Vec uy = hn::MulAdd(xy, rx, hn::MulAdd(yy, ry, hn::Mul(yz, rz)));
      const Vec uz = hn::MulAdd(xz, rx, hn::MulAdd(yz, ry, hn::Mul(zz, rz)));
      const Vec qs = hn::Mul(s, hn::MulAdd(ux, rx, hn::MulAdd(uy, ry, hn::Mul(uz, rz))));
      // phi = s (m + s (4 q s - trace)), q = r . Q r
      phi = hn::MulAdd(s, hn::MulAdd(s, hn::MulSub(four, qs, trace), mass), phi);
      // grad phi = s^2 ((-2 m + s (4 trace - 24 q s)) r + 8 s Q r)
      const Vec s2 = hn::Mul(s, s);
      const Vec bend = hn::Mul(s, hn::MulAdd(four, trace, hn::Mul(hn::Set(d, -24.0F), qs)));
      const Vec radial = hn::Mul(s2, hn::MulAdd(hn::Set(d, -2.0F), mass, bend));
      const Vec turn = hn::Mul(hn::Mul(s2, s), hn::Set(d, 8.0F));
      gx = hn::MulAdd(radial, rx, hn::MulAdd(turn, ux, gx));
      gy = hn::MulAdd(radial, ry, hn::MulAdd(turn, uy, gy));
      gz = hn::MulAdd(radial, rz, hn::MulAdd(turn, uz, gz));
      // d2 (m s) = -2 m s^2 I + 8 m s^3 r r^T, with the nodes' own radial part in place of -2 m s^2
      diagonal = hn::Add(diagonal, radial);
      const Vec c = hn::Mul(hn::Mul(hn::Set(d, -4.0F), s), radial);
      const Vec cx = hn::Mul(c, rx);
      const Vec cy = hn::Mul(c, ry);
      hxx = hn::MulAdd(cx, rx, hxx);
      hxy = hn::MulAdd(cx, ry, hxy);
      hxz = hn::MulAdd(cx, rz, hxz);
      hyy = hn::MulAdd(cy, ry, hyy);
      hyz = hn::MulAdd(cy, rz, hyz);
      hzz = hn::MulAdd(hn::Mul(c, rz), rz, hzz);
    }
    hxx = hn::Add(hxx, diagonal);
    hyy = hn::Add(hyy, diagonal);
    hzz = hn::Add(hzz, diagonal);
    Carry(d, target, set, lane, phi, {gx, gy, gz}, {hxx, hyy, hzz, hxy, hxz, hyz});
  }
}

/// Lanes of a mask, one bit each.
template <class D, class M>
HWY_INLINE std::uint32_t bitsOf(D d, M mask) {
  std::uint8_t bytes[8] = {};
  hn::StoreMaskBits(d, mask, bytes);
  return static_cast<std::uint32_t>(bytes[0]) | (static_cast<std::uint32_t>(bytes[1]) << 8);
}

using PackTag = hn::CappedTag<float, 8>;

/// Box and ball of the targets' centroids about one middle, and the largest of their radii.
struct TargetBox {
  float middle[3];
  float extent[3];
  float reach;  ///< of the ball
  float radius;
};

TargetBox BoxOf(const TargetLeaf& target) {
  TargetBox box{};
  for (int a = 0; a < 3; ++a) {
    const float* c = target.centroid[a];
    const auto [low, high] = std::minmax_element(c, c + kLanes);
    box.middle[a] = (*low + *high) / 2;
    box.extent[a] = (*high - *low) / 2;
  }
  float farthest = 0;
  for (int lane = 0; lane < kLanes; ++lane) {
    float squared = 0;
    for (int a = 0; a < 3; ++a) {
      const float away = target.centroid[a][lane] - box.middle[a];
      squared += away * away;
    }
    farthest = std::max(farthest, squared);
  }
  box.reach = std::sqrt(farthest);
  box.radius = *std::max_element(target.radius, target.radius + kLanes);
  return box;
}

/// The entries of a pack that may act as one, one bit each.
HWY_INLINE std::uint32_t Examine(const TargetBox& box, const SourcePack& pack, const float* offset,
                                 float nearRatio) {
  const PackTag d;
  std::uint32_t clear = 0;
  for (int k = 0; k < 8; k += static_cast<int>(hn::Lanes(d))) {
    const auto away = [&](const float* centre, int a) HWY_ATTR {
      return hn::Abs(hn::Add(hn::Load(d, centre + k), hn::Set(d, offset[a] - box.middle[a])));
    };
    const auto outside = [&](auto distance, int a) HWY_ATTR {
      return hn::Max(hn::Sub(distance, hn::Set(d, box.extent[a])), hn::Zero(d));
    };
    const auto x = away(pack.x, 0);
    const auto y = away(pack.y, 1);
    const auto z = away(pack.z, 2);
    const auto reach =
        hn::Max(hn::Add(hn::Load(d, pack.reach + k), hn::Set(d, box.radius)),
                hn::Add(hn::Load(d, pack.margin + k), hn::Set(d, nearRatio * box.radius)));
    const auto fromMiddle = hn::Add(reach, hn::Set(d, box.reach));
    const auto beyondBall = hn::Gt(squaredNorm(d, x, y, z), hn::Mul(fromMiddle, fromMiddle));
    const auto beyondBox =
        hn::Gt(squaredNorm(d, outside(x, 0), outside(y, 1), outside(z, 2)), hn::Mul(reach, reach));
    clear |= bitsOf(d, hn::Or(beyondBall, beyondBox)) << k;
  }
  return clear;
}

/// Adds the entries of a pack that act as one to a list.
HWY_INLINE void Append(const SourcePack& pack, std::uint32_t entries, const float* offset,
                       FarNode* nodes, std::size_t& count) {
  for (; entries != 0; entries &= entries - 1) {
    const int entry = std::countr_zero(entries);
    const PartMoments& part = pack.part[entry];
    nodes[count++] = {
        {pack.x[entry] + offset[0], pack.y[entry] + offset[1], pack.z[entry] + offset[2]},
        part.mass,
        part.xx,
        part.yy,
        part.zz,
        part.xy,
        part.xz,
        part.yz};
  }
}

/// Targets, one bit each, to which a face is nearer than `nearRatio` sums of radii; the weights
/// that the others take are written.
HWY_INLINE std::uint32_t NearTargets(Tag d, const TargetLeaf& target, const float* centroid,
                                     float radius, float nearRatio, float weight, float* weights) {
  const int lanes = static_cast<int>(hn::Lanes(d));
  std::uint32_t found = 0;
  for (int lane = 0; lane < kLanes; lane += lanes) {
    const auto dx = hn::Sub(hn::Load(d, target.centroid[0] + lane), hn::Set(d, centroid[0]));
    const auto dy = hn::Sub(hn::Load(d, target.centroid[1] + lane), hn::Set(d, centroid[1]));
    const auto dz = hn::Sub(hn::Load(d, target.centroid[2] + lane), hn::Set(d, centroid[2]));
    const auto reach = hn::Mul(hn::Set(d, nearRatio),
                               hn::Add(hn::Load(d, target.radius + lane), hn::Set(d, radius)));
    const auto isNear = hn::Lt(squaredNorm(d, dx, dy, dz), hn::Mul(reach, reach));
    hn::Store(hn::IfThenZeroElse(isNear, hn::Set(d, weight)), d, weights + lane);
    found |= bitsOf(d, isNear) << lane;
  }
  return found;
}

std::size_t CloseGroups(TargetLeaf& target, int set, const CloseGroup* HWY_RESTRICT groups,
                        std::size_t count, const CloseSources& sources, float nearRatio,
                        const CloseRoom& room) {
  const Tag d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  const Vec minusTwo = hn::Set(d, -2.0F);
  const TargetBox box = BoxOf(target);
  std::size_t nodeCount = 0;
  std::size_t leafCount = 0;
  for (std::size_t g = 0; g < count; ++g) {
    const SourcePack& pack = *groups[g].pack;
    const float* offset = groups[g].offset;
    const Choice choice = choose(Examine(box, pack, offset, nearRatio), pack.present);
    Append(pack, choice.nodes, offset, room.nodes, nodeCount);
    for (std::uint32_t left = choice.opened; left != 0; left &= left - 1) {
      room.leaves[leafCount++] = {sources.leaves + pack.first[std::countr_zero(left) - 3], offset};
    }
  }
  std::size_t hitCount = 0;
  std::size_t maskedCount = 0;
  for (std::size_t l = 0; l < leafCount; ++l) {
    const SourcePack& pack = *room.leaves[l].pack;
    const float* offset = room.leaves[l].offset;
    const Choice choice = choose(Examine(box, pack, offset, nearRatio), pack.present);
    Append(pack, choice.nodes, offset, room.nodes, nodeCount);
    for (std::uint32_t left = choice.opened; left != 0; left &= left - 1) {
      const std::int32_t f = pack.first[std::countr_zero(left) - 3];
      const SourceFace& source = sources.faces[f];
      const float centroid[3] = {source.centroid[0] + offset[0], source.centroid[1] + offset[1],
                                 source.centroid[2] + offset[2]};
      MaskedFace& masked = room.faces[maskedCount];
      const std::uint32_t found = NearTargets(d, target, centroid, source.radius, nearRatio,
                                              source.point[0][3], masked.weight);
      for (int p = 0; p < 3; ++p) {
        for (int a = 0; a < 4; ++a) masked.point[p][a] = source.point[p][a] + offset[a];
      }
      ++maskedCount;
      const auto& v = sources.vertices[f];
      const std::uint32_t apart =
          found & ~static_cast<std::uint32_t>(sources.targetsAt[v[0]] | sources.targetsAt[v[1]] |
                                              sources.targetsAt[v[2]]);
      room.hits[hitCount] = {f, apart};
      hitCount += apart != 0 ? 1 : 0;
    }
  }

  const float still[3] = {0, 0, 0};
  FarNodes(target, set, room.nodes, nodeCount, still);
  for (int lane = 0; lane < kLanes; lane += lanes) {
    for (int q = 0; q < 3; ++q) {
      const Vec x = hn::Load(d, target.point[q][0] + lane);
      const Vec y = hn::Load(d, target.point[q][1] + lane);
      const Vec z = hn::Load(d, target.point[q][2] + lane);
      Vec phi = hn::Zero(d);
      Vec gx = hn::Zero(d), gy = hn::Zero(d), gz = hn::Zero(d);  // of +r/r^4
      const auto add = [&](const float* point, Vec weight) HWY_ATTR {
        const Vec rx = hn::Sub(x, hn::Set(d, point[0]));
        const Vec ry = hn::Sub(y, hn::Set(d, point[1]));
        const Vec rz = hn::Sub(z, hn::Set(d, point[2]));
        const Vec s = reciprocal(d, squaredNorm(d, rx, ry, rz));
        const Vec term = hn::Mul(weight, s);
        phi = hn::Add(phi, term);
        const Vec pull = hn::Mul(term, s);
        gx = hn::MulAdd(pull, rx, gx);
        gy = hn::MulAdd(pull, ry, gy);
        gz = hn::MulAdd(pull, rz, gz);
      };
      for (std::size_t i = 0; i < maskedCount; ++i) {
        const Vec weight = hn::Load(d, room.faces[i].weight + lane);
        for (int p = 0; p < 3; ++p) add(room.faces[i].point[p], weight);
      }
      AddTo(d, phi, target.phi[set][q] + lane);
      AddTo(d, hn::Mul(minusTwo, gx), target.g[q][0] + lane);
      AddTo(d, hn::Mul(minusTwo, gy), target.g[q][1] + lane);
      AddTo(d, hn::Mul(minusTwo, gz), target.g[q][2] + lane);
    }
  }
  return hitCount;
}

template <std::size_t N>
HWY_INLINE void Apart(ApartBatch& batch, const std::array<Weighted, N>& rule) {
  const Tag d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  for (int lane = 0; lane < kLanes; lane += lanes) {
    HWY_ALIGN float y[3 * N * kLanes];
    for (std::size_t j = 0; j < N; ++j) {
      for (int axis = 0; axis < 3; ++axis) {
        Vec v = hn::Zero(d);
        for (int k = 0; k < 3; ++k) {
          v = hn::MulAdd(hn::Set(d, rule[j].lambda[k]), hn::Load(d, batch.t[3 * k + axis] + lane),
                         v);
        }
        hn::Store(v, d, y + (3 * j + axis) * kLanes);
      }
    }
    Vec value = hn::Zero(d);
    Vec by[9];
    for (Vec& b : by) b = hn::Zero(d);
    for (std::size_t i = 0; i < N; ++i) {
      Vec x[3];
      for (int axis = 0; axis < 3; ++axis) {
        x[axis] = hn::Zero(d);
        for (int k = 0; k < 3; ++k) {
          x[axis] = hn::MulAdd(hn::Set(d, rule[i].lambda[k]),
                               hn::Load(d, batch.s[3 * k + axis] + lane), x[axis]);
        }
      }
      Vec sum = hn::Zero(d), gx = hn::Zero(d), gy = hn::Zero(d), gz = hn::Zero(d);
      for (std::size_t j = 0; j < N; ++j) {
        const Vec rx = hn::Sub(x[0], hn::Load(d, y + (3 * j) * kLanes));
        const Vec ry = hn::Sub(x[1], hn::Load(d, y + (3 * j + 1) * kLanes));
        const Vec rz = hn::Sub(x[2], hn::Load(d, y + (3 * j + 2) * kLanes));
        const Vec s = reciprocal(d, squaredNorm(d, rx, ry, rz));
        const Vec term = hn::Mul(hn::Set(d, rule[j].weight), s);
        sum = hn::Add(sum, term);
        const Vec pull = hn::Mul(term, s);
        gx = hn::MulAdd(pull, rx, gx);
        gy = hn::MulAdd(pull, ry, gy);
        gz = hn::MulAdd(pull, rz, gz);
      }
      value = hn::MulAdd(hn::Set(d, rule[i].weight), sum, value);
      for (int k = 0; k < 3; ++k) {
        const Vec w = hn::Set(d, -2 * rule[i].weight * rule[i].lambda[k]);
        by[3 * k] = hn::MulAdd(w, gx, by[3 * k]);
        by[3 * k + 1] = hn::MulAdd(w, gy, by[3 * k + 1]);
        by[3 * k + 2] = hn::MulAdd(w, gz, by[3 * k + 2]);
      }
    }
    hn::Store(value, d, batch.value + lane);
    for (int k = 0; k < 9; ++k) hn::Store(by[k], d, batch.byS[k] + lane);
  }
}

void IntegrateApart(ApartBatch& batch, bool fine) {
  static const auto kSeven = asFloats<7>(triangleRule7());
  static const auto kTwelve = asFloats<12>(triangleRule12());
  if (fine) {
    Apart(batch, kTwelve);
  } else {
    Apart(batch, kSeven);
  }
}

template <int kArms, class Batch>
HWY_INLINE void Reduced(Batch& batch, const std::vector<ArmPoint<kArms>>& points) {
  const Tag d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  for (int lane = 0; lane < kLanes; lane += lanes) {
    Vec arm[3 * kArms];
    Vec by[3 * kArms];
    for (int k = 0; k < 3 * kArms; ++k) {
      arm[k] = hn::Load(d, batch.arm[k] + lane);
      by[k] = hn::Zero(d);
    }
    Vec value = hn::Zero(d);
    for (const ArmPoint<kArms>& p : points) {
      Vec x = hn::Zero(d), y = hn::Zero(d), z = hn::Zero(d);
      for (int k = 0; k < kArms; ++k) {
        const Vec c = hn::Set(d, p.coefficient[k]);
        x = hn::MulAdd(c, arm[3 * k], x);
        y = hn::MulAdd(c, arm[3 * k + 1], y);
        z = hn::MulAdd(c, arm[3 * k + 2], z);
      }
      const Vec s = reciprocal(d, squaredNorm(d, x, y, z));
      const Vec term = hn::Mul(hn::Set(d, p.weight), s);
      value = hn::Add(value, term);
      const Vec pull = hn::Mul(hn::Set(d, -2.0F), hn::Mul(term, s));
      x = hn::Mul(x, pull);
      y = hn::Mul(y, pull);
      z = hn::Mul(z, pull);
      for (int k = 0; k < kArms; ++k) {
        const Vec c = hn::Set(d, p.coefficient[k]);
        by[3 * k] = hn::MulAdd(c, x, by[3 * k]);
        by[3 * k + 1] = hn::MulAdd(c, y, by[3 * k + 1]);
        by[3 * k + 2] = hn::MulAdd(c, z, by[3 * k + 2]);
      }
    }
    hn::Store(value, d, batch.value + lane);
    for (int k = 0; k < 3 * kArms; ++k) hn::Store(by[k], d, batch.byArm[k] + lane);
  }
}

void IntegrateEdge(EdgeBatch& batch, int rule) {
  Reduced<3>(batch, edgeRule(rule));
}
/// Adds the mean of 1/|z|^2, z from a triangle to an edge that has no point with it in common, and
/// its derivatives: `edge` and `face` number the arms to the corners of each.
/// @tparam kCount  points of the edge
template <int kCount>
HWY_INLINE void EdgeByFace(Tag d, VertexBatch& batch, const ProductRule& rule, int lane, int edge,
                           int face) {
  const auto arm = [&](int k, int axis)
                       HWY_ATTR { return hn::Load(d, batch.arm[3 * k + axis] + lane); };
  HWY_ALIGN float points[3 * kCount * kLanes];
  for (int i = 0; i < kCount; ++i) {
    const Vec first = hn::Set(d, rule.edge[i].first);
    for (int a = 0; a < 3; ++a) {
      const Vec last = arm(edge + 1, a);
      hn::Store(hn::MulAdd(first, hn::Sub(arm(edge, a), last), last), d,
                points + (3 * i + a) * kLanes);
    }
  }
  const Vec ux = arm(face, 0), uy = arm(face, 1), uz = arm(face, 2);
  const Vec vx = arm(face + 1, 0), vy = arm(face + 1, 1), vz = arm(face + 1, 2);
  Vec value = hn::Zero(d);
  // Sums of z/|z|^4: weighted by the edge's first coordinate, all, and by those of the triangle.
  Vec ex = hn::Zero(d), ey = hn::Zero(d), ez = hn::Zero(d);
  Vec tx = hn::Zero(d), ty = hn::Zero(d), tz = hn::Zero(d);
  Vec px = hn::Zero(d), py = hn::Zero(d), pz = hn::Zero(d);
  Vec qx = hn::Zero(d), qy = hn::Zero(d), qz = hn::Zero(d);
  for (const ProductRule::FacePoint& f : rule.face) {
    const Vec l0 = hn::Set(d, f.lambda[0]);
    const Vec l1 = hn::Set(d, f.lambda[1]);
    const Vec fx = hn::MulAdd(l0, ux, hn::Mul(l1, vx));
    const Vec fy = hn::MulAdd(l0, uy, hn::Mul(l1, vy));
    const Vec fz = hn::MulAdd(l0, uz, hn::Mul(l1, vz));
    Vec phi = hn::Zero(d);
    Vec gx = hn::Zero(d), gy = hn::Zero(d), gz = hn::Zero(d);
    Vec hx = hn::Zero(d), hy = hn::Zero(d), hz = hn::Zero(d);
    for (int i = 0; i < kCount; ++i) {
      const Vec x = hn::Sub(hn::Load(d, points + (3 * i) * kLanes), fx);
      const Vec y = hn::Sub(hn::Load(d, points + (3 * i + 1) * kLanes), fy);
      const Vec z = hn::Sub(hn::Load(d, points + (3 * i + 2) * kLanes), fz);
      const Vec s = reciprocal(d, squaredNorm(d, x, y, z));
      const Vec term = hn::Mul(hn::Set(d, rule.edge[i].weight), s);
      phi = hn::Add(phi, term);
      const Vec pull = hn::Mul(term, s);
      gx = hn::MulAdd(pull, x, gx);
      gy = hn::MulAdd(pull, y, gy);
      gz = hn::MulAdd(pull, z, gz);
      const Vec first = hn::Mul(pull, hn::Set(d, rule.edge[i].first));
      hx = hn::MulAdd(first, x, hx);
      hy = hn::MulAdd(first, y, hy);
      hz = hn::MulAdd(first, z, hz);
    }
    const Vec weight = hn::Set(d, f.weight);
    value = hn::MulAdd(weight, phi, value);
    ex = hn::MulAdd(weight, hx, ex);
    ey = hn::MulAdd(weight, hy, ey);
    ez = hn::MulAdd(weight, hz, ez);
    gx = hn::Mul(weight, gx);
    gy = hn::Mul(weight, gy);
    gz = hn::Mul(weight, gz);
    tx = hn::Add(tx, gx);
    ty = hn::Add(ty, gy);
    tz = hn::Add(tz, gz);
    px = hn::MulAdd(l0, gx, px);
    py = hn::MulAdd(l0, gy, py);
    pz = hn::MulAdd(l0, gz, pz);
    qx = hn::MulAdd(l1, gx, qx);
    qy = hn::MulAdd(l1, gy, qy);
    qz = hn::MulAdd(l1, gz, qz);
  }
  const auto add = [&](int k, int axis, float factor, Vec v) HWY_ATTR {
    AddTo(d, hn::Mul(hn::Set(d, factor), v), batch.byArm[3 * k + axis] + lane);
  };
  AddTo(d, value, batch.value + lane);
  const Vec e[3] = {ex, ey, ez};
  const Vec t[3] = {tx, ty, tz};
  const Vec p[3] = {px, py, pz};
  const Vec q[3] = {qx, qy, qz};
  for (int a = 0; a < 3; ++a) {
    add(edge, a, -2.0F, e[a]);
    add(edge + 1, a, -2.0F, hn::Sub(t[a], e[a]));
    add(face, a, 2.0F, p[a]);
    add(face + 1, a, 2.0F, q[a]);
  }
}

template <int kCount>
HWY_INLINE void BothEdgesByFace(VertexBatch& batch, const ProductRule& rule) {
  const Tag d;
  for (int lane = 0; lane < kLanes; lane += static_cast<int>(hn::Lanes(d))) {
    hn::Store(hn::Zero(d), d, batch.value + lane);
    for (auto& row : batch.byArm) hn::Store(hn::Zero(d), d, row + lane);
    EdgeByFace<kCount>(d, batch, rule, lane, 0, 2);
    EdgeByFace<kCount>(d, batch, rule, lane, 2, 0);
  }
}

void IntegrateVertex(VertexBatch& batch, int number) {
  const ProductRule& rule = vertexRule(number);
  switch (rule.edge.size()) {
    case 3:
      return BothEdgesByFace<3>(batch, rule);
    case 4:
      return BothEdgesByFace<4>(batch, rule);
    case 8:
      return BothEdgesByFace<8>(batch, rule);
    default:
      return BothEdgesByFace<16>(batch, rule);
  }
}

struct Vec3 {
  Vec x, y, z;
};
HWY_INLINE Vec3 Difference(Vec3 a, Vec3 b) {
  return {hn::Sub(a.x, b.x), hn::Sub(a.y, b.y), hn::Sub(a.z, b.z)};
}
HWY_INLINE Vec SquaredNorm(Vec3 a) {
  return hn::MulAdd(a.x, a.x, hn::MulAdd(a.y, a.y, hn::Mul(a.z, a.z)));
}
HWY_INLINE Vec3 LoadArm(Tag d, const float (*arm)[kLanes], int k, int lane) {
  return {hn::Load(d, arm[3 * k] + lane), hn::Load(d, arm[3 * k + 1] + lane),
          hn::Load(d, arm[3 * k + 2] + lane)};
}
HWY_INLINE Vec3 Centre(Tag d, Vec3 a, Vec3 b, Vec3 c) {
  const Vec third = hn::Set(d, 1.0F / 3);
  return {hn::Mul(third, hn::Add(a.x, hn::Add(b.x, c.x))),
          hn::Mul(third, hn::Add(a.y, hn::Add(b.y, c.y))),
          hn::Mul(third, hn::Add(a.z, hn::Add(b.z, c.z)))};
}
HWY_INLINE Vec SquaredRadius(Vec3 centre, Vec3 a, Vec3 b, Vec3 c) {
  return hn::Max(SquaredNorm(Difference(a, centre)),
                 hn::Max(SquaredNorm(Difference(b, centre)), SquaredNorm(Difference(c, centre))));
}

/// Writes the number of thresholds above `ratio`; not-a-number is above none, so counts all.
HWY_INLINE void StoreRules(Tag d, Vec ratio, const float* thresholds, std::int32_t* rules,
                           int lane) {
  HWY_ALIGN float values[kLanes];
  hn::Store(ratio, d, values);
  for (std::size_t i = 0; i < hn::Lanes(d); ++i) {
    std::int32_t rule = 0;
    while (rule < kRules && !(values[i] >= thresholds[rule])) ++rule;
    rules[static_cast<std::size_t>(lane) + i] = rule;
  }
}

void ChooseEdgeRules(const EdgeBatch& batch, std::int32_t* rules) {
  const Tag d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  for (int lane = 0; lane < kLanes; lane += lanes) {
    const Vec3 zero = {hn::Zero(d), hn::Zero(d), hn::Zero(d)};
    const Vec3 e = LoadArm(d, batch.arm, 0, lane);
    const Vec3 a = LoadArm(d, batch.arm, 1, lane);
    const Vec3 b = LoadArm(d, batch.arm, 2, lane);
    const Vec3 minusE = Difference(zero, e);
    const Vec3 minusB = Difference(zero, b);
    const Vec3 eMinusB = Difference(e, b);
    const Vec3 aMinusB = Difference(a, b);
    const Vec3 aMinusE = Difference(a, e);
    const auto ratio = [&](Vec3 p, Vec3 q, Vec3 r) HWY_ATTR {
      const Vec3 centre = Centre(d, p, q, r);
      return hn::Div(SquaredNorm(centre), SquaredRadius(centre, p, q, r));
    };
    Vec least = hn::Min(ratio(a, e, eMinusB), ratio(a, eMinusB, aMinusB));
    least =
        hn::Min(least, hn::Min(ratio(minusB, eMinusB, aMinusB), ratio(minusB, minusE, aMinusE)));
    least = hn::Min(least, hn::Min(ratio(minusB, aMinusE, aMinusB), ratio(a, aMinusE, aMinusB)));
    StoreRules(d, hn::Sqrt(least), kEdgeRatio, rules, lane);
  }
}

void ChooseVertexRules(const VertexBatch& batch, std::int32_t* rules) {
  const Tag d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  for (int lane = 0; lane < kLanes; lane += lanes) {
    const Vec3 zero = {hn::Zero(d), hn::Zero(d), hn::Zero(d)};
    const Vec3 s1 = LoadArm(d, batch.arm, 0, lane);
    const Vec3 s2 = LoadArm(d, batch.arm, 1, lane);
    const Vec3 t1 = LoadArm(d, batch.arm, 2, lane);
    const Vec3 t2 = LoadArm(d, batch.arm, 3, lane);
    const auto ratio = [&](Vec3 p, Vec3 q, Vec3 r, Vec3 s) HWY_ATTR {
      const Vec half = hn::Set(d, 0.5F);
      const Vec3 middle = {hn::Mul(half, hn::Add(p.x, q.x)), hn::Mul(half, hn::Add(p.y, q.y)),
                           hn::Mul(half, hn::Add(p.z, q.z))};
      const Vec3 centre = Centre(d, zero, r, s);
      const Vec reach = hn::MulAdd(half, hn::Sqrt(SquaredNorm(Difference(p, q))),
                                   hn::Sqrt(SquaredRadius(centre, zero, r, s)));
      return hn::Div(hn::Sqrt(SquaredNorm(Difference(middle, centre))), reach);
    };
    StoreRules(d, hn::Min(ratio(s1, s2, t1, t2), ratio(t1, t2, s1, s2)), kVertexRatio, rules, lane);
  }
}

const char* InstructionSet() {
  return hwy::TargetName(HWY_TARGET);
}

}  // namespace explica::repulsion::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace explica::repulsion::kernels {

HWY_EXPORT(FarNodes);
HWY_EXPORT(CloseGroups);
HWY_EXPORT(IntegrateApart);
HWY_EXPORT(IntegrateEdge);
HWY_EXPORT(IntegrateVertex);
HWY_EXPORT(ChooseEdgeRules);
HWY_EXPORT(ChooseVertexRules);
HWY_EXPORT(InstructionSet);

void addFarNodes(TargetLeaf& target, int set, const FarNode* nodes, std::size_t count,
                 const float* shift) {
  HWY_DYNAMIC_DISPATCH(FarNodes)(target, set, nodes, count, shift);
}

std::size_t addCloseGroups(TargetLeaf& target, int set, const CloseGroup* groups, std::size_t count,
                           const CloseSources& sources, float nearRatio, const CloseRoom& room) {
  return HWY_DYNAMIC_DISPATCH(CloseGroups)(target, set, groups, count, sources, nearRatio, room);
}

void integrateApart(ApartBatch& batch, bool fine) {
  HWY_DYNAMIC_DISPATCH(IntegrateApart)(batch, fine);
}

void chooseEdgeRules(const EdgeBatch& batch, std::int32_t* rules) {
  HWY_DYNAMIC_DISPATCH(ChooseEdgeRules)(batch, rules);
}

void chooseVertexRules(const VertexBatch& batch, std::int32_t* rules) {
  HWY_DYNAMIC_DISPATCH(ChooseVertexRules)(batch, rules);
}

void integrateEdge(EdgeBatch& batch, int rule) {
  HWY_DYNAMIC_DISPATCH(IntegrateEdge)(batch, rule);
}

void integrateVertex(VertexBatch& batch, int rule) {
  HWY_DYNAMIC_DISPATCH(IntegrateVertex)(batch, rule);
}

const char* instructionSet() {
  return HWY_DYNAMIC_DISPATCH(InstructionSet)();
}

}  // namespace explica::repulsion::kernels
#endif  // HWY_ONCE
