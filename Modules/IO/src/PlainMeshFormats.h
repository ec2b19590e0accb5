// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Bytes.h"

#include "Explica/IO/SurfaceFile.h"

namespace explica::io {

/// Surfaces without a frame of their own.  Each reader fills the mesh, the maps that the file holds
/// and the notes of its origin.
[[nodiscard]] LoadedSurface readPly(const std::filesystem::path& path, ByteView bytes);
[[nodiscard]] LoadedSurface readObj(const std::filesystem::path& path, ByteView bytes);
[[nodiscard]] LoadedSurface readOff(const std::filesystem::path& path, ByteView bytes);
[[nodiscard]] LoadedSurface readStl(const std::filesystem::path& path, ByteView bytes);

[[nodiscard]] bool looksLikePly(ByteView bytes);
[[nodiscard]] bool looksLikeOff(ByteView bytes);
/// Binary of the right length, or text of facets.
[[nodiscard]] bool looksLikeStl(ByteView bytes);

void writePly(const std::filesystem::path& path, const TriangleMesh& mesh);
void writeObj(const std::filesystem::path& path, const TriangleMesh& mesh);
void writeOff(const std::filesystem::path& path, const TriangleMesh& mesh);
void writeStl(const std::filesystem::path& path, const TriangleMesh& mesh);

}  // namespace explica::io
