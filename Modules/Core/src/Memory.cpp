// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Core/Memory.h"

#include <Eigen/Core>

#include <cstddef>
#include <limits>

#ifdef __GLIBC__
#include <malloc.h>
#endif

namespace explica {

void keepFreedMemory() {
#ifdef __GLIBC__
  mallopt(M_MMAP_MAX, 0);  // mapped arrays go back to the system when they are freed
  mallopt(M_TRIM_THRESHOLD, std::numeric_limits<int>::max());
  mallopt(M_ARENA_MAX, 1);  // what one thread freed would not serve another one
#endif
}

void fixBlocksOfProducts() {
  constexpr std::ptrdiff_t kNear = std::ptrdiff_t{32} << 10;  // bytes, as most processors have them
  constexpr std::ptrdiff_t kMiddle = std::ptrdiff_t{1} << 20;
  constexpr std::ptrdiff_t kFar = std::ptrdiff_t{8} << 20;
  Eigen::setCpuCacheSizes(kNear, kMiddle, kFar);
}

}  // namespace explica
