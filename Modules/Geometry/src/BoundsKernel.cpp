// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Geometry/BoundsPyramid.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "BoundsKernel.cpp"
#include <hwy/foreach_target.h>  // IWYU pragma: keep
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace explica::geometry::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using BoundsTag = hn::CappedTag<float, BoundsBlock::kLanes>;

template <class D, class M>
HWY_INLINE std::uint64_t bitsOf(D d, M mask) {
  std::uint8_t bytes[8] = {};
  hn::StoreMaskBits(d, mask, bytes);
  return bytes[0];
}

template <bool kStill>
HWY_INLINE std::uint64_t NearLanes(const BoundsBlock& a, const BoundsBlock& b, float squaredReach) {
  const BoundsTag d;
  const int width = static_cast<int>(hn::Lanes(d));
  const auto zero = hn::Zero(d);
  std::uint64_t bits = 0;
  for (int lane = 0; lane < BoundsBlock::kLanes; ++lane) {
    for (int n = 0; n < BoundsBlock::kLanes; n += width) {
      auto squared = zero;
      for (int k = 0; k < 3; ++k) {
        auto above = hn::Sub(hn::Set(d, a.lower[k][lane]), hn::Load(d, b.upper[k] + n));
        auto below = hn::Sub(hn::Load(d, b.lower[k] + n), hn::Set(d, a.upper[k][lane]));
        if constexpr (!kStill) {
          const auto falls = hn::Sub(hn::Load(d, b.most[k] + n), hn::Set(d, a.least[k][lane]));
          const auto rises = hn::Sub(hn::Set(d, a.most[k][lane]), hn::Load(d, b.least[k] + n));
          above = hn::Sub(above, hn::Max(zero, falls));
          below = hn::Sub(below, hn::Max(zero, rises));
        }
        const auto gap = hn::Max(zero, hn::Max(above, below));
        squared = hn::Add(squared, hn::Mul(gap, gap));
      }
      bits |= bitsOf(d, hn::Le(squared, hn::Set(d, squaredReach)))
              << (BoundsBlock::kLanes * lane + n);
    }
  }
  return bits;
}

std::uint64_t MayMeet(const BoundsBlock& a, const BoundsBlock& b, float squaredReach, bool still) {
  return still ? NearLanes<true>(a, b, squaredReach) : NearLanes<false>(a, b, squaredReach);
}

}  // namespace explica::geometry::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace explica::geometry {

HWY_EXPORT(MayMeet);

std::uint64_t mayMeet(const BoundsBlock& a, const BoundsBlock& b, float squaredReach, bool still) {
  return HWY_DYNAMIC_DISPATCH(MayMeet)(a, b, squaredReach, still);
}

}  // namespace explica::geometry
#endif  // HWY_ONCE
