// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ByteSource.h"
#include "StoredVolume.h"

namespace explica::io {

/// True for the first bytes of NIfTI-1, NIfTI-2 or Analyze headers (the last to say why not).
[[nodiscard]] bool looksLikeNifti(ByteView firstBytes);

[[nodiscard]] StoredVolume readNifti(ByteSource& source, PlacementChoice placement, Extent extent);

/// Header of a single-file NIfTI-1, or NIfTI-2 where a size exceeds 32767; what follows is the
/// data.
[[nodiscard]] Bytes niftiHeader(const VolumeToWrite& volume);

}  // namespace explica::io
