// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ByteSource.h"
#include "StoredVolume.h"

namespace explica::io {

/// True for the first bytes of MINC 1 (netCDF) or MINC 2 (HDF5).
[[nodiscard]] bool looksLikeMinc(ByteView firstBytes);

/// Reads MINC 1 or 2: dimensions xspace, yspace and zspace in any order, before them `time`, after
/// them `vector_dimension`.  Whole numbers are scaled slice by slice, as `valid_range`, `image-min`
/// and `image-max` say; values beyond the valid range count as its ends, as nibabel has it.
/// World coordinates are RAS mm already.
/// @throws IOError       damaged, or HDF5 of a kind that MINC's library does not write
/// @throws InvalidInput  other dimensions, irregular steps
[[nodiscard]] StoredVolume readMinc(ByteSource& source, const std::filesystem::path& path,
                                    Extent extent);

}  // namespace explica::io
