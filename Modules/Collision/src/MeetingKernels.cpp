// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "MeetingKernels.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "MeetingKernels.cpp"
#include <hwy/foreach_target.h>  // IWYU pragma: keep
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace explica::collision::kernels::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using PairTag = hn::CappedTag<double, PairBatch::kLanes>;
using V = hn::Vec<PairTag>;

struct Vec3 {
  V x, y, z;
};

HWY_INLINE Vec3 LoadPoint(const double (&at)[3][PairBatch::kLanes], int n) {
  const PairTag d;
  return {hn::Load(d, at[0] + n), hn::Load(d, at[1] + n), hn::Load(d, at[2] + n)};
}
HWY_INLINE V Dot(const Vec3& a, const Vec3& b) {
  return hn::Add(hn::Add(hn::Mul(a.x, b.x), hn::Mul(a.y, b.y)), hn::Mul(a.z, b.z));
}
HWY_INLINE Vec3 Minus(const Vec3& a, const Vec3& b) {
  return {hn::Sub(a.x, b.x), hn::Sub(a.y, b.y), hn::Sub(a.z, b.z)};
}
HWY_INLINE Vec3 Times(const Vec3& a, V t) {
  return {hn::Mul(a.x, t), hn::Mul(a.y, t), hn::Mul(a.z, t)};
}
HWY_INLINE Vec3 Cross(const Vec3& a, const Vec3& b) {
  return {hn::Sub(hn::Mul(a.y, b.z), hn::Mul(a.z, b.y)),
          hn::Sub(hn::Mul(a.z, b.x), hn::Mul(a.x, b.z)),
          hn::Sub(hn::Mul(a.x, b.y), hn::Mul(a.y, b.x))};
}
template <class M>
HWY_INLINE Vec3 Select(M mask, const Vec3& yes, const Vec3& no) {
  return {hn::IfThenElse(mask, yes.x, no.x), hn::IfThenElse(mask, yes.y, no.y),
          hn::IfThenElse(mask, yes.z, no.z)};
}

/// Keeps a number in [0, 1]; not a number becomes 0 (of what degenerates to a point).
HWY_INLINE V Share(V t) {
  const PairTag d;
  const auto one = hn::Set(d, 1.0);
  const auto below = hn::IfThenElse(hn::Lt(t, one), t, one);
  return hn::IfThenElse(hn::And(hn::Gt(t, hn::Zero(d)), hn::Eq(t, t)), below, hn::Zero(d));
}

/// From the nearest point of the segment a + [0, 1] along to the origin.
HWY_INLINE Vec3 FromSegment(const Vec3& a, const Vec3& along) {
  const V t = Share(hn::Div(hn::Neg(Dot(a, along)), Dot(along, along)));
  const Vec3 nearest = {hn::Add(a.x, hn::Mul(t, along.x)), hn::Add(a.y, hn::Mul(t, along.y)),
                        hn::Add(a.z, hn::Mul(t, along.z))};
  return {hn::Neg(nearest.x), hn::Neg(nearest.y), hn::Neg(nearest.z)};
}

HWY_INLINE Vec3 Unit(const Vec3& v) {
  const PairTag d;
  const V squared = Dot(v, v);
  const auto usable = hn::Gt(squared, hn::Set(d, 1e-280));  // else its square has too few digits
  const V length = hn::IfThenElse(usable, hn::Sqrt(squared), hn::Set(d, kNaN));
  return Times(v, hn::Div(hn::Set(d, 1.0), length));
}

