// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ByteSource.h"
#include "StoredVolume.h"

namespace explica::io {

/// True for the first bytes of an MGH file (unpacked, if it is .mgz).
[[nodiscard]] bool looksLikeMgh(ByteView firstBytes);

[[nodiscard]] StoredVolume readMgh(ByteSource& source, Extent extent);

/// 284 bytes: FreeSurfer's geometry with goodRASFlag 1.
[[nodiscard]] Bytes mghHeader(const VolumeToWrite& volume);
/// The scan parameters that follow the data, all 0 (unknown).
[[nodiscard]] Bytes mghFooter();

}  // namespace explica::io
