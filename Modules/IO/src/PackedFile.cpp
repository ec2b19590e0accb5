// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "PackedFile.h"

#include "Explica/Core/Parallel.h"

#include <zlib.h>

#include <algorithm>
#include <memory>

namespace explica::io {
namespace {

constexpr std::size_t kBlock = std::size_t{1} << 17;  // 4 windows: costs 1 % of size, feeds threads
constexpr std::size_t kBlocksAtOnce = 128;            // bounds the memory of a batch
constexpr int kRawDeflate = -15;

struct Packed {
  Bytes bytes;
  uLong checksum = 0;  ///< CRC-32 of the unpacked block
  std::size_t size = 0;
};

/// zlib's state and room for the result, kept by each thread: they are larger than a block.
class Deflater {
 public:
  explicit Deflater(int level) : level_(level) {
    if (deflateInit2(&stream_, level, Z_DEFLATED, kRawDeflate, 8, Z_DEFAULT_STRATEGY) != Z_OK) {
      throw EnvironmentError("no memory to compress a file");
    }
  }
  ~Deflater() { deflateEnd(&stream_); }
  Deflater(const Deflater&) = delete;
  Deflater& operator=(const Deflater&) = delete;

  [[nodiscard]] int level() const { return level_; }

  /// Raw deflate data of one block, ended at a byte border and not marked as last.
  [[nodiscard]] Packed pack(ByteView block) {
    deflateReset(&stream_);
    room_.resize(std::max(room_.size(), deflateBound(&stream_, block.size()) + 16));
    stream_.next_in = const_cast<std::uint8_t*>(block.data());
    stream_.avail_in = static_cast<uInt>(block.size());
    stream_.next_out = room_.data();
    stream_.avail_out = static_cast<uInt>(room_.size());
    if (deflate(&stream_, Z_SYNC_FLUSH) != Z_OK || stream_.avail_in != 0) {
      throw EnvironmentError("zlib could not compress a block");
    }
    Packed packed;
    packed.size = block.size();
    packed.checksum = crc32(0, block.data(), static_cast<uInt>(block.size()));
    packed.bytes.assign(room_.data(), room_.data() + (room_.size() - stream_.avail_out));
    return packed;
  }

 private:
  int level_;
  z_stream stream_{};
  Bytes room_;
};

Packed packBlock(ByteView block, int level) {
  static thread_local std::unique_ptr<Deflater> deflater;
  if (!deflater || deflater->level() != level) deflater = std::make_unique<Deflater>(level);
  return deflater->pack(block);
}

bool allZero(ByteView bytes) {
  return bytes[0] == 0 && std::memcmp(bytes.data(), bytes.data() + 1, bytes.size() - 1) == 0;
}

class GzipMember {
 public:
  explicit GzipMember(WholeFile& file) : file_(file) {
    // Magic, deflate, no flags, no time, no extra flags, unknown system.
    static constexpr std::uint8_t kHeader[10] = {0x1f, 0x8b, 8, 0, 0, 0, 0, 0, 0, 255};
    file_.write(kHeader, sizeof(kHeader));
  }
  void add(const Packed& packed) {
    file_.write(packed.bytes.data(), packed.bytes.size());
    checksum_ = crc32_combine(checksum_, packed.checksum, static_cast<z_off_t>(packed.size));
    size_ += packed.size;
  }
  void finish() {
    Bytes end = {0x03, 0x00};  // an empty last block
    append(end, static_cast<std::uint32_t>(checksum_), false);
    append(end, static_cast<std::uint32_t>(size_), false);
    file_.write(end.data(), end.size());
  }

 private:
  WholeFile& file_;
  uLong checksum_ = crc32(0, nullptr, 0);
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

void writeGzip(WholeFile& file, const Content& content, int level) {
  GzipMember member(file);
  if (!content.head.empty()) member.add(packBlock(content.head, level));
  const std::size_t blocks = (content.bodySize + kBlock - 1) / kBlock;
  // Most of a medical volume is empty: such blocks are packed once.
  const Packed emptyBlock = packBlock(Bytes(kBlock), level);
  std::vector<Packed> batch(std::min(blocks, kBlocksAtOnce));
  for (std::size_t first = 0; first < blocks; first += kBlocksAtOnce) {
    const std::size_t count = std::min(kBlocksAtOnce, blocks - first);
    parallelFor(count, 1, [&](std::size_t b) {
      const std::size_t begin = (first + b) * kBlock;
      static thread_local Bytes block;
      block.resize(std::min(kBlock, content.bodySize - begin));
      content.body(begin, block.data(), block.size());
      const bool empty = block.size() == kBlock && allZero(block);
      batch[b] = empty ? emptyBlock : packBlock(block, level);
    });
    for (std::size_t b = 0; b < count; ++b) member.add(batch[b]);
  }
  if (!content.tail.empty()) member.add(packBlock(content.tail, level));
  member.finish();
}

Bytes packZlib(ByteView bytes, int level) {
  uLongf size = compressBound(bytes.size());
  Bytes packed(size);
  if (compress2(packed.data(), &size, bytes.data(), bytes.size(), level) != Z_OK) {
    throw EnvironmentError("no memory to compress a file");
  }
  packed.resize(size);
  return packed;
}

void appendBase64(std::string& text, ByteView bytes) {
  static constexpr char kAlphabet[] =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  text.reserve(text.size() + (bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t held = std::min<std::size_t>(3, bytes.size() - i);
    std::uint32_t bits = static_cast<std::uint32_t>(bytes[i]) << 16;
    if (held > 1) bits |= static_cast<std::uint32_t>(bytes[i + 1]) << 8;
    if (held > 2) bits |= bytes[i + 2];
    text += kAlphabet[bits >> 18];
    text += kAlphabet[bits >> 12 & 63];
    text += held > 1 ? kAlphabet[bits >> 6 & 63] : '=';
    text += held > 2 ? kAlphabet[bits & 63] : '=';
  }
}

}  // namespace explica::io
