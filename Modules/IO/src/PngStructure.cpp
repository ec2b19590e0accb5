// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "PngStructure.h"

#include "StoredVolume.h"

#include <isa-l/crc.h>

#include <algorithm>
#include <cctype>
#include <string_view>

namespace explica::io {

namespace {

constexpr std::size_t kSignature = 8;        // bytes
constexpr std::size_t kFrame = 12;           // of a chunk: length, type and checksum
constexpr std::uint32_t kHeaderLength = 13;  // bytes
constexpr std::uint32_t kPaletteEntry = 3;   // bytes
constexpr int kPaletteColour = 3;            // PNG's number of this kind of colour

struct Chunk {
  std::string_view type;
  ByteView content;
};

struct Picture {
  int bits = 0, colour = 0;
};

/// The chunk at `offset`, whole and with the checksum that it states.
Chunk chunkAt(const std::filesystem::path& path, ByteView bytes, std::size_t offset) {
  if (bytes.size() - offset < kFrame) failTruncated(path, "the file ends within a chunk");
  const std::uint8_t* at = bytes.data() + offset;
  const std::uint32_t length = load<std::uint32_t>(at, true);
  if (length > bytes.size() - offset - kFrame) {
    failTruncated(path, "the file ends within a chunk");
  }
  const std::string_view type(reinterpret_cast<const char*>(at + 4), 4);
  if (!std::all_of(type.begin(), type.end(),
                   [](unsigned char c) { return c < 128 && std::isalpha(c); })) {
    failToRead(path, "is damaged: a PNG chunk has a name that is no word");
  }
  if (crc32_gzip_refl(0, at + 4, length + 4) != load<std::uint32_t>(at + 8 + length, true)) {
    failToRead(path, "is damaged: the checksum of a PNG chunk does not fit");
  }
  return {type, bytes.subspan(offset + 8, length)};
}

/// Bits per sample that go with a colour type.
bool bitsFit(int bits, int colour) {
  const bool small = bits == 1 || bits == 2 || bits == 4;
  if (colour == 0) return small || bits == 8 || bits == 16;
  if (colour == kPaletteColour) return small || bits == 8;
  return (colour == 2 || colour == 4 || colour == 6) && (bits == 8 || bits == 16);
}

Picture headerOf(const std::filesystem::path& path, const Chunk& chunk, std::size_t fileSize) {
  if (chunk.type != "IHDR" || chunk.content.size() != kHeaderLength) {
    failToRead(path, "is damaged: a PNG file begins with a chunk IHDR of 13 bytes");
  }
  const std::uint8_t* at = chunk.content.data();
  const std::int64_t width = load<std::uint32_t>(at, true);
  const std::int64_t height = load<std::uint32_t>(at + 4, true);
  const Picture header{at[8], at[9]};
  if (!bitsFit(header.bits, header.colour) || at[10] != 0 || at[11] != 0 || at[12] > 1) {
    failToRead(path, "is damaged: the PNG header holds values that do not exist");
  }
  // A compressed byte gives at most 1032, a byte at most eight pixels.
  constexpr std::int64_t kPixelsPerByte = 8 * 1032;
  if (checkedProduct(path, {width, height}) >
      static_cast<std::int64_t>(fileSize) * kPixelsPerByte) {
    failToRead(path, "the file is too short for the size that its header announces");
  }
  return header;
}

void checkPalette(const std::filesystem::path& path, const Picture& header, ByteView palette) {
  const std::size_t most =
      header.colour == kPaletteColour ? std::size_t{1} << header.bits : std::size_t{256};
  if (palette.empty() || palette.size() % kPaletteEntry != 0 ||
      palette.size() / kPaletteEntry > most) {
    failToRead(path, "is damaged: the PNG palette has an impossible length");
  }
}

}  // namespace

void checkPng(const std::filesystem::path& path, ByteView bytes) {
  std::size_t offset = kSignature;
  const auto next = [&] {
    const Chunk chunk = chunkAt(path, bytes, offset);
    offset += kFrame + chunk.content.size();
    return chunk;
  };
  const Picture header = headerOf(path, next(), bytes.size());
  bool palette = false, pixels = false;
  for (Chunk chunk = next(); chunk.type != "IEND"; chunk = next()) {
    if (std::islower(static_cast<unsigned char>(chunk.type[0]))) continue;  // no reader needs it
    if (chunk.type == "IDAT") {
      pixels = true;
    } else if (chunk.type == "PLTE" && !palette && !pixels) {
      palette = true;
      checkPalette(path, header, chunk.content);
    } else {
      failToRead(path, "is damaged: the PNG chunk " + std::string(chunk.type) + " is out of place");
    }
  }
  if (!pixels || (header.colour == kPaletteColour && !palette)) {
    failToRead(path, "is damaged: the PNG file has no pixels or lacks its palette");
  }
}

}  // namespace explica::io
