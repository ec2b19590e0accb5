// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "SurfaceFormats.h"

#include "FreeSurferFormat.h"
#include "GiftiFormat.h"
#include "PlainMeshFormats.h"
#include "SurfaceFrame.h"
#include "VtkFormat.h"

#include "Explica/IO/VtkFile.h"

namespace explica::io {
namespace {

using Path = std::filesystem::path;

/// Of formats that say nothing of the frame.
template <LoadedSurface (*read)(const Path&, ByteView)>
LoadedSurface readPlaced(const Path& path, ByteView bytes, const SurfaceReadOptions& options) {
  LoadedSurface surface = read(path, bytes);
  moveToScanner(surface, {}, options);
  return surface;
}

/// Of formats that keep nothing but the mesh.
template <void (*write)(const Path&, const TriangleMesh&)>
void writeMesh(const Path& path, const TriangleMesh& mesh, const SurfaceMetadata&) {
  write(path, mesh);
}

void writeVtpMesh(const Path& path, const TriangleMesh& mesh, const SurfaceMetadata&) {
  writeVtp(path, mesh);
}

void writeFreeSurferMesh(const Path& path, const TriangleMesh& mesh, const SurfaceMetadata&) {
  writeFreeSurferSurface(path, mesh);
}

bool looksLikeFreeSurfer(ByteView bytes) {
  return freeSurferKindOf(bytes) == FreeSurferKind::Surface;
}

/// Wavefront's files begin with anything.
bool looksLikeNothing(ByteView) {
  return false;
}

}  // namespace

const std::vector<SurfaceFormat>& surfaceFormats() {
  static const std::vector<SurfaceFormat> all = {
      {"GIFTI",
       {".gii", ".gii.gz"},
       {".surf.gii"},
       looksLikeGifti,
       false,
       readGiftiSurface,
       writeGiftiSurface},
      {"VTK", {".vtp"}, {".vtk"}, looksLikeVtk, false, readVtkSurface, writeVtpMesh},
      {"FreeSurfer",
       {},
       {},
       looksLikeFreeSurfer,
       false,
       readFreeSurferSurface,
       writeFreeSurferMesh},
      {"PLY", {".ply"}, {}, looksLikePly, false, readPlaced<readPly>, writeMesh<writePly>},
      {"OFF", {".off"}, {}, looksLikeOff, false, readPlaced<readOff>, writeMesh<writeOff>},
      {"STL", {".stl"}, {}, looksLikeStl, true, readPlaced<readStl>, writeMesh<writeStl>},
      {"OBJ", {".obj"}, {}, looksLikeNothing, true, readPlaced<readObj>, writeMesh<writeObj>}};
  return all;
}

}  // namespace explica::io
