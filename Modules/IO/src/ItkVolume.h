// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "StoredVolume.h"

namespace explica::io {

enum class ItkFormat { Nrrd, MetaImage };

/// Reads through ITK's own ImageIO of the format, and turns its LPS into RAS.  The header is
/// checked before ITK sees it, because ITK trusts the sizes it finds there.
[[nodiscard]] StoredVolume readWithItk(const std::filesystem::path& path, ItkFormat format,
                                       Extent extent);

}  // namespace explica::io