void SeparateVertexFace(PairBatch& batch) {
  const PairTag d;
  const auto zero = hn::Zero(d);
  for (int n = 0; n < PairBatch::kLanes; n += static_cast<int>(hn::Lanes(d))) {
    const Vec3 a = LoadPoint(batch.at[0], n), b = LoadPoint(batch.at[1], n),
               c = LoadPoint(batch.at[2], n);
    const Vec3 ab = Minus(b, a), ac = Minus(c, a), bc = Minus(c, b);
    const Vec3 normal = Cross(ab, ac);
    const V squaredNormal = Dot(normal, normal);
    // Coordinates of the foot of the perpendicular, times squaredNormal.
    const V u = hn::Neg(Dot(Cross(a, ac), normal)), v = hn::Neg(Dot(Cross(ab, a), normal));
    const auto inside =
        hn::And(hn::And(hn::Gt(u, zero), hn::Gt(v, zero)), hn::Lt(hn::Add(u, v), squaredNormal));
    const V height = Dot(a, normal);  // of the face above the vertex, times the normal's length
    const Vec3 across = Times(normal, hn::Neg(height));

    Vec3 near = FromSegment(a, ab);
    V squared = Dot(near, near);
    for (const Vec3& other : {FromSegment(a, ac), FromSegment(b, bc)}) {
      const V squaredOther = Dot(other, other);
      const auto nearer = hn::Lt(squaredOther, squared);
      near = Select(nearer, other, near);
      squared = hn::Min(squaredOther, squared);
    }
    const Vec3 from = Unit(Select(inside, across, near));
    const V farthest = hn::Max(hn::Max(Dot(from, a), Dot(from, b)), Dot(from, c));
    hn::Store(hn::Neg(farthest), d, batch.separation + n);
    const V closing = hn::Max(
        hn::Max(Dot(from, LoadPoint(batch.motion[0], n)), Dot(from, LoadPoint(batch.motion[1], n))),
        Dot(from, LoadPoint(batch.motion[2], n)));
    hn::Store(closing, d, batch.closing + n);
  }
}

void SeparateEdgeEdge(PairBatch& batch) {
  const PairTag d;
  const auto zero = hn::Zero(d);
  for (int n = 0; n < PairBatch::kLanes; n += static_cast<int>(hn::Lanes(d))) {
    const Vec3 u = LoadPoint(batch.at[0], n), c = LoadPoint(batch.at[1], n),
               e = LoadPoint(batch.at[2], n);
    const Vec3 v = Minus(e, c);
    const Vec3 normal = Cross(u, v);
    const V squaredNormal = Dot(normal, normal);
    // Parameters of the lines' nearest points, times squaredNormal.
    const V s = Dot(Cross(c, v), normal), t = Dot(Cross(c, u), normal);
    const auto inside = hn::And(hn::And(hn::Gt(s, zero), hn::Lt(s, squaredNormal)),
                                hn::And(hn::Gt(t, zero), hn::Lt(t, squaredNormal)));
    const Vec3 across = Times(normal, hn::Neg(Dot(c, normal)));

    // Ends of one against the other, as first minus second.
    Vec3 near = FromSegment(c, v);
    V squared = Dot(near, near);
    const auto consider = [&](const Vec3& other) HWY_ATTR {
      const V squaredOther = Dot(other, other);
      near = Select(hn::Lt(squaredOther, squared), other, near);
      squared = hn::Min(squaredOther, squared);
    };
    consider(FromSegment(Minus(c, u), v));
    const Vec3 zeroPoint = {zero, zero, zero};
    const auto ofFirst = [&](const Vec3& end) HWY_ATTR {  // the first edge seen from an end
      return Minus(zeroPoint, FromSegment(Minus(zeroPoint, end), u));
    };
    consider(ofFirst(c));
    consider(ofFirst(e));
    const Vec3 from = Unit(Select(inside, across, near));
    const V ownLeast = hn::Min(zero, Dot(from, u));
    hn::Store(hn::Sub(ownLeast, hn::Max(Dot(from, c), Dot(from, e))), d, batch.separation + n);
    const V motionLeast = hn::Min(zero, Dot(from, LoadPoint(batch.motion[0], n)));
    const V motionMost =
        hn::Max(Dot(from, LoadPoint(batch.motion[1], n)), Dot(from, LoadPoint(batch.motion[2], n)));
    hn::Store(hn::Sub(motionMost, motionLeast), d, batch.closing + n);
  }
}

}  // namespace explica::collision::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace explica::collision::kernels {

HWY_EXPORT(SeparateVertexFace);
HWY_EXPORT(SeparateEdgeEdge);

void separateVertexFace(PairBatch& batch) {
  HWY_DYNAMIC_DISPATCH(SeparateVertexFace)(batch);
}

void separateEdgeEdge(PairBatch& batch) {
  HWY_DYNAMIC_DISPATCH(SeparateEdgeEdge)(batch);
}

}  // namespace explica::collision::kernels
#endif  // HWY_ONCE
