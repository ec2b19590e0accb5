// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Bytes.h"

#include "Explica/IO/SurfaceFile.h"

#include <vector>

namespace explica::io {

/// A format of surfaces: how its files are recognised, read and written.
struct SurfaceFormat {
  const char* name;
  std::vector<const char*> endings;   ///< lower case; none: written under every other name
  std::vector<const char*> others;    ///< endings that belong to its files' names beside those
  bool (*looksLike)(ByteView bytes);  ///< whether content is of this format
  bool nameTells;                     ///< content may not show it: the ending is believed, too
  LoadedSurface (*read)(const std::filesystem::path& path, ByteView bytes,
                        const SurfaceReadOptions& options);
  void (*write)(const std::filesystem::path& path, const TriangleMesh& mesh,
                const SurfaceMetadata& metadata);
};

/// Every format.  Readers look at the content in this order, then at the ending; writers take the
/// first format that has the name's ending.
[[nodiscard]] const std::vector<SurfaceFormat>& surfaceFormats();

}  // namespace explica::io
