// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Application/Command.h"
#include "Explica/IO/SurfaceFile.h"
#include "Explica/Visibility/GlobalFlow.h"

namespace explica::app {

/// Descends on a global measure of the thesis in place of inflating, and writes the end, the
/// evolution and what became of area, volume and visibility.
/// @param viewpoints  of the sphere from which visibility is judged
Termination runGlobalFlow(Context& context, TriangleMesh mesh, io::SurfaceMetadata metadata,
                          const visibility::GlobalFlowOptions& options, int viewpoints);

}  // namespace explica::app
