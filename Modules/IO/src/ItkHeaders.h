// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "StoredVolume.h"

namespace explica::io {

/// NRRD's header, up to the blank line before the values.
[[nodiscard]] Bytes nrrdHeader(const VolumeToWrite& volume);

/// MetaImage's header; places are LPS, as ITK has it.
[[nodiscard]] Bytes metaHeader(const VolumeToWrite& volume);

}  // namespace explica::io
