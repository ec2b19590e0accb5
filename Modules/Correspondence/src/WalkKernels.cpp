// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "WalkKernels.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "WalkKernels.cpp"
#include <hwy/foreach_target.h>  // IWYU pragma: keep
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace explica::correspondence::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Real = hn::CappedTag<double, kBeside>;
using Whole = hn::Rebind<std::int32_t, Real>;
using Single = hn::Rebind<float, Real>;
using Corner = hn::CappedTag<float, 4>;  // or a part of one
using RealVec = hn::Vec<Real>;

/// Samples beside each other: gradient per voxel and u at each lane's place.
struct alignas(64) Found {
  float f[3][kBeside];           // place in the cell
  std::int32_t place[kBeside];   // of the cell
  const float* row[kBeside][4];  // of the cell's edges along the first axis, two corners each
  float value[kBeside][4];
  double u[kBeside];
  std::int32_t home[kBeside];  // -1: no tissue; -2: not looked for
  bool odd[kBeside], divided[kBeside];
};

HWY_INLINE void FindCells(const FieldView& view, const Lanes& x, Found& found) {
  const Real d;
  const Whole di;
  const Single df;
  const std::int32_t stride[3] = {1, view.size[0], view.size[0] * view.size[1]};
  for (std::size_t l = 0; l < kBeside; l += hn::Lanes(d)) {
    auto place = hn::Zero(di);
    for (int a = 0; a < 3; ++a) {
      const auto at = hn::Load(d, x[a].data() + l);
      const auto base =
          hn::Min(hn::Max(hn::DemoteTo(di, at), hn::Zero(di)), hn::Set(di, view.size[a] - 2));
      hn::Store(hn::DemoteTo(df, hn::Sub(at, hn::PromoteTo(d, base))), df, found.f[a] + l);
      place = hn::Add(place, hn::Mul(base, hn::Set(di, stride[a])));
    }
    hn::Store(place, di, found.place + l);
  }
}

/// Where the corners of each lane's cell lie in memory; lanes of other cells are odd or have none.
HWY_INLINE void FindRows(const FieldView& view, int count, Found& found) {
  const std::int32_t along = view.size[0], across = view.size[0] * view.size[1];
  for (int l = 0; l < count; ++l) {
    const std::int32_t p = found.place[l], cell = view.cellAt[p];
    found.home[l] = cell == kEmpty ? -1 : -2;
    found.odd[l] = cell < kEmpty || (view.planar && cell != kEmpty);
    found.divided[l] = false;
    if (found.odd[l]) {
      found.row[l][0] = nullptr;
    } else if (cell == kWhole) {  // ranks follow each other along a row
      const std::int32_t* rank = view.rankAt + p;
      found.row[l][0] = view.node + 4 * static_cast<std::ptrdiff_t>(rank[0]);
      found.row[l][1] = view.node + 4 * static_cast<std::ptrdiff_t>(rank[along]);
      found.row[l][2] = view.node + 4 * static_cast<std::ptrdiff_t>(rank[across]);
      found.row[l][3] = view.node + 4 * static_cast<std::ptrdiff_t>(rank[across + along]);
    } else {
      const float* corner =
          cell >= 0 ? view.cells + 32 * static_cast<std::ptrdiff_t>(cell) : nullptr;
      for (int e = 0; e < 4; ++e) found.row[l][e] = cell >= 0 ? corner + 8 * e : nullptr;
    }
  }
}

using CornerVec = hn::Vec<Corner>;

HWY_INLINE CornerVec Between(CornerVec low, CornerVec high, CornerVec f) {
  return hn::Add(low, hn::Mul(f, hn::Sub(high, low)));
}

