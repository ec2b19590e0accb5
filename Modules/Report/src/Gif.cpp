// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Report/Picture.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace explica::report {
namespace {

constexpr int kBits = 5;  // of each component that tell colours apart
constexpr std::size_t kColours = 256;

void appendLittleEndian(std::string& bytes, int value) {
  bytes.push_back(static_cast<char>(value & 0xff));
  bytes.push_back(static_cast<char>((value >> 8) & 0xff));
}

std::size_t binOf(const std::uint8_t* p) {
  constexpr int kDrop = 8 - kBits;
  return static_cast<std::size_t>(p[0] >> kDrop) << (2 * kBits) |
         static_cast<std::size_t>(p[1] >> kDrop) << kBits | static_cast<std::size_t>(p[2] >> kDrop);
}

/// Pixels of nearly one colour.
struct Bin {
  std::size_t number = 0;
  std::int64_t count = 0;
  std::array<std::int64_t, 3> sum = {0, 0, 0};
  [[nodiscard]] double mean(int c) const {
    return static_cast<double>(sum[c]) / static_cast<double>(count);
  }
};

/// Bins that share a colour of the palette, and how far they spread.
struct ColourBox {
  std::size_t begin = 0, end = 0;
  int axis = 0;
  double spread = 0;  ///< sum over pixels of the squared distance from the mean along the axis
};

ColourBox colourBoxOf(const std::vector<Bin>& bins, std::size_t begin, std::size_t end) {
  ColourBox box{begin, end, 0, 0};
  for (int c = 0; c < 3; ++c) {
    double n = 0, first = 0, second = 0;
    for (std::size_t b = begin; b < end; ++b) {
      const auto weight = static_cast<double>(bins[b].count);
      n += weight;
      first += weight * bins[b].mean(c);
      second += weight * bins[b].mean(c) * bins[b].mean(c);
    }
    const double spread = second - first * first / n;
    if (spread > box.spread) {
      box.axis = c;
      box.spread = spread;
    }
  }
  return box;
}

struct Palette {
  std::array<std::array<std::uint8_t, 3>, kColours> colours = {};
  std::vector<std::uint8_t> indexOf = std::vector<std::uint8_t>(std::size_t{1} << (3 * kBits));
};

/// The colours of all frames by median cut: the box of the largest spread is parted at its mean
/// until there are 256.
Palette paletteOf(const std::vector<Picture>& frames) {
  std::vector<Bin> all(std::size_t{1} << (3 * kBits)), bins;
  for (const Picture& frame : frames) {
    for (std::size_t at = 0; at < frame.rgb.size(); at += 3) {
      Bin& bin = all[binOf(&frame.rgb[at])];
      ++bin.count;
      for (int c = 0; c < 3; ++c) bin.sum[c] += frame.rgb[at + c];
    }
  }
  for (std::size_t b = 0; b < all.size(); ++b) {
    all[b].number = b;
    if (all[b].count > 0) bins.push_back(all[b]);
  }
  std::vector<ColourBox> boxes = {colourBoxOf(bins, 0, bins.size())};
  while (boxes.size() < kColours) {
    const auto widest = std::ranges::max_element(boxes, {}, &ColourBox::spread);
    if (!(widest->spread > 0)) break;
    const ColourBox box = *widest;
    double n = 0, sum = 0;
    for (std::size_t b = box.begin; b < box.end; ++b) {
      n += static_cast<double>(bins[b].count);
      sum += static_cast<double>(bins[b].sum[box.axis]);
    }
    const auto middle =
        std::stable_partition(bins.begin() + static_cast<std::ptrdiff_t>(box.begin),
                              bins.begin() + static_cast<std::ptrdiff_t>(box.end),
                              [&](const Bin& bin) { return bin.mean(box.axis) <= sum / n; });
    const auto parted = static_cast<std::size_t>(middle - bins.begin());
    if (parted == box.begin || parted == box.end) {
      widest->spread = 0;  // one colour up to rounding
      continue;
    }
    *widest = colourBoxOf(bins, box.begin, parted);
    boxes.push_back(colourBoxOf(bins, parted, box.end));
  }
  Palette palette;
  for (std::size_t n = 0; n < boxes.size(); ++n) {
    std::int64_t count = 0;
    std::array<std::int64_t, 3> sum = {0, 0, 0};
    for (std::size_t b = boxes[n].begin; b < boxes[n].end; ++b) {
      count += bins[b].count;
      for (int c = 0; c < 3; ++c) sum[c] += bins[b].sum[c];
      palette.indexOf[bins[b].number] = static_cast<std::uint8_t>(n);
    }
    for (int c = 0; c < 3; ++c) {
      palette.colours[n][c] = static_cast<std::uint8_t>((sum[c] + count / 2) / count);
    }
  }
  return palette;
}

std::vector<std::uint8_t> indicesIn(const Palette& palette, const Picture& frame) {
  std::vector<std::uint8_t> indices(frame.rgb.size() / 3);
  for (std::size_t p = 0; p < indices.size(); ++p) {
    indices[p] = palette.indexOf[binOf(&frame.rgb[3 * p])];
  }
  return indices;
}

/// GIF's variable-width LZW in sub-blocks of at most 255 bytes.
std::string compressLzw(const std::vector<std::uint8_t>& indices) {
  constexpr int kClear = 256;  // GIF's code: begin a new table
  constexpr int kEnd = 257;    // GIF's code: the picture ends
  std::string bytes;
  std::uint32_t bits = 0;
  int bitCount = 0;
  int width = 9;
  const auto emit = [&](int code) {
    bits |= static_cast<std::uint32_t>(code) << bitCount;
    bitCount += width;
    while (bitCount >= 8) {
      bytes.push_back(static_cast<char>(bits & 0xff));
      bits >>= 8;
      bitCount -= 8;
    }
  };
  std::vector<std::int16_t> next(4096 * 256, -1);
  int count = 258;
  emit(kClear);
  int prefix = indices[0];
  for (std::size_t i = 1; i < indices.size(); ++i) {
    std::int16_t& entry = next[static_cast<std::size_t>(prefix) * 256 + indices[i]];
    if (entry >= 0) {
      prefix = entry;
      continue;
    }
    emit(prefix);
    if (count == 4096) {
      emit(kClear);
      std::ranges::fill(next, std::int16_t{-1});
      count = 258;
      width = 9;
    } else {
      if (count == (1 << width)) ++width;
      entry = static_cast<std::int16_t>(count++);
    }
    prefix = indices[i];
  }
  emit(prefix);
  emit(kEnd);
  if (bitCount > 0) bytes.push_back(static_cast<char>(bits & 0xff));
  std::string blocks;
  for (std::size_t at = 0; at < bytes.size(); at += 255) {
    const std::size_t length = std::min<std::size_t>(255, bytes.size() - at);
    blocks.push_back(static_cast<char>(length));
    blocks.append(bytes, at, length);
  }
  blocks.push_back('\0');
  return blocks;
}

}  // namespace

std::string encodeGif(const std::vector<Picture>& frames, double framesPerSecond) {
  requireFrames(frames);
  std::string file = "GIF89a";
  appendLittleEndian(file, frames[0].width);
  appendLittleEndian(file, frames[0].height);
  file += std::string("\xf7\x00\x00", 3);  // a table of 256 colours of 8 bits
  const Palette palette = paletteOf(frames);
  for (const auto& colour : palette.colours) {
    for (const std::uint8_t c : colour) file.push_back(static_cast<char>(c));
  }
  file += std::string("\x21\xff\x0bNETSCAPE2.0\x03\x01\x00\x00\x00", 19);  // repeat for ever
  const int hundredths = std::max(2, static_cast<int>(std::lround(100 / framesPerSecond)));
  for (const Picture& frame : frames) {
    file += std::string("\x21\xf9\x04\x04", 4);
    appendLittleEndian(file, hundredths);
    file += std::string("\x00\x00\x2c\x00\x00\x00\x00", 7);
    appendLittleEndian(file, frame.width);
    appendLittleEndian(file, frame.height);
    file += std::string("\x00\x08", 2);
    file += compressLzw(indicesIn(palette, frame));
  }
  file.push_back(';');
  return file;
}

}  // namespace explica::report
