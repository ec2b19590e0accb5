// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Kernels.h"

#include "Quadrature.h"

#include <array>
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
    for (const RulePoint& p : composite(triangleRule16(), partsOfTriangle(halvings))) {
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

inline std::vector<ArmPoint<4>> vertexPoints(Rule segment, Rule triangle, int halvings) {
  std::vector<ArmPoint<4>> result;
  for (const bool edgeOfS : {true, false}) {
    for (const RulePoint& e : composite(segment, partsOfSegment(halvings))) {
      for (const RulePoint& f : composite(triangle, partsOfTriangle(halvings))) {
        const double edge[2] = {e.lambda[0], e.lambda[1]};
        const double face[2] = {f.lambda[1], f.lambda[2]};
        const double* s = edgeOfS ? edge : face;
        const double* t = edgeOfS ? face : edge;
        result.push_back({static_cast<float>(e.weight * f.weight),
                          {static_cast<float>(s[0]), static_cast<float>(s[1]),
                           static_cast<float>(-t[0]), static_cast<float>(-t[1])}});
      }
    }
  }
  return result;
}

inline const std::vector<ArmPoint<3>>& edgeRule(int rule) {
  static const std::array<std::vector<ArmPoint<3>>, kRules> rules = {edgePoints(0), edgePoints(1),
                                                                     edgePoints(2), edgePoints(3)};
  return rules[rule];
}

inline const std::vector<ArmPoint<4>>& vertexRule(int rule) {
  static const std::array<std::vector<ArmPoint<4>>, kRules> rules = {
      vertexPoints(segmentRule3(), triangleRule7(), 0),
      vertexPoints(segmentRule4(), triangleRule12(), 0),
      vertexPoints(segmentRule4(), triangleRule12(), 1),
      vertexPoints(segmentRule4(), triangleRule12(), 2)};
  return rules[rule];
}

}  // namespace explica::repulsion::kernels
#endif  // EXPLICA_REPULSION_KERNEL_TABLES

HWY_BEFORE_NAMESPACE();
namespace explica::repulsion::kernels::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Tag = hn::CappedTag<float, kLanes>;
using Vec = hn::Vec<Tag>;

HWY_INLINE Vec reciprocal(Tag d, Vec x) {
  const Vec two = hn::Set(d, 2.0F);
  Vec r = hn::ApproximateReciprocal(x);
  r = hn::Mul(r, hn::NegMulAdd(x, r, two));
#if !HWY_ARCH_X86
  r = hn::Mul(r, hn::NegMulAdd(x, r, two));
#endif
  return r;
}

HWY_INLINE Vec squaredNorm(Tag d, Vec x, Vec y, Vec z) {
  return hn::MulAdd(x, x, hn::MulAdd(y, y, hn::MulAdd(z, z, hn::Set(d, kTiny))));
}

/// What a node contributes at r: phi, its gradient = radial r + turn Q r, and s = 1/r^2.
struct NodeTerm {
  Vec s, phi, radial, gx, gy, gz;
};

HWY_INLINE NodeTerm TermOf(Tag d, const FarNode& n, Vec rx, Vec ry, Vec rz) {
  NodeTerm t;
  t.s = reciprocal(d, squaredNorm(d, rx, ry, rz));
  const Vec xy = hn::Set(d, n.xy);
  const Vec xz = hn::Set(d, n.xz);
  const Vec yz = hn::Set(d, n.yz);
  const Vec ux = hn::MulAdd(hn::Set(d, n.xx), rx, hn::MulAdd(xy, ry, hn::Mul(xz, rz)));
  const Vec uy = hn::MulAdd(xy, rx, hn::MulAdd(hn::Set(d, n.yy), ry, hn::Mul(yz, rz)));
  const Vec uz = hn::MulAdd(xz, rx, hn::MulAdd(yz, ry, hn::Mul(hn::Set(d, n.zz), rz)));
  const Vec qs = hn::Mul(t.s, hn::MulAdd(ux, rx, hn::MulAdd(uy, ry, hn::Mul(uz, rz))));
  const Vec mass = hn::Set(d, n.mass);
  const Vec trace = hn::Set(d, n.trace);
  const Vec four = hn::Set(d, 4.0F);
  // phi = s (m + s (4 q s - trace)), q = r . Q r
  t.phi = hn::Mul(t.s, hn::MulAdd(t.s, hn::MulSub(four, qs, trace), mass));
  // grad phi = s^2 ((-2 m + s (4 trace - 24 q s)) r + 8 s Q r)
  const Vec s2 = hn::Mul(t.s, t.s);
  const Vec bend = hn::Mul(t.s, hn::MulAdd(four, trace, hn::Mul(hn::Set(d, -24.0F), qs)));
  t.radial = hn::Mul(s2, hn::MulAdd(hn::Set(d, -2.0F), mass, bend));
  const Vec turn = hn::Mul(hn::Mul(s2, t.s), hn::Set(d, 8.0F));
  t.gx = hn::MulAdd(t.radial, rx, hn::Mul(turn, ux));
  t.gy = hn::MulAdd(t.radial, ry, hn::Mul(turn, uy));
  t.gz = hn::MulAdd(t.radial, rz, hn::Mul(turn, uz));
  return t;
}

