// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Bytes.h"

#include "Explica/IO/SurfaceFile.h"
#include "Explica/IO/VertexDataFile.h"

#include <cstdint>
#include <vector>

// Own readers: VTK's accept damaged files without an error (of 300 each, all .vtp and 295 .vtk;
// five crashed it).
namespace explica::io {

/// Cells of different lengths: cell c has connectivity[offsets[c] .. offsets[c + 1]).
struct CellList {
  std::vector<std::int64_t> connectivity;
  std::vector<std::int64_t> offsets = {0};

  [[nodiscard]] std::size_t count() const { return offsets.size() - 1; }
};

/// VTK polydata as far as surfaces and polygons need it.
struct PolyData {
  std::vector<double> coordinates;  ///< x, y, z of each point
  CellList lines;
  CellList polygons;
  CellList strips;
  std::vector<VertexMap> pointMaps;
  bool saysRas = false;  ///< has the field SpaceRAS
};

[[nodiscard]] bool looksLikeVtkLegacy(ByteView bytes);
[[nodiscard]] bool looksLikeVtkXml(ByteView bytes);
/// Either kind.
[[nodiscard]] bool looksLikeVtk(ByteView bytes);
[[nodiscard]] LoadedSurface readVtkSurface(const std::filesystem::path& path, ByteView bytes,
                                           const SurfaceReadOptions& options);
/// Reads either kind.
[[nodiscard]] PolyData readPolyData(const std::filesystem::path& path, ByteView bytes);

}  // namespace explica::io
