// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Kernels.h"

#include "Quadrature.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

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

const char* instructionSet() {
  return HWY_DYNAMIC_DISPATCH(InstructionSet)();
}

}  // namespace explica::repulsion::kernels
#endif  // HWY_ONCE
