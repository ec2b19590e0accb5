// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
// What a measurement of thickness shows of itself: layers in slices, and the thickness layer by
// layer.
#include "Explica/Core/EigenViews.h"
#include "Explica/IO/VolumeFile.h"
#include "Explica/Report/Chart.h"
#include "ReportParts.h"

#include <algorithm>
#include <map>

namespace explica::pipeline {
namespace {

constexpr int kShells = 5;  // of equal depth, where no layers were asked for

Volume<float> readMap(const StepFolder& step, const char* file) {
  return io::readScalars(step.folder / file, {.allowNonFinite = true, .allowAllZero = true}).volume;
}

/// Layers as they were written, or else shells of equal depth.
Volume<Label> layersOf(const StepFolder& step) {
  if (step.has("layers.nii.gz")) return io::readLabels(step.folder / "layers.nii.gz").volume;
  const Volume<float> depth = readMap(step, "depth.nii.gz");
  Volume<Label> shells(depth.grid, 0);
  for (std::size_t v = 0; v < depth.size(); ++v) {
    if (!(depth[v] > 0)) continue;
    shells[v] = std::clamp(1 + static_cast<int>(kShells * depth[v]), 1, kShells);
  }
  return shells;
}

/// A histogram of the thickness in each layer.
void chartLayers(ResultFolder& results, const StepFolder& step, const Volume<Label>& layers) {
  const Volume<float> thickness = readMap(step, "thickness.nii.gz");
  if (thickness.size() != layers.size()) return;
  std::map<Label, std::vector<double>> values;
  for (std::size_t v = 0; v < layers.size(); ++v) {
    if (layers[v] > 0 && thickness[v] > 0) values[layers[v]].push_back(thickness[v]);
  }
  if (values.size() > 6) return;
  std::vector<double> all;
  for (const auto& [layer, in] : values) all.insert(all.end(), in.begin(), in.end());
  for (const auto& [layer, in] : values) {
    report::ChartText words{"Layer " + std::to_string(layer) + ": " +
                                readable(static_cast<double>(in.size())) + " voxels",
                            "thickness [mm]", "share of voxels"};
    if (values.size() > 1) {
      words.behind = asVector(all);
      words.behindName = "all layers";
    }
    results.content().charts.push_back(
        {"", report::histogramSvg(asVector(in), words), kThicknessCharts});
  }
}

}  // namespace

void showLayers(ResultFolder& results, const StepFolder& step, const FolderReportOptions& options) {
  const bool written = step.has("layers.nii.gz");
  if (!written && !step.has("depth.nii.gz")) return;
  const Volume<Label> layers = layersOf(step);
  report::MosaicOptions mosaic{.perRow = options.slices, .convention = options.convention};
  results.content().mosaics.push_back({kLayerPlace,
                                       (written ? "Layers" : "Depth") + step.sideWords(),
                                       written ? "Each layer in its colour, the innermost orange."
                                               : "Five shells of equal depth from the inner to the "
                                                 "outer boundary, the innermost orange.",
                                       report::makeMosaic(layers, mosaic)});
  if (written) chartLayers(results, step, layers);
}

}  // namespace explica::pipeline