/// Trilinear in gradient and u, the first axis last; then u's half-Taylor term, which turns each
/// axis' linear error f (1 - f) / 2 times the difference of slopes into one of third order.
template <bool kWithU>
HWY_INLINE void Interpolate(int l, Found& found) {
  const Corner d;
  const float fx = found.f[0][l], fy = found.f[1][l], fz = found.f[2][l];
  const auto x = hn::Set(d, fx), y = hn::Set(d, fy), z = hn::Set(d, fz);
  alignas(16) float bend[3][4];
  for (std::size_t c = 0; c < 4; c += hn::Lanes(d)) {
    CornerVec end[2], alongY[2], alongZ[2];
    for (std::size_t e = 0; e < 2; ++e) {
      const auto corner0 = hn::LoadU(d, found.row[l][0] + 4 * e + c);
      const auto corner1 = hn::LoadU(d, found.row[l][1] + 4 * e + c);
      const auto corner2 = hn::LoadU(d, found.row[l][2] + 4 * e + c);
      const auto corner3 = hn::LoadU(d, found.row[l][3] + 4 * e + c);
      const auto lowY = hn::Sub(corner1, corner0), highY = hn::Sub(corner3, corner2);
      const auto low = hn::Add(corner0, hn::Mul(y, lowY));
      const auto high = hn::Add(corner2, hn::Mul(y, highY));
      alongZ[e] = hn::Sub(high, low);
      end[e] = hn::Add(low, hn::Mul(z, alongZ[e]));
      if constexpr (kWithU) alongY[e] = Between(lowY, highY, z);
    }
    const auto alongX = hn::Sub(end[1], end[0]);
    hn::Store(hn::Add(end[0], hn::Mul(x, alongX)), d, found.value[l] + c);
    if constexpr (kWithU) {
      hn::Store(alongX, d, bend[0] + c);
      hn::Store(Between(alongY[0], alongY[1], x), d, bend[1] + c);
      hn::Store(Between(alongZ[0], alongZ[1], x), d, bend[2] + c);
    }
  }
  if constexpr (kWithU) {
    const float sum =
        fx * (1 - fx) * bend[0][0] + fy * (1 - fy) * bend[1][1] + fz * (1 - fz) * bend[2][2];
    found.u[l] = static_cast<double>(found.value[l][3]) - 0.5 * static_cast<double>(sum);
  }
}

/// @param home  tissue voxels that tell the sides, -1 where none does
template <bool kWithU>
HWY_INLINE void Sample(const FieldView& view, const Lanes& x, const std::int32_t* home, int count,
                       Found& found) {
  FindCells(view, x, found);
  FindRows(view, count, found);
  for (int l = 0; l < count; ++l) {
    if (found.row[l][0] != nullptr) {
      Interpolate<kWithU>(l, found);
      continue;
    }
    FieldView::Odd sample;
    if (found.odd[l]) {
      const double at[3] = {x[0][l], x[1][l], x[2][l]};
      sample = view.odd(view.field, at, home[l]);
    }
    for (int c = 0; c < 4; ++c) found.value[l][c] = sample.value[c];
    found.u[l] = sample.u;
    found.home[l] = sample.home;
    found.divided[l] = sample.divided;
  }
  for (int l = count; l < kBeside; ++l) {
    for (float& value : found.value[l]) value = 0;
  }
}

/// Unit tangents uphill (or downhill), per mm; zero where u is flat.
HWY_INLINE void Velocities(const FieldView& view, const float* values, double uphill,
                           Lanes& velocity, Lane* slope) {
  const Real d;
  const Single df;
  for (std::size_t l = 0; l < kBeside; l += hn::Lanes(d)) {
    hn::Vec<Single> g0, g1, g2, u;
    hn::LoadInterleaved4(df, values + 4 * l, g0, g1, g2, u);
    const auto inverse0 = hn::Set(d, view.inverseSpacing[0]);
    const auto inverse1 = hn::Set(d, view.inverseSpacing[1]);
    const auto inverse2 = hn::Set(d, view.inverseSpacing[2]);
    const auto x = hn::Mul(hn::PromoteTo(d, g0), inverse0);
    const auto y = hn::Mul(hn::PromoteTo(d, g1), inverse1);
    const auto z = hn::Mul(hn::PromoteTo(d, g2), inverse2);
    const auto norm = hn::Sqrt(hn::Add(hn::Add(hn::Mul(x, x), hn::Mul(y, y)), hn::Mul(z, z)));
    const auto scale = hn::IfThenElseZero(hn::Gt(norm, hn::Set(d, view.leastSlope)),
                                          hn::Div(hn::Set(d, uphill), norm));
    hn::Store(hn::Mul(scale, hn::Mul(x, inverse0)), d, velocity[0].data() + l);
    hn::Store(hn::Mul(scale, hn::Mul(y, inverse1)), d, velocity[1].data() + l);
    hn::Store(hn::Mul(scale, hn::Mul(z, inverse2)), d, velocity[2].data() + l);
    if (slope != nullptr) hn::Store(norm, d, slope->data() + l);
  }
}

