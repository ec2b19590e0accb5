// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "StoredVolume.h"

namespace explica::io {

/// Reads a grey picture as one slice, rows downwards, pixels of 1 mm.
/// @throws IOError       damaged
/// @throws InvalidInput  in colour, or with transparency
[[nodiscard]] StoredVolume readPng(const std::filesystem::path& path, Extent extent);

}  // namespace explica::io
