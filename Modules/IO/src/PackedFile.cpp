// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "PackedFile.h"

#include "VectorState.h"

#include "Explica/Core/Parallel.h"

#include <isa-l/crc.h>
#include <isa-l/igzip_lib.h>
#include <zlib.h>

#include <algorithm>
#include <cstring>
#include <limits>
#include <numeric>

namespace explica::io {
namespace {

constexpr std::size_t kBlock = std::size_t{1} << 18;  // 8 windows: costs 1 % of size, feeds threads
constexpr std::size_t kBlocksAtOnce = 128;            // bounds the memory of a batch
// A Huffman code is made of pieces of what is packed: a quarter of a block, or so many of a body,
// which are looked for at so many places.
constexpr std::size_t kLook = std::size_t{1} << 14, kLooksEvery = 4 * kLook;
constexpr std::size_t kLooks = 128, kTries = 16 * kLooks;

struct Packed {
  Bytes bytes;
  std::uint32_t checksum = 0;  ///< CRC-32 of the unpacked block
  std::size_t size = 0;
};

/// Raises small counts, so that what was not seen in the pieces gets no long word: the files are
/// 1 to 7 % smaller.
template <class Counts>
void smooth(Counts& counts) {
  constexpr std::uint64_t kMostTimes = 1 << 9;  // the sum over the least count
  const auto sum = std::accumulate(std::begin(counts), std::end(counts), std::uint64_t{0});
  const std::uint64_t least = std::max<std::uint64_t>(1, sum / kMostTimes);
  for (std::uint64_t& count : counts) count = std::max(count, least);
}

/// Counts what packing pieces of a sequence needs, and makes a Huffman code of it that has a word
/// for whatever else comes.
class CodeMaker {
 public:
  CodeMaker() { std::memset(&histogram_, 0, sizeof(histogram_)); }
  void look(ByteView piece) {
    isal_update_histogram(const_cast<std::uint8_t*>(piece.data()), static_cast<int>(piece.size()),
                          &histogram_);
    endVectorCode();
  }
  [[nodiscard]] isal_hufftables codes() {
    smooth(histogram_.lit_len_histogram);
    smooth(histogram_.dist_histogram);
    isal_hufftables made;
    std::memset(&made, 0, sizeof(made));
    if (isal_create_hufftables(&made, &histogram_) != 0) {
      throw EnvironmentError("a block cannot be packed");
    }
    return made;
  }

 private:
  isal_huff_histogram histogram_;
};

/// The code of a block's own.
isal_hufftables codesOf(ByteView block) {
  CodeMaker maker;
  for (std::size_t at = 0; at < block.size(); at += kLooksEvery) {
    maker.look(block.subspan(at, std::min(kLook, block.size() - at)));
  }
  return maker.codes();
}

/// Room of each thread: larger than a block.
struct Workspace {
  isal_zstream stream;
  Bytes packed;
};

/// Deflate data of a block with zlib's wrapper, or raw, ended at a byte border and not marked as
/// last.  ISA-L's fastest level with a Huffman code made for the data: as small as zlib's level 1
/// on maps and labels, at a quarter of its time.  The higher levels give other bytes now and then,
/// depending on where the stream lies in memory.
Bytes deflated(ByteView block, isal_hufftables& codes, bool zlib) {
  if (block.size() > std::numeric_limits<std::int32_t>::max()) {
    throw EnvironmentError("a block of more than 2 GB cannot be packed");
  }
  static thread_local Workspace workspace;
  auto& [stream, packed] = workspace;
  auto* bytes = const_cast<std::uint8_t*>(block.data());
  std::memset(static_cast<void*>(&stream), 0, sizeof(stream));
  isal_deflate_stateless_init(&stream);
  stream.hufftables = &codes;
  stream.gzip_flag = zlib ? IGZIP_ZLIB : IGZIP_DEFLATE;
  stream.flush = zlib ? NO_FLUSH : FULL_FLUSH;
  stream.end_of_stream = zlib ? 1 : 0;
  packed.resize(std::max(packed.size(), block.size() + block.size() / 8 + 1024));
  stream.next_in = bytes;
  stream.avail_in = static_cast<std::uint32_t>(block.size());
  stream.next_out = packed.data();
  stream.avail_out = static_cast<std::uint32_t>(packed.size());
  const int status = isal_deflate_stateless(&stream);
  endVectorCode();
  if (status != COMP_OK) {
    throw EnvironmentError("a block cannot be packed");
  }
  return Bytes(packed.data(), stream.next_out);
}

std::uint32_t checksumOf(ByteView block) {
  const std::uint32_t checksum = crc32_gzip_refl(0, block.data(), block.size());
  endVectorCode();
  return checksum;
}

/// By a Huffman code of the block's own.
Packed packBlock(ByteView block) {
  isal_hufftables codes = codesOf(block);
  return {deflated(block, codes, false), checksumOf(block), block.size()};
}

/// One value over and over, as outside the tissue.
bool isUniform(ByteView bytes) {
  constexpr std::size_t kPeriod = 16;  // bytes: of no fewer than a voxel of any type
  return bytes.size() <= kPeriod ||
         std::memcmp(bytes.data(), bytes.data() + kPeriod, bytes.size() - kPeriod) == 0;
}

/// A stride by which each early part of 0, 1, 2, ... times it, modulo `count`, is spread over all
/// numbers below it: about the golden section, and without a common divisor, so that none comes
/// twice.
std::size_t goldenStride(std::size_t count) {
  auto stride = static_cast<std::size_t>(0.6180339887498949 * static_cast<double>(count));
  while (std::gcd(stride, count) != 1) ++stride;
  return stride;
}

/// One code for the blocks of a body, of pieces spread over it that are not uniform.  What is known
/// to be so is passed over as what turns out to be: the code goes by the bytes alone.
isal_hufftables codesOfBody(const Content& content) {
  const std::size_t pieces = (content.bodySize + kLook - 1) / kLook;
  const std::size_t stride = goldenStride(pieces);
  CodeMaker maker;
  Bytes piece(kLook);
  std::size_t looks = 0;
  for (std::size_t k = 0; k < std::min(pieces, kTries) && looks < kLooks; ++k) {
    const std::size_t begin = k * stride % pieces * kLook;
    const std::size_t size = std::min(kLook, content.bodySize - begin);
    if (content.isBlank && content.isBlank(begin, size)) continue;
    content.body(begin, piece.data(), size);
    const ByteView made(piece.data(), size);
    if (isUniform(made)) continue;
    maker.look(made);
    ++looks;
  }
  return maker.codes();
}

/// A block of one value over and over, as most of a medical volume, packed once.
class BlankBlock {
 public:
  explicit BlankBlock(const Bytes& value) : bytes_(kBlock) {
    for (std::size_t at = 0; at < kBlock; at += value.size()) {
      std::ranges::copy(value, bytes_.begin() + static_cast<std::ptrdiff_t>(at));
    }
    packed_ = packBlock(bytes_);
  }
  [[nodiscard]] const Packed& packed() const { return packed_; }
  [[nodiscard]] bool is(ByteView block) const {
    return block.size() == kBlock && std::memcmp(block.data(), bytes_.data(), kBlock) == 0;
  }

