// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Report/Picture.h"

#include "Explica/Core/Errors.h"
#include "Explica/Core/WholeFile.h"

#include <zlib.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <limits>

namespace explica::report {
namespace {

void appendBigEndian(std::string& bytes, std::uint32_t value) {
  for (int shift = 24; shift >= 0; shift -= 8) bytes.push_back(static_cast<char>(value >> shift));
}

void appendChunk(std::string& file, const char* type, const std::string& data) {
  appendBigEndian(file, static_cast<std::uint32_t>(data.size()));
  const std::string body = type + data;
  file += body;
  appendBigEndian(file,
                  static_cast<std::uint32_t>(crc32(0, reinterpret_cast<const Bytef*>(body.data()),
                                                   static_cast<uInt>(body.size()))));
}

/// What a filter of PNG expects at a byte, from those to the left, above, and above to the left.
int expectedBy(int filter, int left, int above, int corner) {
  switch (filter) {
    case 1:
      return left;
    case 2:
      return above;
    case 3:
      return (left + above) / 2;
    case 4: {
      const int toLeft = std::abs(above - corner), toAbove = std::abs(left - corner),
                toCorner = std::abs(left + above - 2 * corner);
      if (toLeft <= toAbove && toLeft <= toCorner) return left;
      return toAbove <= toCorner ? above : corner;
    }
    default:
      return 0;
  }
}

/// A row as the filter leaves it, the filter's number first.
/// @param before  the row above, or nullptr
std::string filteredRow(int filter, const std::uint8_t* row, const std::uint8_t* before,
                        std::size_t stride) {
  std::string out(1, static_cast<char>(filter));
  out.reserve(stride + 1);
  for (std::size_t b = 0; b < stride; ++b) {
    const int left = b < 3 ? 0 : row[b - 3];
    const int above = before == nullptr ? 0 : before[b];
    const int corner = b < 3 || before == nullptr ? 0 : before[b - 3];
    out.push_back(static_cast<char>(row[b] - expectedBy(filter, left, above, corner)));
  }
  return out;
}

/// Rows, each under the filter that leaves the smallest sum of differences, deflated.
std::string compressRows(const Picture& picture) {
  constexpr int kFilters = 5;
  const std::size_t stride = static_cast<std::size_t>(picture.width) * 3;
  std::string rows;
  rows.reserve((stride + 1) * picture.height);
  for (int y = 0; y < picture.height; ++y) {
    const std::uint8_t* row = picture.rgb.data() + y * stride;
    std::string best;
    long least = std::numeric_limits<long>::max();
    for (int filter = 0; filter < kFilters; ++filter) {
      std::string tried = filteredRow(filter, row, y == 0 ? nullptr : row - stride, stride);
      long sum = 0;
      for (std::size_t b = 1; b < tried.size(); ++b)
        sum += std::abs(static_cast<signed char>(tried[b]));
      if (sum >= least) continue;
      least = sum;
      best = std::move(tried);
    }
    rows += best;
  }
  uLongf size = compressBound(static_cast<uLong>(rows.size()));
  std::string packed(size, '\0');
  compress2(reinterpret_cast<Bytef*>(packed.data()), &size,
            reinterpret_cast<const Bytef*>(rows.data()), static_cast<uLong>(rows.size()), 7);
  packed.resize(size);
  return packed;
}

std::string pngHead(const Picture& picture) {
  std::string file = "\x89PNG\r\n\x1a\n";
  std::string header;
  appendBigEndian(header, static_cast<std::uint32_t>(picture.width));
  appendBigEndian(header, static_cast<std::uint32_t>(picture.height));
  header += std::string("\x08\x02\x00\x00\x00", 5);
  appendChunk(file, "IHDR", header);
  return file;
}

}  // namespace

Picture::Picture(int w, int h, std::array<std::uint8_t, 3> fill)
    : width(w), height(h), rgb(static_cast<std::size_t>(w) * h * 3) {
  for (std::size_t p = 0; p < rgb.size(); ++p) rgb[p] = fill[p % 3];
}

std::uint8_t encodeSrgb(float linear) {
  const float x = std::clamp(linear, 0.0f, 1.0f);
  const float encoded = x <= 0.0031308f ? 12.92f * x : 1.055f * std::pow(x, 1 / 2.4f) - 0.055f;
  return static_cast<std::uint8_t>(std::lround(255 * encoded));
}

float decodeSrgb(std::uint8_t byte) {
  const float x = byte / 255.0f;
  return x <= 0.04045f ? x / 12.92f : std::pow((x + 0.055f) / 1.055f, 2.4f);
}

std::string encodePng(const Picture& picture) {
  std::string file = pngHead(picture);
  appendChunk(file, "IDAT", compressRows(picture));
  appendChunk(file, "IEND", "");
  return file;
}

void requireFrames(const std::vector<Picture>& frames) {
  if (frames.empty()) throw InvalidInput("film: no frames");
  for (const Picture& frame : frames) {
    if (frame.width != frames[0].width || frame.height != frames[0].height) {
      throw InvalidInput("film: frames differ in size");
    }
  }
}

std::string encodeAnimatedPng(const std::vector<Picture>& frames, double framesPerSecond) {
  requireFrames(frames);
  std::string file = pngHead(frames[0]);
  std::string control;
  appendBigEndian(control, static_cast<std::uint32_t>(frames.size()));
  appendBigEndian(control, 0);
  appendChunk(file, "acTL", control);
  std::uint32_t sequence = 0;
  for (std::size_t f = 0; f < frames.size(); ++f) {
    std::string frame;
    appendBigEndian(frame, sequence++);
    appendBigEndian(frame, static_cast<std::uint32_t>(frames[f].width));
    appendBigEndian(frame, static_cast<std::uint32_t>(frames[f].height));
    appendBigEndian(frame, 0);
    appendBigEndian(frame, 0);
    const auto milliseconds = static_cast<std::uint32_t>(std::lround(1000 / framesPerSecond));
    frame.push_back(static_cast<char>(milliseconds >> 8));
    frame.push_back(static_cast<char>(milliseconds & 0xff));
    frame += std::string("\x03\xe8\x00\x00", 4);  // of 1000 ms; replace what was there
    appendChunk(file, "fcTL", frame);
    const std::string rows = compressRows(frames[f]);
    if (f == 0) {
      appendChunk(file, "IDAT", rows);
    } else {
      std::string numbered;
      appendBigEndian(numbered, sequence++);
      appendChunk(file, "fdAT", numbered + rows);
    }
  }
  appendChunk(file, "IEND", "");
  return file;
}

void writePng(const std::filesystem::path& path, const Picture& picture) {
  WholeFile file(path);
  file.write(encodePng(picture));
  file.commit();
}

void pastePicture(Picture& whole, const Picture& part, int x, int y) {
  const int left = std::max(0, -x);
  const int right = std::min(part.width, whole.width - x);
  for (int row = std::max(0, -y); row < part.height && row + y < whole.height; ++row) {
    if (left < right) {
      std::copy(part.pixel(left, row), part.pixel(left, row) + 3 * (right - left),
                whole.pixel(x + left, y + row));
    }
  }
}

Picture tilePictures(const std::vector<Picture>& pictures, int columns) {
  if (pictures.empty()) return {};
  columns = std::clamp(columns, 1, static_cast<int>(pictures.size()));
  int width = 0;
  int height = 0;
  for (const Picture& p : pictures) {
    width = std::max(width, p.width);
    height = std::max(height, p.height);
  }
  const int rows = (static_cast<int>(pictures.size()) + columns - 1) / columns;
  Picture whole(width * columns, height * rows);
  for (std::size_t p = 0; p < pictures.size(); ++p) {
    const int column = static_cast<int>(p) % columns;
    const int row = static_cast<int>(p) / columns;
    pastePicture(whole, pictures[p], column * width + (width - pictures[p].width) / 2,
                 row * height + (height - pictures[p].height) / 2);
  }
  return whole;
}

}  // namespace explica::report
