// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Application/Context.h"
#include "Explica/Registration/HeadRegistration.h"
#include "Explica/Segmentation/Atlas.h"

#include <optional>
#include <string>

namespace explica::app {

/// A template's volumes and what its labels mean; the brain stem has a label of its own.
struct LoadedTemplate {
  registration::Template volumes;
  segmentation::AtlasLegend legend;
  Label stem = 0;  ///< 0 if it has none
};

/// A template by name (colin27, or inia19 for a macaque: of mricron-data) or folder: T1.nii.gz
/// (with skull, may be absent), brain.nii.gz (without), atlas.nii.gz with its legend beside it.
/// @return nothing if it is not installed
/// @throws InvalidInput  an unknown name, a folder without brain or atlas, volumes on different
/// grids
[[nodiscard]] std::optional<LoadedTemplate> readTemplate(Context& context, const std::string& name);

/// What a legend file says; the one beside the atlas if none is named.
[[nodiscard]] segmentation::AtlasLegend readAtlasLegend(Context& context,
                                                        const std::filesystem::path& atlas,
                                                        const std::optional<std::string>& legend);

}  // namespace explica::app