 private:
  Bytes bytes_;
  Packed packed_;
};

class GzipMember {
 public:
  explicit GzipMember(WholeFile& file) : file_(file) {
    // Magic, deflate, no flags, no time, no extra flags, unknown system.
    static constexpr std::uint8_t kGzipHead[10] = {0x1f, 0x8b, 8, 0, 0, 0, 0, 0, 0, 255};
    file_.write(kGzipHead, sizeof(kGzipHead));
  }
  void add(const Packed& packed) {
    file_.write(packed.bytes.data(), packed.bytes.size());
    checksum_ = static_cast<std::uint32_t>(
        crc32_combine(checksum_, packed.checksum, static_cast<z_off_t>(packed.size)));
    size_ += packed.size;
  }
  void finish() {
    Bytes end = {0x03, 0x00};  // an empty last block
    append(end, checksum_, false);
    append(end, static_cast<std::uint32_t>(size_), false);
    file_.write(end.data(), end.size());
  }

 private:
  WholeFile& file_;
  std::uint32_t checksum_ = 0;
  std::uint64_t size_ = 0;
};

}  // namespace

void writePlain(WholeFile& file, const Content& content) {
  file.write(content.head.data(), content.head.size());
  Bytes block(std::min(8 * kBlock, content.bodySize));
  for (std::size_t begin = 0; begin < content.bodySize; begin += block.size()) {
    const std::size_t count = std::min(block.size(), content.bodySize - begin);
    content.body(begin, block.data(), count);
    file.write(block.data(), count);
  }
  file.write(content.tail.data(), content.tail.size());
}

void writeGzip(WholeFile& file, const Content& content) {
  GzipMember member(file);
  if (!content.head.empty()) member.add(packBlock(content.head));
  const std::size_t blocks = (content.bodySize + kBlock - 1) / kBlock;
  const BlankBlock blank(content.blank);
  isal_hufftables codes = codesOfBody(content);
  std::vector<Packed> batch(std::min(blocks, kBlocksAtOnce));
  for (std::size_t first = 0; first < blocks; first += kBlocksAtOnce) {
    const std::size_t count = std::min(kBlocksAtOnce, blocks - first);
    parallelFor(count, 1, [&](std::size_t b) {
      const std::size_t begin = (first + b) * kBlock;
      const std::size_t size = std::min(kBlock, content.bodySize - begin);
      batch[b].size = 0;  // stands for a blank block
      if (size == kBlock && content.isBlank && content.isBlank(begin, size)) return;
      static thread_local Bytes block;
      block.resize(size);
      content.body(begin, block.data(), size);
      if (blank.is(block)) return;
      batch[b] = isUniform(block) ? packBlock(block)
                                  : Packed{deflated(block, codes, false), checksumOf(block), size};
    });
    for (std::size_t b = 0; b < count; ++b) {
      member.add(batch[b].size > 0 ? batch[b] : blank.packed());
    }
  }
  if (!content.tail.empty()) member.add(packBlock(content.tail));
  member.finish();
}

Bytes packZlib(ByteView bytes) {
  isal_hufftables codes = codesOf(bytes);
  return deflated(bytes, codes, true);
}

}  // namespace explica::io
