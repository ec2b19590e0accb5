// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Report/Picture.h"

#include "Explica/Core/Errors.h"
#include "Explica/Core/Text.h"
#include "Explica/Core/WholeFile.h"

#include <png.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace explica::report {

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

std::string hexText(const Colour& colour) {
  return printed("#%02x%02x%02x", encodeSrgb(colour[0]), encodeSrgb(colour[1]),
                 encodeSrgb(colour[2]));
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

void requireFrames(const std::vector<Picture>& frames) {
  if (frames.empty()) throw InvalidInput("film: no frames");
  for (const Picture& frame : frames) {
    if (frame.width != frames[0].width || frame.height != frames[0].height) {
      throw InvalidInput("film: frames differ in size");
    }
  }
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
