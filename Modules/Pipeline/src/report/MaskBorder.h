// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/TriangleMesh.h"

#include <filesystem>

namespace explica::pipeline {

/// The border between what a label volume labels and what it does not, in steps of about 2 mm, for
/// outlines: voxels' faces, two triangles each, RAS mm.
/// @throws IOError, InvalidInput  as io::readLabels
[[nodiscard]] TriangleMesh borderOf(const std::filesystem::path& labels);

}  // namespace explica::pipeline
