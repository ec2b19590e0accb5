// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Bytes.h"

#include "Explica/IO/SurfaceFile.h"

namespace explica::io {

/// MNI's object files (BIC's `.obj`, which CIVET writes): polygons as text or binary.  They share
/// their ending with Wavefront's.
[[nodiscard]] bool looksLikeMniObj(ByteView bytes);

/// Coordinates are MINC's world, mm along right, anterior and superior.
/// @throws IOError       damaged, or binary
/// @throws InvalidInput  lines or points instead of polygons
[[nodiscard]] LoadedSurface readMniObj(const std::filesystem::path& path, ByteView bytes,
                                       const SurfaceReadOptions& options);

/// Text that gives back every double, normals included.
void writeMniObj(const std::filesystem::path& path, const TriangleMesh& mesh);

}  // namespace explica::io
