// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ByteSource.h"
#include "StoredVolume.h"

#include <vector>

namespace explica::io {

/// By so many bytes of a file, unpacked, its format is recognised.
inline constexpr std::size_t kTellingBytes = 348;

/// An ending under which a format is written.
struct VolumeEnding {
  const char* text;
  bool packed;  ///< by gzip
};

/// How a format is written.
struct VolumeLayout {
  Bytes (*head)(const VolumeToWrite& volume);
  Bytes (*tail)() = nullptr;
  bool bigEndian = false;
};

/// A format of volumes: how its files are recognised, read and written.
struct VolumeFormat {
  const char* name;
  bool (*looksLike)(ByteView firstBytes);
  StoredVolume (*read)(ByteSource& source, const std::filesystem::path& path,
                       const VolumeReadOptions& options, Extent extent);
  std::vector<VolumeEnding> endings = {};  ///< none: not written
  std::optional<VolumeLayout> layout = {};
};

/// Every format, in the order in which readers look at the content.
[[nodiscard]] const std::vector<VolumeFormat>& volumeFormats();

}  // namespace explica::io
