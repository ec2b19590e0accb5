// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "../Table.h"
#include "Explica/Core/EigenViews.h"
#include "Explica/IO/VolumeFile.h"
#include "Explica/Report/Chart.h"
#include "Explica/Report/Drawing.h"
#include "ReportParts.h"

#include <array>
#include <cmath>

namespace explica::pipeline {
namespace {

/// The end of the run, with its reason.
std::vector<report::ChartMark> endOf(const StepFolder& step, const std::vector<double>& iteration) {
  const std::string reason = step.text("stop_reason");
  if (iteration.empty() || reason.empty()) return {};
  return {{iteration.back(), reason}};
}

void chartHistory(ResultFolder& results, const StepFolder& step) {
  const Table table = readTable(step.folder / "evolution.tsv");
  const std::vector<double>* iteration = table.column("iteration");
  if (iteration == nullptr) return;
  const auto chart = [&](const std::string& title, const std::string& unit,
                         const std::vector<std::string>& names, bool logarithmic) {
    std::vector<report::Series> series;
    for (const std::string& name : names) {
      if (const std::vector<double>* values = table.column(name))
        series.push_back({inWords(name), *iteration, *values});
    }
    if (series.empty()) return;
    results.content().charts.push_back(
        {"",
         report::curvesSvg(series,
                           {title, "iteration", unit, logarithmic, endOf(step, *iteration)}),
         titleOf(step.name)});
  };
  chart("Visibility", "mean over the region", {"visibility", "seen"}, false);
  chart("Distortion", "share", {"area_error_mean", "edge_strain_mean"}, true);
  for (const std::string& name : table.names) {
    if (!name.starts_with("energy")) continue;
    const std::vector<double>& values = *table.column(name);
    bool any = false;
    for (const double v : values) any = any || v != 0;
    // The start has no energies yet: its zeros would hide the curve.
    if (any) chart(inWords(name), "mm\u00b2", {name}, true);
  }
}

void chartMaps(ResultFolder& results, const StepFolder& step, const char* file, const char* id) {
  if (!step.has(file)) return;
  std::vector<bool> inRegion;
  if (step.has("region.label.gii")) {
    for (const Label key : io::readVertexLabels(step.folder / "region.label.gii").keys)
      inRegion.push_back(key != 0);
  }
  bool first = true;
  const auto inside = [&](const io::VertexMap& map) -> Eigen::VectorXd {
    std::vector<double> values;
    for (Eigen::Index v = 0; v < map.values.size(); ++v) {
      if (inRegion.empty() || (static_cast<std::size_t>(v) < inRegion.size() && inRegion[v]))
        values.push_back(map.values[v]);
    }
    return asVector(values);
  };
  const auto maps = io::readVertexMaps(step.folder / file);
  for (const io::VertexMap& map : maps) {
    if (map.name.find("before") != std::string::npos) continue;  // it lies behind what is after
    const std::string name = mapWords(map.name);
    report::ChartText words{inWords(name), "", "share of vertices"};
    // What was before lies behind what is after.
    const std::size_t after = map.name.find("after");
    for (const io::VertexMap& other : maps) {
      if (after == std::string::npos ||
          other.name != std::string(map.name).replace(after, 5, "before")) {
        continue;
      }
      words.behind = inside(other);
      words.behindName = "before";
    }
    const std::string axis =
        map.unit.empty() ? name : name + " [" + report::unitText(map.unit) + "]";
    words.xTitle = axis;
    results.content().charts.push_back(
        {first ? id : "", report::histogramSvg(inside(map), words), titleOf(step.name)});
    first = false;
  }
}

}  // namespace

std::string mapWords(const std::string& name) {
  for (const auto& [start, words] : {std::pair{"flux ", "facing the viewpoint (1 = directly), "},
                                     std::pair{"seen ", "share seen from the viewpoint, "}}) {
    if (name.starts_with(start)) return words + name.substr(5);
  }
  return name;
}

void chartThickness(ResultFolder& results, const StepFolder& step) {
  const Volume<float> thickness = io::readScalars(step.folder / "thickness.nii.gz",
                                                  {.allowNonFinite = true, .allowAllZero = true})
                                      .volume;
  std::vector<double> values;
  for (const float t : thickness.data) {
    if (t > 0 && std::isfinite(t)) values.push_back(t);
  }
  const std::string side = step.side().empty() ? "" : ", " + step.side();
  results.content().charts.push_back(
      {"",
       report::histogramSvg(asVector(values), {"Thickness in the tissue's voxels" + side,
                                               "thickness [mm]", "share of voxels"}),
       kThicknessCharts});
}

void chartUnfolding(ResultFolder& results, const StepFolder& step) {
  if (step.has("evolution.tsv")) {
    results.attempt("Curves", [&] { chartHistory(results, step); });
  }
  results.attempt("Visibility maps", [&] { chartMaps(results, step, "visibility.shape.gii", ""); });
  results.attempt("Distortion maps",
                  [&] { chartMaps(results, step, "distortion.shape.gii", kDistortionPlace); });
}

void chartBeat(ResultFolder& results, const StepFolder& step) {
  const Table table = readTable(step.folder / "frames.tsv");
  const std::vector<double>* frames = table.column("frame");
  if (frames == nullptr || frames->size() < 2) return;
  std::vector<report::ChartMark> marks;
  for (std::size_t f = 0; f < frames->size(); ++f) {
    const std::string& phase = (*table.text("phase"))[f];
    if (phase != "n/a") marks.push_back({(*frames)[f], phase});
  }
  for (const auto& [column, title, unit] :
       {std::array{"cavity_volume_ml", "Volume of the cavity", "ml"},
        {"thickness_mean", "Mean thickness of the wall", "mm"},
        {"mass_g", "Mass of the wall", "g"}}) {
    const std::vector<double>* values = table.column(column);
    if (values == nullptr) continue;
    results.content().charts.push_back(
        {"", report::curvesSvg({{title, *frames, *values}}, {title, "frame", unit, false, marks}),
         titleOf(step.name)});
  }
}

}  // namespace explica::pipeline
