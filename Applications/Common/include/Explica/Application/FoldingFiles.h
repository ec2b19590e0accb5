// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Application/CortexTemplate.h"
#include "Explica/IO/SurfaceFile.h"
#include "Explica/Sphere/Register.h"

#include <optional>
#include <string>

namespace explica::app {

/// Files of a sphere and of its folding maps: of a template or of a person.
using FoldingFiles = CortexTemplate;

/// Folding maps beside a sphere, or in a folder of `explica surface`, where they are not named.
/// @throws InvalidInput  says which file is missing and how to name it
[[nodiscard]] FoldingFiles subjectFiles(const std::string& sphere, const std::string& structure,
                                        const std::optional<std::string>& sulc,
                                        const std::optional<std::string>& curvature,
                                        const std::optional<std::string>& folder);

/// Reads them, each recorded as an input, and demands a sphere about the origin; faces turned over
/// are mended and said.
[[nodiscard]] sphere::FoldingSphere readFolding(Context& context, const FoldingFiles& files,
                                                std::string_view role = "file");

}  // namespace explica::app
