// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Bytes.h"

#include "Explica/IO/SurfaceFile.h"
#include "Explica/IO/VertexDataFile.h"

#include <map>
#include <string>
#include <vector>

namespace explica::io {

using Metadata = std::map<std::string, std::string>;

/// One array of a GIFTI file, its values in row-major order.
struct GiftiArray {
  std::string intent;  ///< "NIFTI_INTENT_POINTSET", ...
  std::vector<std::int64_t> size;
  std::vector<double> values;
  Metadata metadata;
  std::string dataSpace;  ///< "NIFTI_XFORM_SCANNER_ANAT", ...; empty if not said
  bool identityMatrix = true;
};

struct GiftiFile {
  Metadata metadata;
  std::vector<LabelEntry> table;
  std::vector<GiftiArray> arrays;
};

[[nodiscard]] bool looksLikeGifti(ByteView bytes);
[[nodiscard]] GiftiFile parseGifti(const std::filesystem::path& path, ByteView bytes);

/// The table as GIFTI and CIFTI have it.
[[nodiscard]] std::string labelTableXml(const std::vector<LabelEntry>& table);

[[nodiscard]] LoadedSurface readGiftiSurface(const std::filesystem::path& path, ByteView bytes,
                                             const SurfaceReadOptions& options);
[[nodiscard]] std::vector<VertexMap> readGiftiMaps(const std::filesystem::path& path,
                                                   ByteView bytes);
[[nodiscard]] LabelMap readGiftiLabels(const std::filesystem::path& path, ByteView bytes);

}  // namespace explica::io
