// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Bytes.h"

#include "Explica/Core/WholeFile.h"

#include <functional>
#include <string>

namespace explica::io {

/// Produces `count` bytes of a long sequence from its byte `begin` on; called from several threads,
/// and must not start a parallel loop itself.
using FillBytes = std::function<void(std::size_t begin, std::uint8_t* to, std::size_t count)>;

/// A sequence of bytes to be written: a head, a body made on demand, a tail.
struct Content {
  Bytes head;
  std::size_t bodySize = 0;
  FillBytes body;
  Bytes blank = {0};  ///< what most of the body repeats: as long as a power of two
  /// True only where the body surely repeats `blank`; these bytes need not be made.
  std::function<bool(std::size_t begin, std::size_t count)> isBlank;
  Bytes tail;
};

/// Appends the content as it is.
void writePlain(WholeFile& file, const Content& content);

/// Appends the content as one gzip member, packed in blocks by several threads.  Blocks are cut by
/// position only and joined by flushes, so that the bytes do not depend on the number of
/// threads and every gzip reader understands them.  No name and no time is stored.
void writeGzip(WholeFile& file, const Content& content);

/// zlib data (RFC 1950) of a block in memory.
[[nodiscard]] Bytes packZlib(ByteView bytes);

}  // namespace explica::io
