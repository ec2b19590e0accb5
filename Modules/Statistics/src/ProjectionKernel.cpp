// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "ProjectionKernel.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "ProjectionKernel.cpp"
#include <hwy/foreach_target.h>  // IWYU pragma: keep
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace explica::statistics::kernels::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Tag = hn::CappedTag<float, 16>;
using V = hn::Vec<Tag>;

/// Two vectors of places times a tile of weights, summed in registers.
HWY_INLINE void ProjectStrip(const float* HWY_RESTRICT panel, const float* HWY_RESTRICT weights,
                             std::ptrdiff_t people, float* HWY_RESTRICT sums,
                             std::ptrdiff_t stride) {
  const Tag d;
  const auto width = static_cast<std::ptrdiff_t>(hn::Lanes(d));
  V sum[kTileWeights][2];
  for (std::ptrdiff_t c = 0; c < kTileWeights; ++c) sum[c][0] = sum[c][1] = hn::Zero(d);
  for (std::ptrdiff_t i = 0; i < people; ++i) {
    const V a = hn::LoadU(d, panel + i * kPanelPlaces);
    const V b = hn::LoadU(d, panel + i * kPanelPlaces + width);
    for (std::ptrdiff_t c = 0; c < kTileWeights; ++c) {
      const V w = hn::Set(d, weights[i * kTileWeights + c]);
      sum[c][0] = hn::Add(sum[c][0], hn::Mul(a, w));
      sum[c][1] = hn::Add(sum[c][1], hn::Mul(b, w));
    }
  }
  for (std::ptrdiff_t c = 0; c < kTileWeights; ++c) {
    hn::StoreU(sum[c][0], d, sums + c * stride);
    hn::StoreU(sum[c][1], d, sums + c * stride + width);
  }
}

void ProjectPanel(const float* panel, const float* weights, std::ptrdiff_t people, float* sums,
                  std::ptrdiff_t stride) {
  const auto strip = 2 * static_cast<std::ptrdiff_t>(hn::Lanes(Tag()));
  for (std::ptrdiff_t v = 0; v < kPanelPlaces; v += strip) {
    ProjectStrip(panel + v, weights, people, sums + v, stride);
  }
}

}  // namespace explica::statistics::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace explica::statistics::kernels {

HWY_EXPORT(ProjectPanel);

void projectPanel(const float* panel, const float* weights, std::ptrdiff_t people, float* sums,
                  std::ptrdiff_t stride) {
  HWY_DYNAMIC_DISPATCH(ProjectPanel)(panel, weights, people, sums, stride);
}

}  // namespace explica::statistics::kernels
#endif
