// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Report/Picture.h"

#include "Explica/Core/Errors.h"
#include "Explica/Core/WholeFile.h"

#include <png.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace explica::report {
namespace {

void requireFrames(const std::vector<Picture>& frames) {
  if (frames.empty()) throw InvalidInput("film: no frames");
  for (const Picture& frame : frames) {
    if (frame.width != frames[0].width || frame.height != frames[0].height) {
      throw InvalidInput("film: frames differ in size");
    }
  }
}

void appendLittleEndian(std::string& bytes, int value) {
  bytes.push_back(static_cast<char>(value & 0xff));
  bytes.push_back(static_cast<char>((value >> 8) & 0xff));
}

constexpr std::array<int, 3> kGifLevels = {6, 7, 6};  // of red, green, blue: 252 colours

/// Index of the fixed colour nearest to a pixel, displaced by an 8 x 8 ordered dither.
std::vector<std::uint8_t> ditherFrame(const Picture& frame) {
  std::array<float, 64> threshold;
  for (int y = 0; y < 8; ++y) {
    for (int x = 0; x < 8; ++x) {
      int value = 0;
      for (int bit = 0; bit < 3; ++bit) {
        const int a = (x >> bit) & 1;
        const int b = (y >> bit) & 1;
        value |= ((a ^ b) << (5 - 2 * bit)) | (b << (4 - 2 * bit));
      }
      threshold[y * 8 + x] = (static_cast<float>(value) + 0.5f) / 64 - 0.5f;
    }
  }
  std::vector<std::uint8_t> indices(static_cast<std::size_t>(frame.width) * frame.height);
  for (int y = 0; y < frame.height; ++y) {
    for (int x = 0; x < frame.width; ++x) {
      const std::uint8_t* p = frame.pixel(x, y);
      int index = 0;
      for (int c = 0; c < 3; ++c) {
        const float level = p[c] / 255.0f * static_cast<float>(kGifLevels[c] - 1);
        // A pixel that is exactly a level (white above all) stays what it is.
        const float moved = level + 0.9f * threshold[(y % 8) * 8 + x % 8];
        const int rounded = std::clamp(static_cast<int>(std::lround(moved)), 0, kGifLevels[c] - 1);
        index = index * kGifLevels[c] + rounded;
      }
      indices[static_cast<std::size_t>(y) * frame.width + x] = static_cast<std::uint8_t>(index);
    }
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
      std::fill(next.begin(), next.end(), std::int16_t{-1});
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
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  image.width = static_cast<png_uint_32>(picture.width);
  image.height = static_cast<png_uint_32>(picture.height);
  image.format = PNG_FORMAT_RGB;
  png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(image);
  std::string file(size, '\0');
  if (png_image_write_to_memory(&image, file.data(), &size, 0, picture.rgb.data(), 0, nullptr) ==
      0) {
    throw EnvironmentError(std::string("picture: ") + image.message);
  }
  file.resize(size);
  return file;
}

std::string encodeGif(const std::vector<Picture>& frames, double framesPerSecond) {
  requireFrames(frames);
  std::string file = "GIF89a";
  appendLittleEndian(file, frames[0].width);
  appendLittleEndian(file, frames[0].height);
  file += std::string("\xf7\x00\x00", 3);  // a table of 256 colours of 8 bits
  for (int index = 0; index < 256; ++index) {
    int rest = index;
    std::array<int, 3> level = {0, 0, 0};
    for (int c = 2; c >= 0; --c) {
      level[c] = rest % kGifLevels[c];
      rest /= kGifLevels[c];
    }
    for (int c = 0; c < 3; ++c) {
      file.push_back(static_cast<char>(index < 252 ? 255 * level[c] / (kGifLevels[c] - 1) : 0));
    }
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
    file += compressLzw(ditherFrame(frame));
  }
  file.push_back(';');
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
