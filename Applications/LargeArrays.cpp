// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

// The program's arrays of several megabytes lie on huge pages (2 MiB) where the system grants them
// on advice, as most do: filling an image or a mesh on pages of 4 KiB costs an interruption each.

#include <cstdint>
#include <cstdlib>
#include <new>

#ifdef __linux__
#include <sys/mman.h>
#endif

namespace {

constexpr std::uintptr_t kHugePage = std::uintptr_t{2} << 20;  // bytes, of x86-64 and most others

/// Asks for huge pages within the block: advice, so that nothing depends on the answer.
void adviseHugePages([[maybe_unused]] void* block, [[maybe_unused]] std::size_t size) {
#ifdef MADV_HUGEPAGE
  const auto start = reinterpret_cast<std::uintptr_t>(block);
  const std::uintptr_t first = (start + kHugePage - 1) / kHugePage * kHugePage;
  const std::uintptr_t end = (start + size) / kHugePage * kHugePage;
  if (first < end) madvise(reinterpret_cast<void*>(first), end - first, MADV_HUGEPAGE);
#endif
}

}  // namespace

void* operator new(std::size_t size) {
  while (true) {
    if (void* block = std::malloc(size > 0 ? size : 1)) {
      if (size >= 2 * kHugePage) adviseHugePages(block, size);
      return block;
    }
    const std::new_handler handler = std::get_new_handler();
    if (handler == nullptr) throw std::bad_alloc();
    handler();
  }
}

void operator delete(void* block) noexcept {
  std::free(block);
}
void operator delete(void* block, std::size_t /*size*/) noexcept {
  std::free(block);
}
