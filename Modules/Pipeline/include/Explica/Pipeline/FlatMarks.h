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

/// Adds the body's directions where most of the map goes one way: the gradients of RAS coordinates
/// over the map by least squares, if they explain 40 % of a coordinate's variance.
/// @param folded  V x 3, mm RAS, of the map's vertices
void markDirections(const Positions& folded, const TriangleMesh& flat, report::FlatMarks& marks);

}  // namespace explica::pipeline