/// from + share * step * velocity
HWY_INLINE void Advance(const Lanes& from, double share, const Lane& step, const Lanes& velocity,
                        Lanes& to) {
  const Real d;
  for (std::size_t l = 0; l < kBeside; l += hn::Lanes(d)) {
    const auto s = hn::Mul(hn::Set(d, share), hn::Load(d, step.data() + l));
    for (int a = 0; a < 3; ++a) {
      const auto way = hn::Mul(s, hn::Load(d, velocity[a].data() + l));
      hn::Store(hn::Add(hn::Load(d, from[a].data() + l), way), d, to[a].data() + l);
    }
  }
}

/// The third-order step's mean velocity.
HWY_INLINE RealVec Mean(RealVec k1, RealVec k2, RealVec k3) {
  const Real d;
  return hn::Add(hn::Add(hn::Mul(hn::Set(d, 2.0 / 9), k1), hn::Mul(hn::Set(d, 1.0 / 3), k2)),
                 hn::Mul(hn::Set(d, 4.0 / 9), k3));
}

void TryStep(const FieldView& view, StepLanes& lanes) {
  const Real d;
  Found found;
  Lanes at;
  const int count = lanes.count;
  const std::int32_t* home = lanes.home.data();
  Advance(lanes.x, 0.5, lanes.step, lanes.velocity, at);
  Sample<false>(view, at, home, count, found);
  for (int l = 0; l < count; ++l) lanes.lost[l] = found.home[l] == -1;
  Velocities(view, found.value[0], lanes.uphill, lanes.k2, nullptr);
  Advance(lanes.x, 0.75, lanes.step, lanes.k2, at);
  Sample<false>(view, at, home, count, found);
  for (int l = 0; l < count; ++l) lanes.lost[l] |= found.home[l] == -1;
  Velocities(view, found.value[0], lanes.uphill, lanes.k3, nullptr);
  for (std::size_t l = 0; l < kBeside; l += hn::Lanes(d)) {
    const auto step = hn::Load(d, lanes.step.data() + l);
    for (int a = 0; a < 3; ++a) {
      const auto mean =
          Mean(hn::Load(d, lanes.velocity[a].data() + l), hn::Load(d, lanes.k2[a].data() + l),
               hn::Load(d, lanes.k3[a].data() + l));
      hn::Store(hn::Add(hn::Load(d, lanes.x[a].data() + l), hn::Mul(step, mean)), d,
                lanes.end[a].data() + l);
    }
  }
  Sample<true>(view, lanes.end, home, count, found);
  Velocities(view, found.value[0], lanes.uphill, lanes.k4, &lanes.slope);
  for (int l = 0; l < count; ++l) {
    lanes.lost[l] |= found.home[l] == -1;
    lanes.endHome[l] = found.home[l];
    lanes.divided[l] = found.divided[l];
    lanes.nearest[l] = (found.f[0][l] > 0.5F ? 1 : 0) + (found.f[1][l] > 0.5F ? 2 : 0) +
                       (found.f[2][l] > 0.5F ? 4 : 0);
    lanes.cell[l] = found.place[l];
    lanes.u[l] = found.u[l];
  }
  for (std::size_t l = 0; l < kBeside; l += hn::Lanes(d)) {
    auto squared = hn::Zero(d);
    for (int a = 0; a < 3; ++a) {
      const auto one =
          hn::Add(hn::Mul(hn::Set(d, -5.0 / 72), hn::Load(d, lanes.velocity[a].data() + l)),
                  hn::Mul(hn::Set(d, 1.0 / 12), hn::Load(d, lanes.k2[a].data() + l)));
      const auto two = hn::Sub(hn::Mul(hn::Set(d, 1.0 / 9), hn::Load(d, lanes.k3[a].data() + l)),
                               hn::Mul(hn::Set(d, 1.0 / 8), hn::Load(d, lanes.k4[a].data() + l)));
      const auto sum = hn::Add(one, two);
      squared = hn::Add(squared, hn::Mul(sum, sum));
    }
    hn::Store(hn::Mul(hn::Load(d, lanes.step.data() + l), hn::Sqrt(squared)), d,
              lanes.error.data() + l);
  }
}

}  // namespace explica::correspondence::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace explica::correspondence {

HWY_EXPORT(TryStep);

void tryStep(const FieldView& view, StepLanes& lanes) {
  HWY_DYNAMIC_DISPATCH(TryStep)(view, lanes);
}

}  // namespace explica::correspondence
#endif  // HWY_ONCE
