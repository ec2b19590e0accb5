// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <hwy/highway.h>

#include <cstdint>
#include <initializer_list>

namespace explica::testing {

/// Calls body(target) with Highway held to one instruction set after the other, of those that this
/// processor has below its widest; the widest is back in force afterwards.
template <class Body>
void forEachNarrowerInstructionSet(const Body& body) {
  for (const std::int64_t target :
       {std::int64_t{HWY_SSSE3}, std::int64_t{HWY_SSE4}, std::int64_t{HWY_AVX2}}) {
    if ((hwy::SupportedTargets() & target) == 0) continue;
    hwy::SetSupportedTargetsForTest(target);
    hwy::GetChosenTarget().Update(target);
    body(target);
    hwy::SetSupportedTargetsForTest(0);
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
  }
}

}  // namespace explica::testing
