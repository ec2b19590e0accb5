// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/TriangleMesh.h"
#include "Explica/Core/Volume.h"
#include "ResultFolder.h"

#include <filesystem>
#include <optional>

namespace explica::pipeline {

/// The border between what a label volume labels and what it does not, in steps of about 2 mm, for
/// outlines: voxels' faces, two triangles each, RAS mm.
/// @throws IOError, InvalidInput  as io::readLabels
[[nodiscard]] TriangleMesh borderOf(const std::filesystem::path& labels);

/// The brain that a segmentation found, if it is of this grid's size.
[[nodiscard]] std::optional<Volume<float>> brainOf(const StepFolder& segment, const Grid& grid);

}  // namespace explica::pipeline
