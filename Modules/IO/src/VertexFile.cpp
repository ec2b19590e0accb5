// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/IO/VertexFile.h"
#include "Explica/IO/StatedHemisphere.h"
#include "VertexFileEnding.h"

#include "Explica/Core/Errors.h"

#include <array>

namespace explica::io {

std::string vertexFileEnding(const std::string& name) {
  constexpr std::array<std::string_view, 12> kEndings = {
      ".shape.gii", ".func.gii", ".label.gii", ".surf.gii", ".gii", ".annot",
      ".label",     ".mgz",      ".mgh",       ".vtp",      ".vtk", ".ply"};
  for (const std::string_view ending : kEndings) {
    for (const std::string_view packed : {"", ".gz"}) {
      const std::string whole = std::string(ending) + std::string(packed);
      if (name.ends_with(whole)) return whole;
    }
  }
  return "";
}

bool namesLabels(const std::filesystem::path& path) {
  const std::string ending = vertexFileEnding(path.filename().string());
  return ending.starts_with(".label") || ending.starts_with(".annot");
}

Eigen::VectorXd readVertexNumbers(const std::filesystem::path& path, Eigen::Index vertexCount) {
  if (namesLabels(path)) return readVertexLabels(path, vertexCount).keys.cast<double>();
  return readVertexMaps(path, vertexCount).front().values;
}

VertexFileKind vertexFileKind(const std::filesystem::path& path) {
  const std::string ending = vertexFileEnding(path.filename().string());
  if (ending.starts_with(".surf")) return VertexFileKind::Surface;
  if (namesLabels(path)) return VertexFileKind::Labels;
  try {
    (void)readVertexMaps(path);
    return VertexFileKind::Maps;
  } catch (const Error&) {
    try {
      (void)readSurface(path);
      return VertexFileKind::Surface;
    } catch (const Error&) {
    }
    throw;
  }
}

std::string nameWithEntity(const std::filesystem::path& path, std::string_view entity) {
  const std::string name = path.filename().string();
  std::string ending = vertexFileEnding(name);
  const std::string stem = name.substr(0, name.size() - ending.size());
  if (ending.ends_with(".gz")) ending.resize(ending.size() - 3);
  if (ending == ".label") ending = ".label.gii";
  if (!ending.empty() && ending != ".annot" && !ending.ends_with(".gii")) ending = ".shape.gii";
  const std::size_t suffix = stem.rfind('_');
  const std::string with = "_" + std::string(entity);
  const bool bids = stem.find("hemi-") < suffix && suffix != std::string::npos;
  return bids ? stem.substr(0, suffix) + with + stem.substr(suffix) + ending : stem + with + ending;
}

void writeVertexMaps(const std::filesystem::path& path, const std::vector<VertexMap>& maps,
                     const std::string& structure, Eigen::Index faceCount) {
  if (path.extension() != ".gii") {
    if (maps.size() != 1) {
      throw InvalidInput("'" + path.string() + "': FreeSurfer's curv files hold one map, not " +
                         std::to_string(maps.size()));
    }
    writeFreeSurferCurv(path, maps.front().values, faceCount);
    return;
  }
  GiftiMapsWriter writer(path, structure.empty() ? "Other" : structure, maps.size());
  for (const VertexMap& map : maps) {
    const Eigen::VectorXf values = map.values.cast<float>();
    writer.add(map.name, map.unit, {values.data(), static_cast<std::size_t>(values.size())});
  }
  writer.finish();
}

}  // namespace explica::io
