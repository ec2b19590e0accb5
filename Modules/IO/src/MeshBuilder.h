// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Bytes.h"

#include "Explica/IO/SurfaceFile.h"

#include <cstdint>
#include <vector>

namespace explica::io {

/// Gathers what a surface file holds and checks it as a whole.
struct MeshBuilder {
  std::vector<double> coordinates;      ///< x, y, z of each vertex
  std::vector<std::int32_t> triangles;  ///< three vertices each; see vertexNumber()
  std::int64_t splitPolygons = 0;

  /// A vertex as the file has it, in 32 bits: numbers that no mesh has become -1.
  [[nodiscard]] static std::int32_t vertexNumber(std::int64_t inFile);

  /// Adds a polygon, cut into a fan of triangles.
  /// @throws IOError  fewer than 3 corners
  void addPolygon(const std::filesystem::path& path, const std::int64_t* corners,
                  std::size_t count);

  /// The surface, into which what was gathered goes, with the structure that its file's name tells;
  /// notes how many polygons were split.
  /// @throws InvalidInput  no triangle, a missing vertex, a coordinate that is not finite
  [[nodiscard]] LoadedSurface finish(const std::filesystem::path& path, const char* format);
};

/// A count from a file, bounded by the bytes that each item takes at least.
/// @throws IOError  negative, or more than fit
[[nodiscard]] std::size_t checkedCount(const std::filesystem::path& path, std::int64_t count,
                                       std::size_t bytesLeft, std::size_t bytesEach,
                                       const char* what);

/// Adds the columns of a table of values, a row for each vertex; "name[0]" and so on where there
/// are several.
void addColumns(std::vector<VertexMap>& maps, const std::string& name, const std::string& unit,
                const std::vector<double>& values, std::size_t columns);

/// A vertex's number that a file keeps as a real one.
/// @throws IOError  not whole, or beyond what a double holds exactly
[[nodiscard]] std::int64_t wholeNumber(const std::filesystem::path& path, double value);

}  // namespace explica::io
