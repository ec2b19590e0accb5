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

/// The first bytes of NIfTI-1, NIfTI-2 or Analyze headers (the last to say why not).
[[nodiscard]] bool looksLikeNifti(ByteView firstBytes);
[[nodiscard]] bool looksLikeMgh(ByteView firstBytes);

[[nodiscard]] StoredVolume readNifti(ByteSource& source, const std::filesystem::path& path,
                                     const VolumeReadOptions& options, Extent extent);
[[nodiscard]] StoredVolume readMgh(ByteSource& source, const std::filesystem::path& path,
                                   const VolumeReadOptions& options, Extent extent);
[[nodiscard]] StoredVolume readNrrd(ByteSource& source, const std::filesystem::path& path,
                                    const VolumeReadOptions& options, Extent extent);
[[nodiscard]] StoredVolume readMetaImage(ByteSource& source, const std::filesystem::path& path,
                                         const VolumeReadOptions& options, Extent extent);
/// A grey picture as one slice, rows downwards, pixels of 1 mm.
[[nodiscard]] StoredVolume readPng(ByteSource& source, const std::filesystem::path& path,
                                   const VolumeReadOptions& options, Extent extent);

/// Header of a single-file NIfTI-1, or NIfTI-2 where a size exceeds 32767; what follows is the
/// data.
[[nodiscard]] Bytes niftiHeader(const VolumeToWrite& volume);
/// 284 bytes: FreeSurfer's geometry with goodRASFlag 1.
[[nodiscard]] Bytes mghHeader(const VolumeToWrite& volume);
/// The scan parameters that follow the data, all 0 (unknown).
[[nodiscard]] Bytes mghFooter();

/// Every format, in the order in which readers look at the content.
[[nodiscard]] const std::vector<VolumeFormat>& volumeFormats();

}  // namespace explica::io
