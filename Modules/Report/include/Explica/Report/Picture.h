// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace explica::report {

/// Linear light, each component in [0, 1].
using Colour = std::array<float, 3>;

inline constexpr Colour kInk = {0.012F, 0.014F, 0.018F};  ///< of text; linear light
inline constexpr Colour kGrey = {0.21F, 0.22F, 0.23F};    ///< of small print
inline constexpr Colour kWhite = {1, 1, 1};               ///< paper

/// Pixels in sRGB, row by row from the top left, three bytes each.
struct Picture {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> rgb;  ///< width * height * 3

  Picture() = default;
  Picture(int w, int h, std::array<std::uint8_t, 3> fill = {255, 255, 255});
  [[nodiscard]] std::uint8_t* pixel(int x, int y) {
    return rgb.data() + 3 * (static_cast<std::size_t>(y) * width + x);
  }
  [[nodiscard]] const std::uint8_t* pixel(int x, int y) const {
    return rgb.data() + 3 * (static_cast<std::size_t>(y) * width + x);
  }
};

/// sRGB byte of a linear component, and back.
[[nodiscard]] std::uint8_t encodeSrgb(float linear);
[[nodiscard]] float decodeSrgb(std::uint8_t byte);
/// "#rrggbb", as SVG and CSS write it.
[[nodiscard]] std::string hexText(const Colour& colour);

/// The picture as a PNG file's bytes.  The same pixels give the same bytes.
[[nodiscard]] std::string encodePng(const Picture& picture);

/// @throws InvalidInput  no picture, or pictures of different sizes
void requireFrames(const std::vector<Picture>& frames);

/// Several pictures of one size as an endless animated GIF of the 256 colours that suit them, by
/// median cut.
/// @throws InvalidInput  no picture, or pictures of different sizes
[[nodiscard]] std::string encodeGif(const std::vector<Picture>& frames, double framesPerSecond);

/// Writes a PNG file, whole or not at all.
void writePng(const std::filesystem::path& path, const Picture& picture);

/// Pictures side by side in rows of `columns`, each in a cell of the largest size, on white.
[[nodiscard]] Picture tilePictures(const std::vector<Picture>& pictures, int columns);

/// Copies `part` into `whole` with its top left corner at (x, y); what sticks out is cut off.
void pastePicture(Picture& whole, const Picture& part, int x, int y);

}  // namespace explica::report
