// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Describe.h"
#include "Explica/Core/Grid.h"
#include "Explica/Core/TriangleMesh.h"
#include "Explica/IO/VertexDataFile.h"

#include <array>
#include <filesystem>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace explica::io {

/// The frame of a file's coordinates.
enum class SurfaceSpace {
  Stated,   ///< what the file says; where it says nothing, as it stands, with a note
  Scanner,  ///< scanner RAS, whatever the file says: coordinates are not changed
  Tkr,  ///< FreeSurfer's surface RAS: moved to scanner RAS by the file's or `fsVolume`'s geometry
};
constexpr auto enumWords(SurfaceSpace) {
  using enum SurfaceSpace;
  return std::to_array<EnumWord<SurfaceSpace>>(
      {{Stated, "stated"}, {Scanner, "scanner"}, {Tkr, "tkr"}});
}

struct SurfaceReadOptions {
  SurfaceSpace space = SurfaceSpace::Stated;
  std::optional<std::string> fsVolume =
      std::nullopt;  ///< volume (orig.mgz) whose geometry places a tkr surface
};

template <class Visitor>
void describe(SurfaceReadOptions& options, Visitor&& visit) {
  visit(Field{"surface-space", "", "frame of the surface's coordinates, if its file does not say"},
        options.space);
  visit(Field{"fs-volume", "", "FreeSurfer volume (orig.mgz) whose geometry places the surface"},
        options.fsVolume);
}

/// What GIFTI files say about a surface.  Words that Workbench knows are listed there.
struct SurfaceMetadata {
  std::string structure = "Other";           ///< CortexLeft, CortexRight, Other, ...
  std::string secondary;                     ///< GrayWhite, MidThickness, Pial
  std::string geometricType = "Anatomical";  ///< Anatomical, Inflated, Flat, Reconstruction, ...
  std::string topologicalType;               ///< Closed, Open; found from the faces if empty
  std::string name;                          ///< of the point set
  std::map<std::string, std::string> extra;  ///< further file-level entries, e.g. Explica:Version
};

/// SurfaceOrigin::space of a surface whose file does not say it, and the note that goes with it.
inline constexpr const char* kFrameNotStated = "not stated";
inline constexpr const char* kFrameNotStatedNote =
    "coordinate system unknown; scanner mm assumed (say it with --surface-space scanner, or tkr "
    "and "
    "--fs-volume orig.mgz)";

/// Where a surface came from and how its file was understood; goes into the provenance record.
struct SurfaceOrigin {
  std::filesystem::path path;
  std::string format;  ///< "GIFTI", "FreeSurfer", "VTK", "VTP", "PLY", "OBJ", "STL",
                       ///< "OFF"
  std::string space;   ///< "scanner", "tkr, moved to scanner", "MNI", "not stated", ...
  Eigen::Matrix4d applied = Eigen::Matrix4d::Identity();  ///< from the file's coordinates to ours
  std::vector<std::string> notes;  ///< quads split, vertices merged, frame not stated, ...
};

struct LoadedSurface {
  TriangleMesh mesh;
  SurfaceMetadata metadata;     ///< structure from the file, else from a name such as lh.white
  std::vector<VertexMap> maps;  ///< per-vertex values that the file itself holds (VTK, PLY)
  SurfaceOrigin origin;
};

/// Reads a triangulated surface: GIFTI (any encoding, external data, .gz), FreeSurfer binary
/// (triangles and quads), VTK legacy and XML polydata, PLY, OBJ, MNI's OBJ (CIVET), STL (equal
/// corners merged), OFF.
/// The format is recognised by content first, then by name.  Polygons are split into triangles,
/// fan-wise.
///
/// Positions come back in scanner RAS mm where the file allows it (see SurfaceSpace).
///
/// @throws IOError       missing, truncated or of no known format: names path and cause
/// @throws InvalidInput  no triangles, a face that names a missing vertex, a coordinate that is not
///                       finite, or a tkr surface that nothing places
[[nodiscard]] LoadedSurface readSurface(const std::filesystem::path& path,
                                        const SurfaceReadOptions& options = {});

/// Writes a GIFTI surface: FLOAT32 scanner RAS and INT32 faces, gzip-base64, identity matrix;
/// Workbench wants `.surf.gii`.
/// @throws InvalidInput      empty mesh
/// @throws EnvironmentError  the file cannot be written
void writeGiftiSurface(const std::filesystem::path& path, const TriangleMesh& mesh,
                       const SurfaceMetadata& metadata = {});

/// Writes FreeSurfer's triangle format with the footer that tells the volume's geometry.
///
/// Without `volume` the footer describes a volume in which surface RAS and scanner RAS coincide, so
/// that readers that honour it and readers that do not agree.  With `volume` coordinates are moved
/// to that volume's surface RAS.
void writeFreeSurferSurface(const std::filesystem::path& path, const TriangleMesh& mesh,
                            const std::optional<Grid>& volume = {});

/// Writes a FreeSurfer triangle file anew with some vertices moved: every other byte is the
/// original's, comment, footer and what follows included.
/// @param positions  V x 3, in the coordinates of the original file
/// @throws IOError, InvalidInput  the original is no triangle file of as many vertices
void rewriteFreeSurferSurface(const std::filesystem::path& path,
                              const std::filesystem::path& original, const Positions& positions,
                              std::span<const std::int32_t> moved);

/// Writes by the name's extension: .gii, .vtp, .ply (binary, double), .obj, .off (all
/// text that gives back every double exactly), .stl (binary, float32); FreeSurfer for any other or
/// no extension.
void writeSurface(const std::filesystem::path& path, const TriangleMesh& mesh,
                  const SurfaceMetadata& metadata = {});

/// A file's name without what tells its format: "lh.pial" of lh.pial, lh.pial.surf.gii,
/// lh.pial.ply.
[[nodiscard]] std::string nameOfSurface(const std::filesystem::path& path);

/// The endings by which writeSurface() tells formats: ".gii", ".gii.gz", ".vtp", ...
[[nodiscard]] std::vector<std::string> surfaceEndings();

/// "CortexLeft", "CortexRight" from names such as lh.white, sub-01_hemi-R_pial.surf.gii; else
/// "Other".
[[nodiscard]] std::string structureFromName(const std::filesystem::path& path);

/// Whether a point far from a surface was given in the other of FreeSurfer's two frames: it lies
/// more than `far` mm off, but near the surface once it is taken from surface RAS (tkregister) to
/// scanner RAS, or back.
/// @param scannerFromTkr  between the frames; of a surface that was moved to scanner RAS
///                        SurfaceOrigin::applied
/// @return a sentence that says so, with the point in the surface's frame; empty if that is not so
[[nodiscard]] std::string frameMixUp(const Point& point, const Positions& positions,
                                     const Eigen::Matrix4d& scannerFromTkr, double far = 5);

/// Maps FreeSurfer's surface RAS of a volume to its scanner RAS: Norig * inverse(Torig).
[[nodiscard]] Eigen::Matrix4d scannerFromTkr(const Grid& volume);

}  // namespace explica::io
