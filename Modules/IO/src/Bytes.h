// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Base64.h"
#include "Explica/Core/Errors.h"

#include <Eigen/Core>

#include <algorithm>
#include <bit>
#include <charconv>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace explica::io {

static_assert(std::endian::native == std::endian::little, "readers swap as on little-endian hosts");

using Bytes = std::vector<std::uint8_t>;
using ByteView = std::span<const std::uint8_t>;

constexpr double kFarthest = 1e7;  ///< mm; beyond it differences of coordinates lose their digits

inline std::string_view textOf(ByteView bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

inline ByteView bytesOf(std::string_view text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

inline std::string quoted(const std::filesystem::path& path) {
  return "'" + path.string() + "'";
}

/// The file is missing, damaged or of another format.
[[noreturn]] inline void failToRead(const std::filesystem::path& path, const std::string& cause) {
  throw IOError(quoted(path) + ": " + cause);
}

/// For a file that holds less than it announces.
[[noreturn]] inline void failTruncated(const std::filesystem::path& path,
                                       const std::string& cause) {
  failToRead(path, cause + "; it is truncated or damaged: copy or make it again");
}

/// The file is whole, but cannot be used as asked.
[[noreturn]] inline void refuse(const std::filesystem::path& path, const std::string& cause) {
  throw InvalidInput(quoted(path) + ": " + cause);
}

/// Value at any address, byte order of the file given.
template <class T>
[[nodiscard]] T load(const std::uint8_t* from, bool bigEndian) {
  std::uint8_t raw[sizeof(T)];
  std::memcpy(raw, from, sizeof(T));
  if (bigEndian) std::reverse(raw, raw + sizeof(T));
  T value;
  std::memcpy(&value, raw, sizeof(T));
  return value;
}

template <class T>
void store(std::uint8_t* to, T value, bool bigEndian) {
  std::memcpy(to, &value, sizeof(T));
  if (bigEndian) std::reverse(to, to + sizeof(T));
}

template <class T>
void append(Bytes& bytes, T value, bool bigEndian) {
  bytes.resize(bytes.size() + sizeof(T));
  store(bytes.data() + bytes.size() - sizeof(T), value, bigEndian);
}

/// Reverses the bytes of each of `count` values of `width` bytes.
inline void swapBytes(std::uint8_t* values, std::size_t count, std::size_t width) {
  if (width == 1) return;
  for (std::size_t i = 0; i < count; ++i) {
    std::reverse(values + i * width, values + (i + 1) * width);
  }
}

/// Walks through bytes in memory; every step is checked.
class ByteCursor {
 public:
  ByteCursor(const std::filesystem::path& path, ByteView bytes, bool bigEndian)
      : path_(path), bytes_(bytes), bigEndian_(bigEndian) {}
  ByteCursor(const std::filesystem::path& path, std::string_view text)
      : ByteCursor(path, bytesOf(text), false) {}

  template <class T>
  [[nodiscard]] T take() {
    return load<T>(view(sizeof(T)).data(), bigEndian_);
  }
  [[nodiscard]] ByteView view(std::size_t count) {
    if (count > left()) failTruncated(path_, "the file ends too early");
    const ByteView taken = bytes_.subspan(at_, count);
    at_ += count;
    return taken;
  }
  /// Text up to the next line feed, which is consumed; a trailing carriage return is dropped.
  [[nodiscard]] std::string_view line() {
    const char* start = reinterpret_cast<const char*>(bytes_.data()) + at_;
    const std::string_view rest(start, left());
    const std::size_t end = std::min(rest.find('\n'), rest.size());
    at_ += std::min(end + 1, rest.size());
    std::string_view text = rest.substr(0, end);
    if (!text.empty() && text.back() == '\r') text.remove_suffix(1);
    return text;
  }
  /// Next word between blanks, empty at the end.
  [[nodiscard]] std::string_view word() {
    skipBlanks();
    const std::size_t start = at_;
    while (at_ < bytes_.size() && !isBlank(bytes_[at_])) ++at_;
    return {reinterpret_cast<const char*>(bytes_.data()) + start, at_ - start};
  }
  void skipBlanks() {
    while (at_ < bytes_.size() && isBlank(bytes_[at_])) ++at_;
  }
  [[nodiscard]] std::size_t left() const { return bytes_.size() - at_; }
  [[nodiscard]] std::size_t position() const { return at_; }
  void moveTo(std::size_t position) { at_ = std::min(position, bytes_.size()); }

 private:
  static bool isBlank(std::uint8_t c) {
    return c == ' ' || c == '\t' || c == '\n' || c == '\r' || c == '\v' || c == '\f';
  }

  const std::filesystem::path& path_;
  ByteView bytes_;
  std::size_t at_ = 0;
  bool bigEndian_;
};

/// Number written in `word`, or an IOError that shows the word.
template <class T>
[[nodiscard]] T parseNumber(const std::filesystem::path& path, std::string_view word) {
  if (word.starts_with('+')) word.remove_prefix(1);
  T value{};
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc{} || end != word.data() + word.size() || word.empty()) {
    failToRead(path, "a number is expected where it has '" + std::string(word.substr(0, 40)) + "'");
  }
  return value;
}

/// Shortest text that gives the value back exactly.
template <class T>
void appendNumber(std::string& text, T value) {
  char buffer[40];
  const auto result = std::to_chars(buffer, buffer + sizeof(buffer), value);
  text.append(buffer, result.ptr);
}

/// A line of a row's numbers after a word.
template <class Row>
void appendRow(std::string& text, std::string_view head, const Row& row, char between = ' ') {
  text += head;
  for (Eigen::Index k = 0; k < row.size(); ++k) {
    if (k > 0) text += between;
    appendNumber(text, row[k]);
  }
  text += '\n';
}

}  // namespace explica::io
