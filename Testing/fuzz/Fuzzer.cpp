// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
// The libFuzzer target: of the reader that EXPLICA_FUZZ_READER names.

#include "Readers.h"

#include <cstdlib>

using namespace explica::fuzz;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t count) {
  static const Trial trial = [] {
    const char* wanted = std::getenv("EXPLICA_FUZZ_READER");
    for (const Reader& reader : allReaders()) {
      if (wanted != nullptr && reader.name == wanted) return Trial(reader);
    }
    std::abort();
  }();
  trial.read(bytes, count);
  return 0;
}
