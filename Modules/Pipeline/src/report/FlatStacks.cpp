// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
// Volumes on the grid of a flat map, depth by depth.
#include "Explica/Core/EigenViews.h"
#include "Explica/IO/VolumeSeries.h"
#include "ReportParts.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <vector>

namespace explica::pipeline {
namespace {

constexpr std::array<std::uint8_t, 3> kOffTheMap = {206, 220, 236};  // no colour of the maps

/// A volume of the grid: mean over its frames where it has several.
struct Values {
  Volume<float> mean;
  int frames = 1;
};

Values readValues(const std::filesystem::path& file) {
  io::VolumeSeries series(file);
  Values values{Volume<float>(series.grid()), series.frames()};
  std::vector<double> sum(values.mean.size(), 0);
  for (int f = 0; f < values.frames; ++f) {
    const std::vector<float> frame = series.next(1);
    for (std::size_t v = 0; v < sum.size(); ++v) sum[v] += frame[v];
  }
  for (std::size_t v = 0; v < sum.size(); ++v) {
    values.mean[v] = static_cast<float>(sum[v] / values.frames);
  }
  return values;
}

report::Picture depthPicture(const Volume<float>& stack, int k, int zoom,
                             const std::function<report::Colour(float)>& colourOf) {
  const int width = stack.grid.size[0], height = stack.grid.size[1];
  report::Picture picture(width * zoom, height * zoom, kOffTheMap);
  for (int y = 0; y < picture.height; ++y) {
    for (int x = 0; x < picture.width; ++x) {
      const float value = stack[stack.grid.linear(x / zoom, height - 1 - y / zoom, k)];
      if (!std::isfinite(value)) continue;
      const report::Colour colour = colourOf(value);
      for (int c = 0; c < 3; ++c) picture.pixel(x, y)[c] = report::encodeSrgb(colour[c]);
    }
  }
  return picture;
}

report::ColourScale greyScaleOf(const Volume<float>& stack, const std::string& name) {
  std::vector<double> known;
  std::ranges::copy_if(stack.data, std::back_inserter(known),
                       [](float v) { return std::isfinite(v); });
  return report::scaleFor(asVector(known), name, "", report::ColourMap::Grey);
}

/// Depths on one scale; labels (`--nearest`) in colours of their own.
/// @param name  of the volume
void showStack(ResultFolder& results, const std::filesystem::path& file, const std::string& name,
               bool holdsLabels) {
  const Values values = readValues(file);
  const Grid& grid = values.mean.grid;
  report::ReportViews views;
  views.title = name + ", layer by layer";
  views.caption =
      "The grid's depths from white to pial, cells of " + readable(grid.spacing[0]) + " mm" +
      (values.frames > 1 ? "; mean of " + std::to_string(values.frames) + " frames" : "") +
      ". Pale blue: off the map, or not known.";
  if (!holdsLabels) views.scale = greyScaleOf(values.mean, name);
  const auto colourOf = [&](float value) {
    return views.scale ? (*views.scale)(value)
                       : report::colourOfLabel(static_cast<Label>(std::lround(value)));
  };
  const int zoom =
      std::max(1, (300 + grid.size[0] / 2) / std::max(1, grid.size[0]));  // pixels a tile
  const int depths = grid.size[2], shown = std::min(depths, 12);
  for (int n = 0; n < shown; ++n) {
    const int k = shown < 2 ? 0 : n * (depths - 1) / (shown - 1);
    const double depth = depths < 2 ? 0.5 : static_cast<double>(k) / (depths - 1);
    views.views.push_back(
        {"depth " + readable(depth), depthPicture(values.mean, k, zoom, colourOf)});
  }
  results.content().views.push_back(std::move(views));
}

}  // namespace

void showFlatStacks(ResultFolder& results, const StepFolder& step) {
  constexpr std::string_view kPrefix = "flat_", kEnding = ".nii.gz";  // as flatten names them
  const bool holdsLabels = step.record.value("options", Json::object()).value("nearest", false);
  for (const std::filesystem::path& file : filesOf(step, kEnding)) {
    std::string name = file.filename().string();
    if (!name.starts_with(kPrefix)) continue;
    name = name.substr(kPrefix.size(), name.size() - kPrefix.size() - kEnding.size());
    results.attempt(file.filename().string(), [&] { showStack(results, file, name, holdsLabels); });
  }
}

}  // namespace explica::pipeline
