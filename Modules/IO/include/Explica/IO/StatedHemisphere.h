// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Hemisphere.h"

#include <filesystem>
#include <optional>
#include <string>

namespace explica::io {

/// The hemisphere that a surface or a file of vertex data states: GIFTI's
/// AnatomicalStructurePrimary (of the file or of an array), else a name such as lh.white or
/// sub-01_hemi-R_pial.surf.gii. Nothing if neither does, or if the file cannot be read.
[[nodiscard]] std::optional<Hemisphere> statedHemisphere(const std::filesystem::path& file);

/// The same in GIFTI's words, "CortexLeft" or "CortexRight"; empty if nothing is stated.
[[nodiscard]] std::string statedStructure(const std::filesystem::path& file);

/// The name of a map or a region without what tells its hemisphere: lh.thickness is thickness,
/// ctx-lh-insula insula, Insula_L Insula.
[[nodiscard]] std::string withoutSide(std::string name);

}  // namespace explica::io
