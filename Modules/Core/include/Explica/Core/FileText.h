// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>

namespace explica {

constexpr std::size_t kMostFileText = std::size_t{256}
                                      << 20;  ///< bytes of a table, script or state

/// The bytes of a regular file: the one way to read what is no volume or surface.  A pipe that
/// nobody writes to and a device without an end are refused without waiting.
/// @param most  bytes that such a file has at most
/// @throws IOError  missing, a folder, a pipe or device, larger, or not permitted
[[nodiscard]] std::string fileText(const std::filesystem::path& path,
                                   std::size_t most = kMostFileText);

}  // namespace explica
