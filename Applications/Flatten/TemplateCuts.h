// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Application/Context.h"
#include "Explica/Flattening/Cuts.h"
#include "Settings.h"

#include <vector>

namespace explica::app {

/// A template's medial wall and cuts for a person's surface.
struct TemplateCuts {
  std::vector<bool> cortex;  ///< of the person's vertices: off the template's wall
  Positions places;          ///< of the person's vertices on the sphere of the lines, mm
  std::vector<flattening::CutLine> lines;
};

/// Those of lh.cuts.label.gii in the template's folder; else found on its white surface as by
/// --cuts auto, each named by the region in which it ends.
/// @throws InvalidInput  no sphere in register; a template without cuts and white surface; a name
///                       that no cut has
[[nodiscard]] TemplateCuts readTemplateCuts(Context& context, const FlattenSettings& s,
                                            const TriangleMesh& surface);

}  // namespace explica::app
