// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
// Memory of the program's arrays: large ones ask the kernel for huge pages, which costs a fifth of
// the time of a measurement less than 4 KB pages, each faulted in and looked up on its own.
#include <sys/mman.h>

#include <cstdlib>
#include <new>

namespace {

constexpr std::size_t kHugePage = std::size_t{1} << 21;
constexpr std::size_t kLarge = 2 * kHugePage;  // so that what is not a whole page matters little

void* allocated(std::size_t size) {
  if (size < kLarge) return std::malloc(size > 0 ? size : 1);
  void* memory = nullptr;
  if (posix_memalign(&memory, kHugePage, size) != 0) return nullptr;
  madvise(memory, size & ~(kHugePage - 1), MADV_HUGEPAGE);  // a wish: refusal does no harm
  return memory;
}

}  // namespace

void* operator new(std::size_t size) {
  for (;;) {
    if (void* memory = allocated(size)) return memory;
    const std::new_handler handler = std::get_new_handler();
    if (handler == nullptr) throw std::bad_alloc();
    handler();
  }
}

void operator delete(void* memory) noexcept {
  std::free(memory);
}

void operator delete(void* memory, std::size_t) noexcept {
  std::free(memory);
}
