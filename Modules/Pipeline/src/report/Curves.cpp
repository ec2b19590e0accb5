// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Core/EigenViews.h"
#include "Explica/IO/VolumeFile.h"
#include "Explica/Pipeline/UnfoldingFolder.h"
#include "Explica/Report/Chart.h"
#include "Explica/Report/Drawing.h"
#include "ReportParts.h"

#include <array>
#include <cmath>

namespace explica::pipeline {
namespace {

void chartHistory(ResultFolder& results, const StepFolder& step) {
  const Table table = readTable(step.folder / "evolution.tsv");
  const std::vector<double> iteration = table.numbers("iteration");
  if (!table.has("iteration") || iteration.empty()) return;
  std::vector<report::ChartMark> end;
  if (const std::string reason = step.text("stop_reason"); !reason.empty()) {
    end = {{iteration.back(), reason}};
  }
  const auto chart = [&](const std::string& title, const std::string& unit,
                         const std::vector<std::string>& names, bool logarithmic) {
    std::vector<report::Series> series;
    for (const std::string& name : names) {
      if (table.has(name)) series.push_back({inWords(name), iteration, table.numbers(name)});
    }
    if (series.empty()) return;
    results.content().charts.push_back(
        {"", report::curvesSvg(series, {title, "iteration", unit, logarithmic, end}),
         titleOf(step.name)});
  };
  chart("Visibility", "mean over the region", {"visibility", "seen"}, false);
  chart("Distortion", "share", {"area_error_mean", "edge_strain_mean"}, true);
  for (const std::string& name : table.names) {
    // The start has no energies yet: its zeros would hide the curve.
    const bool isAny = std::ranges::any_of(table.numbers(name), [](double v) { return v != 0; });
    if (name.starts_with("energy") && isAny) chart(inWords(name), "mm\u00b2", {name}, true);
  }
}

}  // namespace

void chartMaps(ResultFolder& results, const StepFolder& step, const char* file, const char* id,
               const std::vector<std::int32_t>& region) {
  if (!step.has(file)) return;
  const auto maps = io::readVertexMaps(step.folder / file);
  bool first = true;
  const auto inside = [&](const io::VertexMap& map) -> Eigen::VectorXd {
    return region.empty() ? map.values : map.values(region).eval();
  };
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
  results.content().charts.push_back(
      {"",
       report::histogramSvg(asVector(values),
                            {"Thickness in the tissue's voxels" + step.sideWords(),
                             "thickness [mm]", "share of voxels"}),
       kThicknessCharts});
}

void chartUnfolding(ResultFolder& results, const StepFolder& step) {
  if (step.has("evolution.tsv")) {
    results.attempt("Curves", [&] { chartHistory(results, step); });
  }
  for (const auto& [file, id] : {std::pair{"visibility.shape.gii", ""},
                                 std::pair{"distortion.shape.gii", kDistortionPlace}}) {
    results.attempt(file, [&, file = file, id = id] {
      chartMaps(results, step, file, id, unfoldedRegion(step.folder));
    });
  }
}

void chartBeat(ResultFolder& results, const StepFolder& step) {
  const Table table = readTable(step.folder / "frames.tsv");
  const std::vector<double> frames = table.numbers("frame");
  if (!table.has("frame") || frames.size() < 2) return;
  std::vector<report::ChartMark> marks;
  for (std::size_t f = 0; f < frames.size(); ++f) {
    const std::string& phase = cellIn(table.rows[f], "phase");
    if (phase != "n/a") marks.push_back({frames[f], phase});
  }
  for (const auto& [column, title, unit] :
       {std::array{"cavity_volume_ml", "Volume of the cavity", "ml"},
        {"thickness_mean", "Mean thickness of the wall", "mm"},
        {"mass_g", "Mass of the wall", "g"}}) {
    if (!table.has(column)) continue;
    results.content().charts.push_back({"",
                                        report::curvesSvg({{title, frames, table.numbers(column)}},
                                                          {title, "frame", unit, false, marks}),
                                        titleOf(step.name)});
  }
}

}  // namespace explica::pipeline
