// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Application/Context.h"
#include "Explica/IO/SurfaceFile.h"
#include "Explica/Sphere/Register.h"

#include <optional>
#include <string>

namespace explica::app {

/// Files of a sphere and of its folding maps.
struct FoldingFiles {
  std::string sphere;
  std::string sulc, curvature;
  std::string sulcSd, curvatureSd;  ///< empty if there are none
};

/// Folding maps beside a sphere, or in a folder of `explica surface`, where they are not named.
/// @throws InvalidInput  says which file is missing and how to name it
[[nodiscard]] FoldingFiles subjectFiles(const std::string& sphere, const std::string& structure,
                                        const std::optional<std::string>& sulc,
                                        const std::optional<std::string>& curvature,
                                        const std::optional<std::string>& folder);

/// A template's files: `name` is a folder, or that of a subject in $SUBJECTS_DIR.
/// @throws InvalidInput  no such folder, or a file of it missing
[[nodiscard]] FoldingFiles templateFiles(const std::string& name, const std::string& structure);

/// Reads them, each recorded as an input, and demands a sphere about the origin; faces turned over
/// are mended and said.
[[nodiscard]] sphere::FoldingSphere readFolding(Context& context, const FoldingFiles& files);

}  // namespace explica::app
