// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

namespace explica::provenance {

/// A file's identity: its content, not its name or date.
struct Digest {
  std::uintmax_t size = 0;  ///< bytes
  std::string sha256;       ///< 64 lower-case hexadecimal digits

  bool operator==(const Digest&) const = default;
};

/// @throws IOError  absent, unreadable or not a regular file: names the path and the cause
[[nodiscard]] Digest digestOf(const std::filesystem::path& file);

[[nodiscard]] std::string sha256Of(std::string_view bytes);

}  // namespace explica::provenance
