// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#if defined(__x86_64__) && defined(__GNUC__)
#include <immintrin.h>
#endif

namespace explica::io {

#if defined(__x86_64__) && defined(__GNUC__)
[[gnu::target("avx")]] inline void clearUpperHalves() {
  _mm256_zeroupper();
}

/// To be called after ISA-L's functions.  They return with the upper halves of vector registers in
/// use, and until these are cleared processors run code for 128 bits at a third of its speed: for
/// the rest of the run, unless somebody happens to clear them.
inline void endVectorCode() {
  if (__builtin_cpu_supports("avx")) clearUpperHalves();
}
#else
inline void endVectorCode() {}
#endif

}  // namespace explica::io
