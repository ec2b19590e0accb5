// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/TriangleMesh.h"
#include "Explica/Report/FlatFigure.h"

namespace explica::io {
struct LabelMap;
}

namespace explica::pipeline {

/// Adds outlines and names of regions on a flat map, names of the largest first.
/// @param regions  keys of the map's vertices
/// @param flat     z = 0
void markRegions(const io::LabelMap& regions, const TriangleMesh& flat, report::FlatMarks& marks);

}  // namespace explica::pipeline
