// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Report/SurfacePicture.h"

#include <string>
#include <utility>
#include <vector>

namespace explica::pipeline {

/// Views of a hemisphere ("left", "right"; else as the left): lateral, medial, dorsal, ventral,
/// frontal, occipital.
[[nodiscard]] std::vector<std::pair<std::string, report::ViewName>> standardViews(
    const std::string& side);

/// Size of the pictures that stand side by side on a page.
[[nodiscard]] report::SurfacePictureOptions viewSize();

}  // namespace explica::pipeline
