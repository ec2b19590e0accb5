// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Flattening/Disc.h"
#include "Subject.h"

#include <optional>

namespace explica::app {

/// Reads what is written beside the map once, so that its faults are said before the long part:
/// maps, regions, surfaces, volumes, and whether the patch lies in these.
/// @return the tissue's surfaces, if they are given
/// @throws InvalidInput  a file that does not fit, or a volume in which no vertex of the patch lies
[[nodiscard]] std::optional<Cortex> checkBeside(Context& context, const FlattenSettings& s,
                                                const Subject& subject);

/// grid.nii.gz, the volumes in it, and to_flat.nii.gz.
void writeGrid(Context& context, const FlattenSettings& s, const std::optional<Cortex>& cortex,
               const flattening::Disc& disc, const TriangleMesh& flat);

}  // namespace explica::app
