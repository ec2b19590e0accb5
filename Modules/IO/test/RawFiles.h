// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

// Pieces of files of which a test makes its own, byte by byte.

/// A chunk of a PNG file with its right checksum [ISO 15948, annex D].
inline std::string pngChunk(const std::string& type, const std::string& content) {
  const auto bigEndian = [](std::uint32_t n) {
    return std::string{static_cast<char>(n >> 24), static_cast<char>(n >> 16),
                       static_cast<char>(n >> 8), static_cast<char>(n)};
  };
  std::uint32_t sum = ~0U;
  for (const char c : type + content) {
    sum ^= static_cast<unsigned char>(c);
    for (int bit = 0; bit < 8; ++bit) sum = sum >> 1 ^ (0xEDB88320U & (0U - (sum & 1U)));
  }
  return bigEndian(static_cast<std::uint32_t>(content.size())) + type + content + bigEndian(~sum);
}

/// A grey picture without compression: stored blocks [RFC 1951, 3.2.4].
inline std::string plainPng(std::uint32_t width, std::uint32_t height) {
  constexpr std::size_t kBlock = 65535;      // bytes of a stored block at most
  constexpr std::uint32_t kModulus = 65521;  // of Adler's sum [RFC 1950, 9]
  const auto bigEndian = [](std::uint32_t n) {
    return std::string{static_cast<char>(n >> 24), static_cast<char>(n >> 16),
                       static_cast<char>(n >> 8), static_cast<char>(n)};
  };
  std::string pixels;
  for (std::uint32_t row = 0; row < height; ++row) pixels += '\0' + std::string(width, '\7');
  std::string packed = "\x78\x01";
  for (std::size_t at = 0; at < pixels.size(); at += kBlock) {
    const std::string block = pixels.substr(at, kBlock);
    const auto size = static_cast<std::uint32_t>(block.size());
    packed += at + kBlock >= pixels.size() ? '\1' : '\0';
    for (const std::uint32_t n : {size, ~size}) {
      packed += {static_cast<char>(n), static_cast<char>(n >> 8)};
    }
    packed += block;
  }
  std::uint32_t a = 1, b = 0;
  for (const char c : pixels) {
    a = (a + static_cast<unsigned char>(c)) % kModulus;
    b = (b + a) % kModulus;
  }
  packed += bigEndian(b << 16 | a);
  return "\x89PNG\r\n\x1a\n" +
         pngChunk("IHDR", bigEndian(width) + bigEndian(height) + std::string("\10\0\0\0\0", 5)) +
         pngChunk("IDAT", packed) + pngChunk("IEND", "");
}

/// A matrix of Matlab's level 4, as ANTs writes its transforms: header, name, values.
inline void appendMatlab(std::string& bytes, const std::string& name,
                         const std::vector<double>& values) {
  const auto add = [&bytes](const void* from, std::size_t count) {
    bytes.append(static_cast<const char*>(from), count);
  };
  const std::int32_t header[] = {0, static_cast<std::int32_t>(values.size()), 1, 0,
                                 static_cast<std::int32_t>(name.size()) + 1};
  add(header, sizeof header);
  add(name.c_str(), name.size() + 1);
  add(values.data(), values.size() * sizeof(double));
}

/// An image along the axes with voxels of 1 mm, values as they are in memory: NRRD or MetaImage.
/// @param values  one or three for each voxel
inline std::string itkImage(bool nrrd, const std::array<int, 3>& size,
                            const std::vector<float>& values) {
  std::string sizes;
  for (const int n : size) sizes += " " + std::to_string(n);
  const bool vectors = values.size() > std::size_t(size[0]) * size[1] * size[2];
  const std::string raw(reinterpret_cast<const char*>(values.data()),
                        values.size() * sizeof(float));
  if (nrrd) {
    return std::string("NRRD0004\ntype: float\nspace: right-anterior-superior\n") +
           (vectors ? "dimension: 4\nsizes: 3" : "dimension: 3\nsizes:") + sizes +
           (vectors ? "\nkinds: vector domain domain domain\nspace directions: none"
                    : "\nspace directions:") +
           " (1,0,0) (0,1,0) (0,0,1)\nspace origin: (0,0,0)\nendian: little\nencoding: raw\n\n" +
           raw;
  }
  return "ObjectType = Image\nNDims = 3\nBinaryData = True\nBinaryDataByteOrderMSB = False\n"
         "TransformMatrix = 1 0 0 0 1 0 0 0 1\nOffset = 0 0 0\nElementSpacing = 1 1 1\nDimSize =" +
         sizes + (vectors ? "\nElementNumberOfChannels = 3" : "") +
         "\nElementType = MET_FLOAT\nElementDataFile = LOCAL\n" + raw;
}
