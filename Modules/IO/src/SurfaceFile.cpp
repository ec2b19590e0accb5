// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/IO/SurfaceFile.h"

#include "ByteSource.h"
#include "FreeSurferFormat.h"
#include "GiftiFormat.h"
#include "MeshBuilder.h"
#include "PlainMeshFormats.h"
#include "SurfaceFrame.h"
#include "VtkFormat.h"

#include "Explica/IO/VtkFile.h"

namespace explica::io {
namespace {

LoadedSurface readVtkSurface(const std::filesystem::path& path, ByteView bytes,
                             const SurfaceReadOptions& options) {
  PolyData data = readPolyData(path, bytes);
  MeshBuilder builder;
  builder.coordinates = std::move(data.coordinates);
  for (std::size_t c = 0; c < data.polygons.count(); ++c) {
    const std::int64_t begin = data.polygons.offsets[c];
    builder.addPolygon(path, data.polygons.connectivity.data() + begin,
                       static_cast<std::size_t>(data.polygons.offsets[c + 1] - begin));
  }
  for (std::size_t c = 0; c < data.strips.count(); ++c) {
    // Every other triangle of a strip runs backwards.
    for (std::int64_t i = data.strips.offsets[c]; i + 2 < data.strips.offsets[c + 1]; ++i) {
      const std::int64_t* at = data.strips.connectivity.data() + i;
      const bool odd = (i - data.strips.offsets[c]) % 2 != 0;
      builder.triangles.insert(builder.triangles.end(), {at[0], at[odd ? 2 : 1], at[odd ? 1 : 2]});
    }
  }
  LoadedSurface surface;
  surface.origin.path = path;
  surface.origin.format = looksLikeVtkLegacy(bytes) ? "VTK" : "VTP";
  surface.metadata.structure = structureFromName(path);
  surface.mesh = builder.finish(path, surface.origin.notes);
  surface.maps = std::move(data.pointMaps);
  FrameInFile frame;
  if (data.saysRas) frame.stated = "scanner";
  moveToScanner(surface, frame, options);
  return surface;
}

LoadedSurface placed(LoadedSurface surface, const SurfaceReadOptions& options) {
  moveToScanner(surface, {}, options);
  return surface;
}

}  // namespace

LoadedSurface readSurface(const std::filesystem::path& path, const SurfaceReadOptions& options) {
  const Bytes bytes = ByteSource(path).rest();
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  if (looksLikeGifti(bytes)) return readGiftiSurface(path, bytes, options);
  if (looksLikeVtkLegacy(bytes) || looksLikeVtkXml(bytes)) {
    return readVtkSurface(path, bytes, options);
  }
  switch (freeSurferKindOf(bytes)) {
    case FreeSurferKind::Surface:
      return readFreeSurferSurface(path, bytes, options);
    case FreeSurferKind::Curv:
      refuse(path, "holds per-vertex values; a surface is needed");
    case FreeSurferKind::None:
      break;
  }
  if (text.starts_with("ply\n") || text.starts_with("ply\r\n")) {
    return placed(readPly(path, bytes), options);
  }
  if (looksLikeOff(text)) return placed(readOff(path, bytes), options);
  std::filesystem::path named = path;
  if (named.extension() == ".gz") named.replace_extension();
  const std::string extension = named.extension().string();
  if (extension == ".stl" || extension == ".STL" || looksLikeStl(bytes)) {
    return placed(readStl(path, bytes), options);
  }
  if (extension == ".obj" || extension == ".OBJ") return placed(readObj(path, bytes), options);
  failToRead(path,
             "is not a surface of a known format (GIFTI, FreeSurfer, VTK, PLY, OBJ, STL, OFF)");
}

void writeSurface(const std::filesystem::path& path, const TriangleMesh& mesh,
                  const SurfaceMetadata& metadata) {
  if (mesh.vertexCount() == 0 || mesh.faceCount() == 0) {
    throw InvalidInput("surface for " + quoted(path) + ": it has no triangles");
  }
  const std::string name = path.filename().string();
  if (name.ends_with(".gii") || name.ends_with(".gii.gz")) {
    writeGiftiSurface(path, mesh, metadata);
  } else if (name.ends_with(".vtp")) {
    writeVtp(path, mesh);
  } else if (name.ends_with(".ply")) {
    writePly(path, mesh);
  } else if (name.ends_with(".obj")) {
    writeObj(path, mesh);
  } else if (name.ends_with(".off")) {
    writeOff(path, mesh);
  } else if (name.ends_with(".stl")) {
    writeStl(path, mesh);
  } else {
    writeFreeSurferSurface(path, mesh);
  }
}

}  // namespace explica::io