HWY_INLINE void AddTo(Tag d, Vec value, float* to) {
  hn::Store(hn::Add(value, hn::Load(d, to)), d, to);
}

void FarNodes(TargetLeaf& target, int set, const FarNode* HWY_RESTRICT nodes, std::size_t count) {
  const Tag d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  for (int lane = 0; lane < kLanes; lane += lanes) {
    for (int q = 0; q < 3; ++q) {
      const Vec x = hn::Load(d, target.point[q][0] + lane);
      const Vec y = hn::Load(d, target.point[q][1] + lane);
      const Vec z = hn::Load(d, target.point[q][2] + lane);
      Vec phi = hn::Zero(d), gx = hn::Zero(d), gy = hn::Zero(d), gz = hn::Zero(d);
      for (std::size_t i = 0; i < count; ++i) {
        const FarNode& n = nodes[i];
        const NodeTerm t =
            TermOf(d, n, hn::Sub(x, hn::Set(d, n.centre[0])), hn::Sub(y, hn::Set(d, n.centre[1])),
                   hn::Sub(z, hn::Set(d, n.centre[2])));
        phi = hn::Add(phi, t.phi);
        gx = hn::Add(gx, t.gx);
        gy = hn::Add(gy, t.gy);
        gz = hn::Add(gz, t.gz);
      }
      AddTo(d, phi, target.phi[set][q] + lane);
      AddTo(d, gx, target.g[q][0] + lane);
      AddTo(d, gy, target.g[q][1] + lane);
      AddTo(d, gz, target.g[q][2] + lane);
    }
  }
}

void FarthestNodes(TargetLeaf& target, int set, const FarNode* HWY_RESTRICT nodes,
                   std::size_t count) {
  const Tag d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  const Vec half = hn::Set(d, 0.5F);
  for (int lane = 0; lane < kLanes; lane += lanes) {
    const Vec x = hn::Load(d, target.centroid[0] + lane);
    const Vec y = hn::Load(d, target.centroid[1] + lane);
    const Vec z = hn::Load(d, target.centroid[2] + lane);
    Vec phi = hn::Zero(d), gx = hn::Zero(d), gy = hn::Zero(d), gz = hn::Zero(d);
    // Second derivatives: diagonal I + the rest.
    Vec diagonal = hn::Zero(d), xx = hn::Zero(d), yy = hn::Zero(d), zz = hn::Zero(d);
    Vec xy = hn::Zero(d), xz = hn::Zero(d), yz = hn::Zero(d);
    for (std::size_t i = 0; i < count; ++i) {
      const FarNode& n = nodes[i];
      const Vec rx = hn::Sub(x, hn::Set(d, n.centre[0]));
      const Vec ry = hn::Sub(y, hn::Set(d, n.centre[1]));
      const Vec rz = hn::Sub(z, hn::Set(d, n.centre[2]));
      const NodeTerm t = TermOf(d, n, rx, ry, rz);
      phi = hn::Add(phi, t.phi);
      gx = hn::Add(gx, t.gx);
      gy = hn::Add(gy, t.gy);
      gz = hn::Add(gz, t.gz);
      // d2 (m s) = -2 m s^2 I + 8 m s^3 r r^T, with the nodes' own radial part in place of -2 m s^2
      diagonal = hn::Add(diagonal, t.radial);
      const Vec c = hn::Mul(hn::Mul(hn::Set(d, -4.0F), t.s), t.radial);
      const Vec cx = hn::Mul(c, rx);
      const Vec cy = hn::Mul(c, ry);
      xx = hn::MulAdd(cx, rx, xx);
      xy = hn::MulAdd(cx, ry, xy);
      xz = hn::MulAdd(cx, rz, xz);
      yy = hn::MulAdd(cy, ry, yy);
      yz = hn::MulAdd(cy, rz, yz);
      zz = hn::MulAdd(hn::Mul(c, rz), rz, zz);
    }
    xx = hn::Add(xx, diagonal);
    yy = hn::Add(yy, diagonal);
    zz = hn::Add(zz, diagonal);
    for (int q = 0; q < 3; ++q) {
      const Vec dx = hn::Sub(hn::Load(d, target.point[q][0] + lane), x);
      const Vec dy = hn::Sub(hn::Load(d, target.point[q][1] + lane), y);
      const Vec dz = hn::Sub(hn::Load(d, target.point[q][2] + lane), z);
      const Vec hx = hn::MulAdd(xx, dx, hn::MulAdd(xy, dy, hn::Mul(xz, dz)));
      const Vec hy = hn::MulAdd(xy, dx, hn::MulAdd(yy, dy, hn::Mul(yz, dz)));
      const Vec hz = hn::MulAdd(xz, dx, hn::MulAdd(yz, dy, hn::Mul(zz, dz)));
      const auto dot = [&](Vec ax, Vec ay, Vec az) HWY_ATTR {
        return hn::MulAdd(ax, dx, hn::MulAdd(ay, dy, hn::Mul(az, dz)));
      };
      AddTo(d, hn::Add(phi, hn::MulAdd(half, dot(hx, hy, hz), dot(gx, gy, gz))),
            target.phi[set][q] + lane);
      AddTo(d, hn::Add(gx, hx), target.g[q][0] + lane);
      AddTo(d, hn::Add(gy, hy), target.g[q][1] + lane);
      AddTo(d, hn::Add(gz, hz), target.g[q][2] + lane);
    }
  }
}

