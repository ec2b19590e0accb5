// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Pipeline/FlatStack.h"

#include "Explica/Core/EigenViews.h"
#include "Explica/Core/Folders.h"
#include "Explica/IO/VolumeSeries.h"
#include "Explica/Provenance/Json.h"
#include "Explica/Provenance/Record.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>

namespace explica::pipeline {
namespace {

namespace fs = std::filesystem;

constexpr std::array<std::uint8_t, 3> kOffTheMap = {206, 220, 236};  // no colour of the maps
constexpr int kTileWidth = 300;                                      // pixels, about
constexpr int kMostTiles = 12;  // if there are more depths, so many evenly among them
// As `explica flatten` names them.
constexpr std::string_view kPrefix = "flat_", kEnding = ".nii.gz";

/// A volume of the grid: mean over its frames where it has several.
struct Values {
  Volume<float> mean;
  int frames = 1;
};

Values readValues(const fs::path& file) {
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

/// Whether the command was told that its volumes are of labels.
bool holdsLabels(const fs::path& folder) {
  const fs::path record = folder / provenance::kRecordName;
  if (!isThere(record)) return false;
  return provenance::readRecord(record)
      .value("options", provenance::Json::object())
      .value("nearest", false);
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

}  // namespace

std::vector<fs::path> flatStackFiles(const fs::path& folder) {
  return entriesOf(folder, [](const std::string& name) {
    return name.starts_with(kPrefix) && name.ends_with(kEnding);
  });
}

FlatStack drawFlatStack(const fs::path& file) {
  const Values values = readValues(file);
  const Grid& grid = values.mean.grid;
  FlatStack stack;
  stack.name = file.filename().string();
  if (stack.name.starts_with(kPrefix)) stack.name.erase(0, kPrefix.size());
  if (stack.name.ends_with(kEnding)) stack.name.resize(stack.name.size() - kEnding.size());
  stack.cell = grid.spacing[0];
  stack.frames = values.frames;
  if (!holdsLabels(file.parent_path())) stack.scale = greyScaleOf(values.mean, stack.name);
  const auto colourOf = [&](float value) {
    return stack.scale ? (*stack.scale)(value)
                       : report::colourOfLabel(static_cast<Label>(std::lround(value)));
  };
  stack.pixelsPerCell = std::max(1, (kTileWidth + grid.size[0] / 2) / std::max(1, grid.size[0]));
  const int depths = grid.size[2], shown = std::min(depths, kMostTiles);
  for (int n = 0; n < shown; ++n) {
    const int k = shown < 2 ? 0 : n * (depths - 1) / (shown - 1);
    stack.tiles.push_back({depths < 2 ? 0.5 : static_cast<double>(k) / (depths - 1),
                           depthPicture(values.mean, k, stack.pixelsPerCell, colourOf)});
  }
  return stack;
}

}  // namespace explica::pipeline
