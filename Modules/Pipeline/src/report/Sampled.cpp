// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "../Table.h"
#include "Explica/Core/EigenViews.h"
#include "Explica/Core/Errors.h"
#include "Explica/Core/Folders.h"
#include "Explica/IO/RegionFiles.h"
#include "Explica/IO/SurfaceFile.h"
#include "Explica/IO/VertexDataFile.h"
#include "Explica/Report/Figure.h"
#include "ReportParts.h"
#include "StandardViews.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>

namespace explica::pipeline {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMostMaps = 8;     // drawn; each has several views
constexpr std::size_t kMostPoints = 60;  // rows of the table

/// The surface half way between white and pial, ready for pictures.
struct Middle {
  TriangleMesh mesh;
  report::SurfaceScene scene;
  std::string side;
};

std::optional<Middle> middleOf(const StepFolder& step) {
  const auto white = inputOf(step, "white"), pial = inputOf(step, "pial");
  if (!white || !pial || !isThere(*white) || !isThere(*pial)) return {};
  const io::LoadedSurface inner = io::readSurface(*white);
  TriangleMesh mesh = inner.mesh;
  const Positions outer = io::readSurface(*pial).mesh.positions;
  if (outer.rows() != mesh.positions.rows()) return {};
  mesh.positions = (0.5 * (mesh.positions + outer)).eval();
  const std::string side = inner.metadata.structure == "CortexRight"  ? "right"
                           : inner.metadata.structure == "CortexLeft" ? "left"
                                                                      : step.side();
  report::SurfaceScene scene(mesh);
  return Middle{std::move(mesh), std::move(scene), side};
}

/// The first `count` of the standard views, `title` before their names.
void addViews(const Middle& middle, const std::vector<report::Colour>& colours,
              report::Filling filling, std::size_t count, const std::string& title,
              report::ReportViews& views) {
  const report::SurfacePictureOptions size = viewSize();
  const auto standard = standardViews(middle.side);
  for (std::size_t n = 0; n < std::min(count, standard.size()); ++n) {
    const report::Camera camera =
        report::cameraFor(middle.mesh, standard[n].second, size.width, size.height);
    views.views.push_back({(title.empty() ? "" : title + ", ") + standard[n].first,
                           middle.scene.render(camera, colours, filling, size)});
  }
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

void showMaps(ResultFolder& results, const Middle& middle, const fs::path& file,
              const std::string& volume) {
  const auto maps = fewOf(io::readVertexMaps(file, middle.mesh.vertexCount()));
  std::vector<double> pooled;
  for (const io::VertexMap& map : maps) {
    pooled.insert(pooled.end(), map.values.begin(), map.values.end());
  }
  report::ReportViews views;
  views.id = kSampledPlace;
  views.title = volume + " on the middle surface";
  views.caption = "Half way between white and pial. Dark grey: not known.";
  views.scale = report::scaleFor(asVector(pooled), volume, maps.front().unit);
  for (const io::VertexMap& map : maps) {
    addViews(middle, report::coloursOf(map.values, *views.scale), report::Filling::Smooth,
             maps.size() == 1 ? 4 : 2, map.name, views);
  }
  results.content().views.push_back(std::move(views));
}

void showLabels(ResultFolder& results, const Middle& middle, const fs::path& file) {
  const auto labels = io::readRegions({file}, middle.mesh.vertexCount()).front();
  std::map<Label, report::Colour> colourOf;
  report::ReportViews views;
  for (const io::LabelEntry& entry : labels.table) {
    colourOf[entry.key] = report::colourOfLabel(entry.key, entry.colour);
    views.legend.push_back({entry.name, colourOf[entry.key]});
  }
  std::vector<report::Colour> colours;
  for (const Label key : labels.keys) {
    const auto found = colourOf.find(key);
    colours.push_back(found == colourOf.end() ? report::colourOfLabel(0) : found->second);
  }
  views.title = labels.name + " on the middle surface";
  views.caption = "Each vertex in the colour of its label; light grey: none.";
  addViews(middle, colours, report::Filling::Discrete, 4, "", views);
  results.content().views.push_back(std::move(views));
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

void tabulatePoints(ResultFolder& results, const StepFolder& step) {
  const Table read = readTable(step.folder / "points.tsv");
  report::ReportTable table{
      "",
      "Points",
      "Nearest vertex, depth (0 white, 1 pial) and distance in mm from the column.",
      read.names,
      {}};
  for (std::size_t row = 0; row < std::min(read.rows(), kMostPoints); ++row) {
    std::vector<std::string>& cells = table.rows.emplace_back();
    for (const auto& column : read.texts) cells.push_back(column[row]);
  }
  if (read.rows() > kMostPoints) {
    table.caption += " The first " + std::to_string(kMostPoints) + " of " +
                     std::to_string(read.rows()) + "; points.tsv has all.";
  }
  results.content().tables.push_back(std::move(table));
}

}  // namespace

void showSampled(ResultFolder& results, const StepFolder& step) {
  if (step.has("points.tsv")) {
    results.attempt("Points", [&] { tabulatePoints(results, step); });
  }
  const auto middle = middleOf(step);
  if (!middle) return;
  auto files = mapFiles(step);
  if (files.size() > kMostMaps) files.resize(kMostMaps);
  for (const auto& [file, name] : files) {
    results.attempt("Pictures of " + name, [&, &file = file, &name = name] {
      if (fs::file_size(file) > io::kMostShown) {
        throw InvalidInput("the series is too long to be drawn; its profiles are shown");
      }
      showMaps(results, *middle, file, name);
    });
  }
  for (const fs::path& file : filesOf(step, ".label.gii")) {
    results.attempt("Picture of " + file.filename().string(),
                    [&] { showLabels(results, *middle, file); });
  }
}

}  // namespace explica::pipeline
