// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Application/Command.h"
#include "Explica/Application/ReadInputs.h"
#include "Explica/Core/Errors.h"
#include "Explica/Geometry/MeshMeasures.h"
#include "Explica/Geometry/MeshTopology.h"
#include "Explica/IO/StatedHemisphere.h"
#include "Explica/IO/VertexFile.h"
#include "Explica/Maps/Smoothing.h"

#include <nlohmann/json.hpp>

#include <charconv>
#include <optional>
#include <set>

namespace explica::app {
namespace {

struct SmoothSettings {
  std::vector<std::string> maps;
  std::optional<std::string> surface, mask;
  io::SurfaceReadOptions reading;
  double fwhm = 0;
};

void declare(Declaration& d, SmoothSettings& s) {
  d.synopsis("maps on a surface, diffused along it")
      .description(
          "Solves the heat equation on the surface, so that a point spreads to a Gaussian of the "
          "width that --fwhm says, and integrals over the surface stay. Vertices that hold NaN, "
          "and those where --mask is 0, keep their values and do not reach others. Give the "
          "surface whose distances count, usually the middle surface of the same person.\n\n"
          "summary.json says how smooth each file is before and after (fwhm_before, fwhm_after): "
          "the width of the kernel that would give white noise the same differences between "
          "neighbours; of files with five maps or more, of their residuals about the mean map.")
      .reference("Worsley et al. 1999, Human Brain Mapping 8:98-101")
      .example("explica smooth lh.thickness --surface lh.white --fwhm 10 --out smoothed",
               "Thickness smoothed by 10 mm, as smoothed/lh.thickness_fwhm-10")
      .input("MAP", FileKind::VertexData, "per-vertex maps; series are smoothed map by map", s.maps)
      .inputOption("surface", FileKind::Surface, "surface with the maps' vertices", s.surface)
      .require("surface")
      .options("Reading", s.reading)
      .inputOption("mask", FileKind::VertexData, "map or labels: smooth where it is not 0", s.mask)
      .category("Smoothing")
      .option({"fwhm", "mm", "full width at half maximum of the kernel", kAboveZero, 1e3}, s.fwhm)
      .require("fwhm")
      .output("*_fwhm-*", FileKind::VertexData, "NAME_fwhm-N: each map, in its file's format");
}

/// Vertices to smooth: where the mask's first map or label is not 0.
std::vector<bool> maskOf(const std::optional<std::string>& path, Eigen::Index vertexCount) {
  if (!path) return {};
  std::vector<bool> mask;
  for (const double value : io::readVertexNumbers(*path, vertexCount)) mask.push_back(value != 0);
  return mask;
}

struct MapFile {
  std::string path, output, structure;
  std::vector<io::VertexMap> maps;

  [[nodiscard]] Eigen::MatrixXd values() const {
    Eigen::MatrixXd all(maps.front().values.size(), static_cast<Eigen::Index>(maps.size()));
    for (std::size_t m = 0; m < maps.size(); ++m) {
      all.col(static_cast<Eigen::Index>(m)) = maps[m].values;
    }
    return all;
  }
};

std::string shortNumber(double value) {
  char text[32];
  const auto end = std::to_chars(text, text + sizeof text, value);
  return {text, end.ptr};
}

std::vector<MapFile> readMapFiles(const SmoothSettings& s, const io::LoadedSurface& surface) {
  std::vector<MapFile> files;
  std::set<std::string> names;
  for (const std::string& path : s.maps) {
    if (io::vertexFileKind(path) != io::VertexFileKind::Maps) {
      throw InvalidInput("'" + path +
                         "': only maps of numbers can be smoothed, not labels or surfaces");
    }
    MapFile file{path, io::nameWithEntity(path, "fwhm-" + shortNumber(s.fwhm)),
                 io::statedStructure(path), io::readVertexMaps(path, surface.mesh.vertexCount())};
    if (file.structure.empty()) file.structure = surface.metadata.structure;
    if (!names.insert(file.output).second) {
      throw UsageError("two maps would be written to '" + file.output +
                       "'; smooth them into folders of their own");
    }
    files.push_back(std::move(file));
  }
  return files;
}

Termination run(Context& context, const SmoothSettings& s) {
  const io::LoadedSurface surface = readSurface(context, "surface", *s.surface, s.reading);
  const TriangleMesh& mesh = surface.mesh;
  geometry::requireManifold(mesh, *s.surface);
  const std::vector<MapFile> files = readMapFiles(s, surface);
  const std::vector<bool> mask = maskOf(s.mask, mesh.vertexCount());
  if (const double edge = geometry::meanEdgeLength(mesh); s.fwhm < 2 * edge) {
    context.warn("--fwhm is less than two edges of the surface (" + shortNumber(edge) +
                 " mm in the mean): the mesh is too coarse for a kernel of this width");
  }
  auto step = context.step("smooth");
  nlohmann::ordered_json each = nlohmann::ordered_json::array();
  for (const MapFile& file : files) {
    const Eigen::MatrixXd before = file.values();
    const Eigen::MatrixXd after = maps::smoothMaps(mesh, before, s.fwhm, mask, context.monitor());
    std::vector<io::VertexMap> written = file.maps;
    for (std::size_t m = 0; m < written.size(); ++m) {
      written[m].values = after.col(static_cast<Eigen::Index>(m));
    }
    io::writeVertexMaps(context.output(file.output), written, file.structure, mesh.faceCount());
    each.push_back({{"map", file.output},
                    {"maps", written.size()},
                    {"fwhm_before", maps::estimateFwhm(mesh, before, mask)},
                    {"fwhm_after", maps::estimateFwhm(mesh, after, mask)}});
  }
  context.result("vertices", mesh.vertexCount());
  context.result("fwhm", each.front()["fwhm_after"].get<double>());
  context.result("maps", each);
  return Termination::NotRun;
}

}  // namespace

Command smoothCommand() {
  return makeCommand<SmoothSettings>("smooth", declare, run);
}

}  // namespace explica::app
