// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Settings.h"

#include "Explica/Application/Command.h"
#include "Explica/Core/Errors.h"
#include "Explica/IO/RegionFiles.h"
#include "Explica/IO/VolumeSeries.h"

#include <cmath>
#include <set>

namespace explica::app {
namespace {

void requireDistinctNames(const SampleSettings& s) {
  std::set<std::string> names;
  for (const auto* list : {&s.volumes, &s.labelVolumes}) {
    for (const std::string& path : *list) {
      if (!names.insert(stemOf(path)).second) {
        throw UsageError(
            "two volumes are called '" + stemOf(path) +
            "', and outputs follow their names; sample them into folders of their own");
      }
    }
  }
}

Termination run(Context& context, const SampleSettings& s) {
  requireDistinctNames(s);
  if (s.volumes.empty() && s.labelVolumes.empty() && !s.points) {
    throw UsageError("there is nothing to sample: give volumes, --label-volume or --points");
  }
  if (s.across == sampling::Across::Ribbon && (s.depths || !s.labelVolumes.empty())) {
    throw UsageError(
        "--across ribbon takes values over the whole depth: leave --depths out, and sample label "
        "volumes with --across mean");
  }
  if (s.thickness) return sampleLayers(context, s);
  return sampleSurfaces(context, s);
}

}  // namespace

Positions placesIn(Context& context, const Grid& volume, const SampleSettings& s,
                   const Cortex* cortex, const Positions& points) {
  const auto transform = transformTo(context, volume, s.place, cortex);
  return transform ? (*transform)(points) : points;
}

std::optional<Volume<std::uint8_t>> maskFor(const Grid& volume, const SampleSettings& s) {
  if (!s.mask) return {};
  const Volume<float> read = io::readScalars(*s.mask, {.allowNonFinite = true}).volume;
  if (!sameGrid(read.grid, volume, 0.1)) {
    throw InvalidInput(
        "'" + *s.mask +
        "': its grid is not that of the volume it is to mask; resample it to that grid");
  }
  Volume<std::uint8_t> mask(read.grid);
  for (std::size_t v = 0; v < mask.size(); ++v) {
    mask[v] = read[v] != 0 && std::isfinite(read[v]);
  }
  return mask;
}

void requireUsable(Context& context, const SampleSettings& s, const Cortex* cortex) {
  for (const auto* list : {&s.volumes, &s.labelVolumes}) {
    for (const std::string& path : *list) {
      const io::VolumeSeries series(path, s.reading);
      static_cast<void>(maskFor(series.grid(), s));
      static_cast<void>(transformTo(context, series.grid(), s.place, cortex));
    }
  }
}

sampling::Regions regionsOf(const SampleSettings& s, Eigen::Index vertexCount) {
  if (s.labels.empty()) return sampling::Regions(vertexCount);
  const auto files = io::readRegions({s.labels.begin(), s.labels.end()}, vertexCount);
  std::vector<sampling::RegionTable> tables;
  for (const io::LabelMap& labels : files) {
    sampling::RegionTable& table = tables.emplace_back();
    table.keys = {labels.keys.data(), static_cast<std::size_t>(labels.keys.size())};
    for (const io::LabelEntry& entry : labels.table) table.table.push_back({entry.key, entry.name});
  }
  return sampling::Regions(tables);
}

Command sampleCommand() {
  return makeCommand<SampleSettings>("sample", declareSample, run);
}

}  // namespace explica::app