/// Targets, one bit each, to which a face is nearer than `nearRatio` sums of radii; the weights
/// that the others take are written if there are any.
HWY_INLINE std::uint32_t NearTargets(const TargetLeaf& target, const float* centroid, float radius,
                                     float nearRatio, float weight, float* weights) {
  const Tag d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  std::uint32_t flags = 0;
  for (int lane = 0; lane < kLanes; lane += lanes) {
    const Vec dx = hn::Sub(hn::Load(d, target.centroid[0] + lane), hn::Set(d, centroid[0]));
    const Vec dy = hn::Sub(hn::Load(d, target.centroid[1] + lane), hn::Set(d, centroid[1]));
    const Vec dz = hn::Sub(hn::Load(d, target.centroid[2] + lane), hn::Set(d, centroid[2]));
    const Vec reach = hn::Mul(hn::Set(d, nearRatio),
                              hn::Add(hn::Load(d, target.radius + lane), hn::Set(d, radius)));
    const auto isNear = hn::Lt(squaredNorm(d, dx, dy, dz), hn::Mul(reach, reach));
    hn::Store(hn::IfThenZeroElse(isNear, hn::Set(d, weight)), d, weights + lane);
    std::uint8_t bits[8] = {0, 0, 0, 0, 0, 0, 0, 0};
    hn::StoreMaskBits(d, isNear, bits);
    flags |= (static_cast<std::uint32_t>(bits[0]) | (static_cast<std::uint32_t>(bits[1]) << 8))
             << lane;
  }
  return flags;
}

