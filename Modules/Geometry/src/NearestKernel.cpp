// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "NearestKernel.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "NearestKernel.cpp"
#include <hwy/foreach_target.h>  // IWYU pragma: keep
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace explica::geometry::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using BoxTag = hn::CappedTag<float, BoxBlock::kLanes>;

void SquaredDistances(const BoxBlock& block, const NearQuery& query, float* squared) {
  const BoxTag d;
  const int width = static_cast<int>(hn::Lanes(d));
  const auto zero = hn::Zero(d);
  for (int n = 0; n < BoxBlock::kLanes; n += width) {
    auto sum = zero;
    for (int k = 0; k < 3; ++k) {
      const auto above = hn::Sub(hn::Load(d, block.lower[k] + n), hn::Set(d, query.high[k]));
      const auto below = hn::Sub(hn::Set(d, query.low[k]), hn::Load(d, block.upper[k] + n));
      const auto gap = hn::Max(zero, hn::Max(above, below));
      sum = hn::Add(sum, hn::Mul(gap, gap));
    }
    hn::Store(sum, d, squared + n);
  }
}

}  // namespace explica::geometry::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace explica::geometry {

HWY_EXPORT(SquaredDistances);

void squaredDistances(const BoxBlock& block, const NearQuery& query, float* squared) {
  HWY_DYNAMIC_DISPATCH(SquaredDistances)(block, query, squared);
}

}  // namespace explica::geometry
#endif  // HWY_ONCE
