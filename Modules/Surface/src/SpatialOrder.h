// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/TriangleMesh.h"

namespace explica::surface {

/// The same mesh, its vertices numbered block by block along a curve that fills space [Morton1966]
/// and its faces in the order of their first vertices: neighbours in space are neighbours in
/// memory.
/// @param block  edge of a block, mm
[[nodiscard]] TriangleMesh inSpatialOrder(const TriangleMesh& mesh, double block);

}  // namespace explica::surface
