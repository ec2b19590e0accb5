// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/TriangleMesh.h"

#include <cstdint>
#include <numeric>
#include <vector>

namespace explica::testing {

/// All vertices of a mesh, as a mask.
inline std::vector<bool> everyVertex(const TriangleMesh& mesh) {
  return std::vector<bool>(static_cast<std::size_t>(mesh.vertexCount()), true);
}

/// All faces of a mesh, as a list.
inline std::vector<std::int32_t> everyFace(const TriangleMesh& mesh) {
  std::vector<std::int32_t> faces(static_cast<std::size_t>(mesh.faceCount()));
  std::iota(faces.begin(), faces.end(), 0);
  return faces;
}

}  // namespace explica::testing
