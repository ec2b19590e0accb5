// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Bytes.h"

#include "Explica/IO/SurfaceFile.h"
#include "Explica/IO/VertexDataFile.h"

#include <optional>

namespace explica::io {

/// The volume of `key = value` lines as FreeSurfer writes them, in the footers of surfaces and in
/// LTA files; nothing if they are not whole, or say that they are not valid.
[[nodiscard]] std::optional<Grid> volumeInWords(const std::filesystem::path& path,
                                                ByteCursor& lines);

/// What the first bytes promise; old quad surfaces share a magic number with new curv files.
enum class FreeSurferKind { None, Surface, Curv };
[[nodiscard]] FreeSurferKind freeSurferKindOf(ByteView bytes);

[[nodiscard]] LoadedSurface readFreeSurferSurface(const std::filesystem::path& path, ByteView bytes,
                                                  const SurfaceReadOptions& options);
[[nodiscard]] VertexMap readFreeSurferCurv(const std::filesystem::path& path, ByteView bytes);

/// Old curv files have no magic number: true if the length fits.
[[nodiscard]] bool looksLikeOldCurv(ByteView bytes);
/// True if the length fits an annotation.
[[nodiscard]] bool looksLikeAnnot(ByteView bytes);
[[nodiscard]] LabelMap readFreeSurferAnnot(const std::filesystem::path& path, ByteView bytes);
[[nodiscard]] LabelMap readFreeSurferLabel(const std::filesystem::path& path, ByteView bytes,
                                           std::optional<Eigen::Index> vertexCount);

}  // namespace explica::io
