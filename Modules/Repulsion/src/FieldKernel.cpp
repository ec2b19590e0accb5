// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "FieldKernel.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "FieldKernel.cpp"
#include <hwy/foreach_target.h>  // IWYU pragma: keep
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace explica::repulsion::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using FieldTag = hn::CappedTag<float, kGroupFaces>;
using FieldVector = hn::Vec<FieldTag>;

void AddField(FieldPoints& points, std::span<const FieldCluster> clusters,
              std::span<const FieldPoint> sources) {
  const FieldTag d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  const auto all = [&](float x) HWY_ATTR { return hn::Set(d, x); };
  const auto dot = [&](auto ax, auto bx, auto ay, auto by, auto az, auto bz)
                       HWY_ATTR { return hn::MulAdd(ax, bx, hn::MulAdd(ay, by, hn::Mul(az, bz))); };
  for (int n = 0; n < FieldPoints::kCount; n += lanes) {
    const FieldVector px = hn::Load(d, points.at[0] + n);
    const FieldVector py = hn::Load(d, points.at[1] + n);
    const FieldVector pz = hn::Load(d, points.at[2] + n);
    FieldVector phi = hn::Zero(d), gx = hn::Zero(d), gy = hn::Zero(d), gz = hn::Zero(d);
    for (const FieldPoint& source : sources) {
      const FieldVector x = hn::Sub(px, all(source.centre[0]));
      const FieldVector y = hn::Sub(py, all(source.centre[1]));
      const FieldVector z = hn::Sub(pz, all(source.centre[2]));
      const std::uint64_t bits = source.acts >> (n % kGroupFaces);
      const auto acts = hn::LoadMaskBits(d, reinterpret_cast<const std::uint8_t*>(&bits));
      const FieldVector s = hn::IfThenElseZero(acts, hn::Div(all(1), dot(x, x, y, y, z, z)));
      const FieldVector term = hn::Mul(all(source.area), s);
      const FieldVector pull = hn::Mul(hn::Mul(all(-2), term), s);
      phi = hn::Add(phi, term);
      gx = hn::MulAdd(pull, x, gx);
      gy = hn::MulAdd(pull, y, gy);
      gz = hn::MulAdd(pull, z, gz);
    }
    for (const FieldCluster& source : clusters) {
      const FieldVector x = hn::Sub(px, all(source.centre[0]));
      const FieldVector y = hn::Sub(py, all(source.centre[1]));
      const FieldVector z = hn::Sub(pz, all(source.centre[2]));
      const FieldVector area = all(source.area);
      const FieldVector xx = all(source.second[0]), yy = all(source.second[1]);
      const FieldVector zz = all(source.second[2]), xy = all(source.second[3]);
      const FieldVector xz = all(source.second[4]), yz = all(source.second[5]);
      const FieldVector s = hn::Div(all(1), dot(x, x, y, y, z, z));
      const FieldVector mx = dot(xx, x, xy, y, xz, z);
      const FieldVector my = dot(xy, x, yy, y, yz, z);
      const FieldVector mz = dot(xz, x, yz, y, zz, z);
      const FieldVector trace = hn::Add(xx, hn::Add(yy, zz));
      const FieldVector along = hn::Mul(all(4), hn::Mul(s, dot(mx, x, my, y, mz, z)));
      phi = hn::MulAdd(s, hn::MulAdd(s, hn::Sub(along, trace), area), phi);
      // gradient = s^2 ((s (4 tr M - 6 along) - 2 A) d + 8 s M d)
      const FieldVector bend = hn::MulSub(all(4), trace, hn::Mul(all(6), along));
      const FieldVector squared = hn::Mul(s, s);
      const FieldVector pull = hn::Mul(squared, hn::MulAdd(s, bend, hn::Mul(all(-2), area)));
      const FieldVector turn = hn::Mul(all(8), hn::Mul(squared, s));
      gx = hn::MulAdd(pull, x, hn::MulAdd(turn, mx, gx));
      gy = hn::MulAdd(pull, y, hn::MulAdd(turn, my, gy));
      gz = hn::MulAdd(pull, z, hn::MulAdd(turn, mz, gz));
    }
    hn::Store(phi, d, points.phi + n);
    hn::Store(gx, d, points.gradient[0] + n);
    hn::Store(gy, d, points.gradient[1] + n);
    hn::Store(gz, d, points.gradient[2] + n);
  }
}

const char* FieldInstructionSet() {
  return hwy::TargetName(HWY_TARGET);
}

}  // namespace explica::repulsion::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace explica::repulsion {

HWY_EXPORT(AddField);
HWY_EXPORT(FieldInstructionSet);

void addField(FieldPoints& points, std::span<const FieldCluster> clusters,
              std::span<const FieldPoint> sources) {
  HWY_DYNAMIC_DISPATCH(AddField)(points, clusters, sources);
}

const char* fieldInstructionSet() {
  return HWY_DYNAMIC_DISPATCH(FieldInstructionSet)();
}

}  // namespace explica::repulsion
#endif  // HWY_ONCE
