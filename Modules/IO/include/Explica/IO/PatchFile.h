// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/TriangleMesh.h"

#include <filesystem>
#include <optional>
#include <vector>

namespace explica::io {

/// FreeSurfer's patch (`lh.cortex.patch.3d`, `lh.cortex.patch.flat`): the vertices of a surface
/// that are left after cuts, with places of their own.  It has no faces: those of the surface count
/// whose three vertices are in the patch.
struct Patch {
  std::vector<std::int32_t> vertices;  ///< of the whole surface, each once, ascending when written
  std::vector<bool> border;            ///< per patch vertex: it lies on the rim or a cut
  Positions positions;                 ///< per patch vertex, mm; surface RAS as stored, or z = 0
};

/// Reads a patch; coordinates are taken as they stand.
/// @param vertexCount  of the whole surface, if known
/// @throws IOError       missing, truncated, or no patch: names path and cause
/// @throws InvalidInput  a vertex that the surface lacks or that is there twice, or a coordinate
///                       that is not finite
[[nodiscard]] Patch readPatch(const std::filesystem::path& path,
                              std::optional<Eigen::Index> vertexCount = {});

/// Writes a patch: big-endian, float32, vertices in the order given.
/// @throws InvalidInput      lists of different length, or none
/// @throws EnvironmentError  the file cannot be written
void writePatch(const std::filesystem::path& path, const Patch& patch);

/// True if the file begins as a patch does.
[[nodiscard]] bool isPatchFile(const std::filesystem::path& path);

/// The whole surface's faces whose three vertices are in the patch, in its order.
/// @return F x 3, numbers of the whole surface
[[nodiscard]] Faces patchFaces(const Patch& patch, const Faces& faces, Eigen::Index vertexCount);

/// The patch of the marked vertices at the mesh's positions; its border are the vertices at edges
/// that one face of the patch alone has.
/// @param inPatch  one a vertex of the mesh
[[nodiscard]] Patch patchOf(const TriangleMesh& mesh, const std::vector<bool>& inPatch);

}  // namespace explica::io
