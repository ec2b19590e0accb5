// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Settings.h"

#include "Explica/Application/ReadInputs.h"
#include "Explica/Core/Errors.h"
#include "Explica/Core/Folders.h"
#include "Explica/Core/Text.h"
#include "Explica/Core/WholeFile.h"
#include "Explica/IO/LabelNames.h"
#include "Explica/IO/VolumeSeries.h"
#include "Explica/Sampling/Summary.h"
#include "Explica/Sampling/TissueLayers.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>

namespace explica::app {
namespace {

namespace fs = std::filesystem;

struct Tissue {
  sampling::TissueVoxels voxels;
  sampling::LayerShares layers;
  std::vector<std::int32_t> regionOf;  ///< per tissue voxel; -1: none
  std::vector<std::string> regions;
  Positions centres;  ///< of the voxels, RAS mm
};

fs::path fileIn(Context& context, const fs::path& folder, const char* name) {
  if (!isThere(folder / name)) {
    throw InvalidInput("thickness: " + folder.string() + " holds no " + name +
                       "; give the output folder of explica thickness");
  }
  return context.input(folder / name, "thickness");
}

/// Regions of the tissue's voxels by a label volume; one region "all" without.
void setRegions(Context& context, const SampleSettings& s, Tissue& tissue) {
  tissue.regionOf.assign(tissue.voxels.voxels.size(), 0);
  tissue.regions = {"all"};
  if (s.labels.empty()) return;
  if (s.labels.size() > 1) throw UsageError("--labels with --thickness takes one label volume");
  const Volume<Label> labels = readLabels(context, "labels", s.labels.front(), s.reading);
  const std::vector<Label> keys =
      sampling::Sampler(labels.grid, tissue.centres, sampling::Interpolation::Nearest)
          .sampleLabels(labels.data);
  io::LabelNames names;
  if (const auto legend = io::findLegend(s.labels.front())) names = io::readLabelNames(*legend);
  std::map<Label, std::int32_t> number;
  tissue.regions.clear();
  for (const Label key : keys) {
    if (key != 0 && key != sampling::kNoLabel) number.emplace(key, 0);
  }
  if (number.empty()) {
    throw InvalidInput("labels: none lies on the tissue; do both belong to the same image?");
  }
  for (auto& [key, index] : number) {
    index = static_cast<std::int32_t>(tissue.regions.size());
    const auto entry = io::freeSurferEntry(key);
    tissue.regions.push_back(names.contains(key) ? names[key]
                             : entry             ? entry->name
                                                 : std::to_string(key));
  }
  for (std::size_t n = 0; n < keys.size(); ++n) {
    const auto found = number.find(keys[n]);
    tissue.regionOf[n] = found == number.end() ? -1 : found->second;
  }
}

Tissue readTissue(Context& context, const SampleSettings& s) {
  const fs::path folder = *s.thickness;
  io::VolumeReadOptions reading;
  reading.allowNonFinite = reading.allowAllZero = true;
  const auto scalars = [&](const char* name) {
    return io::readScalars(fileIn(context, folder, name), reading).volume;
  };
  const auto vectors = [&](const char* name) {
    return io::readVectors(fileIn(context, folder, name), reading).volume;
  };
  Tissue tissue;
  const Volume<float> thickness = scalars("thickness.nii.gz"), depth = scalars("depth.nii.gz");
  tissue.voxels = sampling::tissueOf(thickness, depth, vectors("inner_point.nii.gz"),
                                     vectors("outer_point.nii.gz"));
  if (s.depths) {
    const std::vector<double> depths = sampling::depthsFromText(*s.depths);
    if (s.depths->find_first_not_of("0123456789") != std::string::npos || depths.empty()) {
      throw UsageError("--depths with --thickness is a number of layers of equal thickness");
    }
    tissue.layers = sampling::layersByDepth(tissue.voxels, std::stoi(*s.depths));
  } else {
    tissue.layers = sampling::layersOfVolume(
        tissue.voxels, io::readLabels(fileIn(context, folder, "layers.nii.gz"), reading).volume);
  }
  const Grid& grid = tissue.voxels.grid;
  tissue.centres.resize(static_cast<Eigen::Index>(tissue.voxels.voxels.size()), 3);
  for (std::size_t n = 0; n < tissue.voxels.voxels.size(); ++n) {
    const auto [i, j, k] = grid.subscripts(tissue.voxels.voxels[n]);
    tissue.centres.row(static_cast<Eigen::Index>(n)) = grid.toWorld(Vector(i, j, k)).transpose();
  }
  setRegions(context, s, tissue);
  return tissue;
}

std::string rowsOf(const std::vector<sampling::LayerRow>& table, int layers,
                   const std::string& frame) {
  std::string text;
  for (const sampling::LayerRow& row : table) {
    text += row.region + "\t" + frame + std::to_string(row.layer) + "\t" +
            cellText((row.layer - 0.5) / layers) + "\t" + cellText(row.mean) + "\t" +
            cellText(row.deviation) + "\t" + std::to_string(row.count) + "\t" +
            cellText(row.volume) + "\t" + cellText(row.columnMean) + "\n";
  }
  return text;
}

void sampleVolume(Context& context, const SampleSettings& s, const Tissue& tissue,
                  const std::string& path, sampling::SampleSummary& summary) {
  io::VolumeSeries series(path, s.reading);
  const auto mask = maskFor(series.grid(), s);
  const sampling::Sampler sampler(series.grid(),
                                  placesIn(context, series.grid(), s, nullptr, tissue.centres),
                                  s.interpolate, mask ? &*mask : nullptr);
  const bool many = series.frames() > 1;
  std::string text = std::string("region\t") + (many ? "frame\t" : "") +
                     "layer\tdepth\tmean\tsd\tn\tvolume\tmean_columns\n";
  const std::size_t count = sampler.pointCount();
  std::size_t known = 0;
  int frame = 0;
  for (auto block = series.next(sampling::Sampler::kFramesAtOnce); !block.empty();
       block = series.next(sampling::Sampler::kFramesAtOnce)) {
    const std::vector<float> values = sampler.sample(block);
    for (std::size_t f = 0; f * count < values.size(); ++f, ++frame) {
      const std::span<const float> one = std::span(values).subspan(f * count, count);
      known += std::count_if(one.begin(), one.end(), [](float v) { return !std::isnan(v); });
      text += rowsOf(
          sampling::layerTable(tissue.voxels, tissue.layers, one, tissue.regionOf, tissue.regions),
          tissue.layers.layers, many ? std::to_string(frame) + "\t" : "");
    }
    context.monitor().progress(static_cast<double>(frame) / series.frames(), stemOf(path));
  }
  if (known == 0) {
    throw InvalidInput("'" + path +
                       "': is known nowhere on the tissue; do both lie in the same space?");
  }
  const std::string name = stemOf(path);
  summary.known.emplace_back(
      name, static_cast<double>(known) / static_cast<double>(count * series.frames()));
  writeTextFile(context.output(name + "_layers.tsv"), text);
}

}  // namespace

Termination sampleLayers(Context& context, const SampleSettings& s) {
  if (s.cortex.folder || s.cortex.white || s.points || !s.labelVolumes.empty()) {
    throw UsageError(
        "--thickness takes volumes and --labels; surfaces, --points and --label-volume are for "
        "sampling on surfaces");
  }
  if (s.across != sampling::Across::None || s.depthKind != sampling::DepthKind::Depth) {
    throw UsageError(
        "--thickness makes a table of layers; --across and --depth-kind are for surfaces (layers "
        "of equal volume come from explica thickness --layer-kind volume, without --depths here)");
  }
  requireUsable(context, s, nullptr);
  const Tissue tissue = readTissue(context, s);
  sampling::SampleSummary summary;
  summary.voxels = static_cast<std::int64_t>(tissue.voxels.voxels.size());
  summary.layers = tissue.layers.layers;
  auto step = context.step("sample");
  for (const std::string& volume : s.volumes) sampleVolume(context, s, tissue, volume, summary);
  context.results(summary);
  return Termination::NotRun;
}

}  // namespace explica::app
