// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Types.h"
#include "Explica/IO/VertexDataFile.h"

#include <filesystem>
#include <vector>

namespace explica::io {

/// Reads one closed polygon: text with two numbers a line (comma, semicolon, blank or tab between,
/// one optional header line, '#' comments), or VTK polydata (legacy or XML) whose lines or single
/// polygon close one loop in a plane of constant z.  A last vertex equal to the first is dropped.
///
/// @return V x 2, mm, in the file's order along the loop
/// @throws IOError       missing, truncated or of no known format
/// @throws InvalidInput  fewer than 3 vertices, a value that is not finite, a vertex farther than
///                       10 km from the origin, an open line, two loops
[[nodiscard]] Positions2 readPolygon(const std::filesystem::path& path);

/// Writes `x,y`, one vertex a line; numbers give back every double.
void writePolygonCsv(const std::filesystem::path& path, const Positions2& polygon);

/// Writes XML polydata: vertices at z = 0, one line cell an edge (i, i + 1).
/// @param edgeMaps  one value an edge: the edge from vertex i to vertex i + 1
void writePolygonVtp(const std::filesystem::path& path, const Positions2& polygon,
                     const std::vector<VertexMap>& vertexMaps = {},
                     const std::vector<VertexMap>& edgeMaps = {});

}  // namespace explica::io
