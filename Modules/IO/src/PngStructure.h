// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Bytes.h"

#include <filesystem>

namespace explica::io {

/// Refuses a PNG file that libpng would abort on, as ITK calls it: the order, length and checksum
/// of its chunks, the header's fields and the palette [ISO 15948, clauses 5, 11 and 13].
/// @throws IOError  damaged, or smaller than its header announces
void checkPng(const std::filesystem::path& path, ByteView bytes);

}  // namespace explica::io
