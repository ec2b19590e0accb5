// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "ShownSurface.h"
#include "Explica/Core/Folders.h"
#include "Explica/Core/Text.h"

namespace explica::app {
namespace {

namespace fs = std::filesystem;

constexpr const char* kValid = "valid.shape.gii";

bool saysThickness(const std::string& text) {
  return lowerCase(text).find("thick") != std::string::npos;
}

/// 1 where maps beside it hold, by one map for all of them; none where there is no such file.
std::optional<Eigen::VectorXd> validBeside(const fs::path& file, Eigen::Index count) {
  const fs::path beside = file.parent_path() / kValid;
  if (file.filename() == kValid || !isThere(beside)) return {};
  const auto maps = io::readVertexMaps(beside);
  if (maps.size() != 1 || maps.front().values.size() != count) return {};
  return maps.front().values;
}

void forgetWhatWasNotMeasured(io::VertexMap& map, const fs::path& file,
                              const std::optional<Eigen::VectorXd>& valid) {
  const bool thickness = saysThickness(map.name) || saysThickness(file.filename().string());
  for (Eigen::Index v = 0; v < map.values.size(); ++v) {
    if (map.values[v] != 0) continue;
    if (thickness || (valid && (*valid)[v] == 0)) map.values[v] = kNaN;
  }
}

/// How many vertices a file must be about: those of the surface, or of the whole that it is of.
Eigen::Index countFor(const ShownSurface& surface, Eigen::Index found) {
  const bool whole = !surface.origin.empty() && found == surface.wholeCount;
  return whole ? surface.wholeCount : surface.mesh.vertexCount();
}

template <class Values>
void restrict(const ShownSurface& surface, Values& values) {
  if (surface.origin.empty() || values.size() != surface.wholeCount) return;
  values = values(surface.origin).eval();
}

}  // namespace

std::vector<io::VertexMap> readMapsOn(const ShownSurface& surface, const fs::path& file) {
  std::vector<io::VertexMap> maps = io::readVertexMaps(file);
  const Eigen::Index count = maps.front().values.size();
  if (countFor(surface, count) != count) {
    (void)io::readVertexMaps(file, surface.mesh.vertexCount());  // says what does not fit
  }
  const auto valid = validBeside(file, count);
  for (io::VertexMap& map : maps) {
    forgetWhatWasNotMeasured(map, file, valid);
    restrict(surface, map.values);
  }
  return maps;
}

io::LabelMap readLabelsOn(const ShownSurface& surface, const fs::path& file) {
  // A list of vertices does not say of how many: of a patch, it is about the whole.
  const bool list = file.extension() == ".label" && !surface.origin.empty();
  const Eigen::Index found =
      list ? surface.wholeCount
           : (file.extension() == ".label" ? surface.mesh.vertexCount()
                                           : io::readVertexLabels(file).keys.size());
  io::LabelMap labels = io::readVertexLabels(file, countFor(surface, found));
  restrict(surface, labels.keys);
  return labels;
}

}  // namespace explica::app