std::size_t CloseLeaves(TargetLeaf& target, int set, const CloseLeaf* HWY_RESTRICT leaves,
                        std::size_t count, float nearRatio, const CloseRoom& room) {
  std::size_t hitCount = 0;
  std::size_t clearCount = 0;
  for (std::size_t l = 0; l < count; ++l) {
    const CloseLeaf& leaf = leaves[l];
    const float offset[4] = {leaf.offset[0], leaf.offset[1], leaf.offset[2], 0};
    for (std::int32_t f = 0; f < leaf.count; ++f) {
      const SourceFace& source = leaf.faces[f];
      float(*to)[4] = room.clear[clearCount].point;
      bool clear = true;
      if (leaf.mayTouch) {
        const float centroid[3] = {source.centroid[0] + offset[0], source.centroid[1] + offset[1],
                                   source.centroid[2] + offset[2]};
        MaskedFace& masked = room.masked[hitCount];
        const std::uint32_t flags = NearTargets(target, centroid, source.radius, nearRatio,
                                                source.point[0][3], masked.weight);
        if (flags != 0) {
          room.hits[hitCount++] = {leaf.first + f, flags};
          to = masked.point;
          clear = false;
        }
      }
      for (int p = 0; p < 3; ++p) {
        for (int a = 0; a < 4; ++a) to[p][a] = source.point[p][a] + offset[a];
      }
      if (clear) ++clearCount;
    }
  }

  const Tag d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  const Vec minusTwo = hn::Set(d, -2.0F);
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
      for (std::size_t i = 0; i < clearCount; ++i) {
        for (const auto& point : room.clear[i].point) add(point, hn::Set(d, point[3]));
      }
      for (std::size_t i = 0; i < hitCount; ++i) {
        const Vec weight = hn::Load(d, room.masked[i].weight + lane);
        for (int p = 0; p < 3; ++p) add(room.masked[i].point[p], weight);
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
void IntegrateVertex(VertexBatch& batch, int rule) {
  Reduced<4>(batch, vertexRule(rule));
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

template <class T, class D, class Invert>
HWY_INLINE void AllCentroids(D d, const Invert& invert, const CentroidSum<T>& sum,
                             std::size_t begin, std::size_t end) {
  using V = hn::Vec<D>;
  for (std::size_t i = begin; i < end; i += hn::Lanes(d)) {
    const V xi = hn::LoadU(d, sum.x + i);
    const V yi = hn::LoadU(d, sum.y + i);
    const V zi = hn::LoadU(d, sum.z + i);
    V phi = hn::Zero(d), ax = hn::Zero(d), ay = hn::Zero(d), az = hn::Zero(d);
    for (std::size_t j = 0; j < sum.count; ++j) {
      const V rx = hn::Sub(xi, hn::Set(d, sum.x[j]));
      const V ry = hn::Sub(yi, hn::Set(d, sum.y[j]));
      const V rz = hn::Sub(zi, hn::Set(d, sum.z[j]));
      const V squared = hn::MulAdd(rx, rx, hn::MulAdd(ry, ry, hn::Mul(rz, rz)));
      const V s = hn::IfThenZeroElse(hn::Eq(squared, hn::Zero(d)), invert(squared));
      const V term = hn::Mul(hn::Set(d, sum.w[j]), s);
      phi = hn::Add(phi, term);
      const V pull = hn::Mul(term, s);
      ax = hn::MulAdd(pull, rx, ax);
      ay = hn::MulAdd(pull, ry, ay);
      az = hn::MulAdd(pull, rz, az);
    }
    const V factor = hn::Set(d, T{-2});
    hn::StoreU(phi, d, sum.phi + i);
    hn::StoreU(hn::Mul(factor, ax), d, sum.gx + i);
    hn::StoreU(hn::Mul(factor, ay), d, sum.gy + i);
    hn::StoreU(hn::Mul(factor, az), d, sum.gz + i);
  }
}

void CentroidsSingle(const CentroidSum<float>& sum, std::size_t begin, std::size_t end) {
  const Tag d;
  AllCentroids(
      d, [d](Vec x) HWY_ATTR { return reciprocal(d, x); }, sum, begin, end);
}

#if HWY_HAVE_FLOAT64
void CentroidsDouble(const CentroidSum<double>& sum, std::size_t begin, std::size_t end) {
  const hn::CappedTag<double, kLanes> d;
  using V = hn::Vec<decltype(d)>;
  AllCentroids(
      d, [d](V x) HWY_ATTR { return hn::Div(hn::Set(d, 1.0), x); }, sum, begin, end);
}
#else
void CentroidsDouble(const CentroidSum<double>&, std::size_t, std::size_t) {}
#endif

const char* InstructionSet() {
  return hwy::TargetName(HWY_TARGET);
}

}  // namespace explica::repulsion::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace explica::repulsion::kernels {

HWY_EXPORT(FarNodes);
HWY_EXPORT(FarthestNodes);
HWY_EXPORT(CloseLeaves);
HWY_EXPORT(IntegrateApart);
HWY_EXPORT(IntegrateEdge);
HWY_EXPORT(IntegrateVertex);
HWY_EXPORT(ChooseEdgeRules);
HWY_EXPORT(ChooseVertexRules);
HWY_EXPORT(CentroidsSingle);
HWY_EXPORT(CentroidsDouble);
HWY_EXPORT(InstructionSet);

void addFarNodes(TargetLeaf& target, int set, const FarNode* nodes, std::size_t count) {
  HWY_DYNAMIC_DISPATCH(FarNodes)(target, set, nodes, count);
}

void addFarthestNodes(TargetLeaf& target, int set, const FarNode* nodes, std::size_t count) {
  HWY_DYNAMIC_DISPATCH(FarthestNodes)(target, set, nodes, count);
}

std::size_t addCloseLeaves(TargetLeaf& target, int set, const CloseLeaf* leaves, std::size_t count,
                           float nearRatio, const CloseRoom& room) {
  return HWY_DYNAMIC_DISPATCH(CloseLeaves)(target, set, leaves, count, nearRatio, room);
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

void sumCentroids(const CentroidSum<float>& sum, std::size_t begin, std::size_t end) {
  HWY_DYNAMIC_DISPATCH(CentroidsSingle)(sum, begin, end);
}

void sumCentroids(const CentroidSum<double>& sum, std::size_t begin, std::size_t end) {
  HWY_DYNAMIC_DISPATCH(CentroidsDouble)(sum, begin, end);
}

const char* instructionSet() {
  return HWY_DYNAMIC_DISPATCH(InstructionSet)();
}

}  // namespace explica::repulsion::kernels
#endif  // HWY_ONCE
