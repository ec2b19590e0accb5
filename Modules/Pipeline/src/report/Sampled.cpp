// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Core/EigenViews.h"
#include "Explica/Core/Errors.h"
#include "Explica/Core/Folders.h"
#include "Explica/IO/SurfaceFile.h"
#include "Explica/IO/VertexDataFile.h"
#include "Explica/Report/Evolution.h"
#include "ReportParts.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>

namespace explica::pipeline {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMostMaps = 8;  // files of maps

/// The surface half way between white and pial.
std::optional<report::Evolution> middleOf(const StepFolder& step) {
  const auto white = inputOf(step, "white"), pial = inputOf(step, "pial");
  if (!white || !pial || !isThere(*white) || !isThere(*pial)) return {};
  report::Evolution middle;
  middle.title = "middle surface" + step.sideWords();
  middle.mesh = io::readSurface(*white).mesh;
  const Positions outer = io::readSurface(*pial).mesh.positions;
  if (outer.rows() != middle.mesh.positions.rows()) return {};
  middle.mesh.positions = (0.5 * (middle.mesh.positions + outer)).eval();
  return middle;
}

/// Mean of a series' maps where it is known in all of them.
io::VertexMap meanOf(const std::vector<io::VertexMap>& maps) {
  io::VertexMap mean{"mean of " + std::to_string(maps.size()) + " frames", maps.front().unit,
                     Eigen::VectorXd::Zero(maps.front().values.size())};
  for (const io::VertexMap& map : maps) mean.values += map.values;
  mean.values /= static_cast<double>(maps.size());
  return mean;
}

/// Of the maps of depths the first, middle and last; of frames their mean; of others all.
std::vector<io::VertexMap> fewOf(std::vector<io::VertexMap> maps) {
  if (maps.size() > 1 && maps.front().name.starts_with("frame")) return {meanOf(maps)};
  if (maps.size() <= 3) return maps;
  std::vector<io::VertexMap> few;
  for (const std::size_t n : {std::size_t{0}, (maps.size() - 1) / 2, maps.size() - 1}) {
    few.push_back(std::move(maps[n]));
  }
  return few;
}

/// The maps of a file, all on one scale.
void addMaps(const fs::path& file, const std::string& volume, report::Evolution& middle) {
  if (fs::file_size(file) > io::kMostShown) {
    throw InvalidInput("the series is too long to be drawn; its profiles are shown");
  }
  const auto maps = fewOf(io::readVertexMaps(file, middle.mesh.vertexCount()));
  std::vector<double> pooled;
  for (const io::VertexMap& map : maps) {
    pooled.insert(pooled.end(), map.values.begin(), map.values.end());
  }
  report::ColourScale scale = report::scaleFor(asVector(pooled), volume, maps.front().unit);
  for (const io::VertexMap& map : maps) {
    scale.title = nameBesideOthers(file, map.name);
    middle.maps.push_back({map.values, scale});
  }
}

/// The maps of each volume: of a series those of one depth, half way through the cortex.
std::vector<std::pair<fs::path, std::string>> mapFiles(const StepFolder& step) {
  std::vector<std::pair<fs::path, std::string>> files;
  std::map<std::string, std::vector<std::pair<double, fs::path>>> series;
  constexpr std::string_view kEnding = ".func.gii", kDepth = "_depth-";
  for (const fs::path& file : filesOf(step, kEnding)) {
    std::string name = file.filename().string();
    name.resize(name.size() - kEnding.size());
    const std::size_t at = name.rfind(kDepth);
    const double depth =
        at == std::string::npos ? kNaN : std::strtod(name.c_str() + at + kDepth.size(), nullptr);
    if (std::isfinite(depth)) {
      series[name.substr(0, at)].emplace_back(depth, file);
    } else {
      files.emplace_back(file, name);
    }
  }
  for (auto& [name, depths] : series) {
    std::ranges::sort(depths);
    const auto& [depth, file] = depths[depths.size() / 2];
    files.emplace_back(file, name + ", depth " + readable(depth));
  }
  for (const fs::path& file : filesOf(step, ".shape.gii")) {
    if (file.filename() != "valid.shape.gii") {
      files.emplace_back(file, file.filename().string());
    }
  }
  return files;
}

}  // namespace

void showSampled(ResultFolder& results, const StepFolder& step) {
  if (step.has("points.tsv")) {
    results.attempt("Points", [&] {
      tabulate(results, readTable(step.folder / "points.tsv"), "Points",
               "Nearest vertex, depth (0 white, 1 pial) and distance in mm from the column.");
    });
  }
  auto middle = middleOf(step);
  if (!middle) return;
  auto files = mapFiles(step);
  if (files.size() > kMostMaps) files.resize(kMostMaps);
  for (const auto& [file, name] : files) {
    results.attempt("Maps of " + name,
                    [&, &file = file, &name = name] { addMaps(file, name, *middle); });
  }
  for (const fs::path& file : filesOf(step, ".label.gii")) {
    results.attempt(file.filename().string(),
                    [&] { addLabels(*middle, file.filename().string(), file); });
  }
  results.content().evolutions.push_back(std::move(*middle));
}

}  // namespace explica::pipeline
