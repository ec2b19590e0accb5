// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/TriangleMesh.h"
#include "Explica/IO/VertexDataFile.h"

#include <filesystem>
#include <vector>

namespace explica::io {

/// Writes a surface with values for ParaView and Slicer: XML polydata, raw appended binary, float64
/// coordinates in RAS mm and a field `SpaceRAS` = 1 that says so.  Not-a-number stays.
/// @throws InvalidInput      a map whose length does not fit
/// @throws EnvironmentError  the file cannot be written
void writeVtp(const std::filesystem::path& path, const TriangleMesh& mesh,
              const std::vector<VertexMap>& vertexMaps = {},
              const std::vector<VertexMap>& faceMaps = {});

/// The shape of a cell of an unstructured grid.
enum class CellKind { Line, Quad, Hexahedron };

/// Cells of one kind: each row lists the vertices in VTK's order.
struct Cells {
  CellKind kind = CellKind::Hexahedron;
  Eigen::Matrix<std::int32_t, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> vertices;
};

/// Writes points and cells, e.g. the anatomical grid, as XML unstructured grid; else as writeVtp.
void writeVtu(const std::filesystem::path& path, const Positions& points,
              const std::vector<Cells>& cells, const std::vector<VertexMap>& pointMaps = {},
              const std::vector<VertexMap>& cellMaps = {});

}  // namespace explica::io
