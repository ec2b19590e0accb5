// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "OpenedFiles.h"

#include "Explica/Core/Errors.h"
#include "Explica/Core/Folders.h"
#include "Explica/IO/VertexDataFile.h"
#include "Explica/IO/VertexFile.h"
#include "OpenedFolders.h"

#include <algorithm>
#include <array>

namespace explica::app {
namespace {

namespace fs = std::filesystem;

viewer::Rgb bytesOf(const report::Colour& colour) {
  viewer::Rgb rgb;
  for (int c = 0; c < 3; ++c) rgb[c] = report::encodeSrgb(colour[c]);
  return rgb;
}

}  // namespace

bool isVolume(const fs::path& path) {
  const std::string name = path.filename().string();
  constexpr std::array kEndings = {".nii",  ".nii.gz", ".mgh", ".mgz", ".nrrd",
                                   ".nhdr", ".mha",    ".mhd", ".hdr", ".img"};
  return std::any_of(kEndings.begin(), kEndings.end(),
                     [&](const char* ending) { return name.ends_with(ending); });
}

std::string counted(std::size_t count, const char* what) {
  return std::to_string(count) + " " + what + (count == 1 ? "" : "s");
}

viewer::WindowLabels windowLabels(const ShownSurface& surface, const fs::path& path) {
  const io::LabelMap read = readLabelsOn(surface, path);
  viewer::WindowLabels labels;
  labels.name = path.filename().string();
  labels.file = path.string();
  labels.keys.assign(read.keys.begin(), read.keys.end());
  for (const io::LabelEntry& entry : read.table) {
    labels.names.emplace_back(entry.key, entry.name);
    labels.colours.emplace_back(entry.key, bytesOf(report::colourOfLabel(entry.key, entry.colour)));
  }
  return labels;
}

viewer::Opened openForWindow(const fs::path& path, const ShownSurface& surface) {
  if (isFolder(path)) return openFolder(path, surface);
  viewer::Opened opened;
  const std::string name = path.filename().string();
  if (isVolume(path)) {
    throw InvalidInput("'" + path.string() +
                       "' is a volume: --screenshot draws its slices with surfaces, explica sample "
                       "puts its values on a surface");
  }
  if (io::namesLabels(path)) {
    opened.labels.push_back(windowLabels(surface, path));
    opened.what = name + ": " + counted(opened.labels[0].names.size(), "label");
  } else {
    for (io::VertexMap& map : readMapsOn(surface, path)) {
      const bool first = opened.maps.empty();
      // Some programs name a map by the path of the file that it came from.
      opened.maps.push_back({fs::path(map.name).filename().string(), map.unit,
                             std::move(map.values), first ? path.string() : ""});
    }
    opened.what = name + ": " + counted(opened.maps.size(), "map");
  }
  return opened;
}

viewer::Scale scaleOf(const Eigen::VectorXd& values) {
  constexpr int kColours = 256;
  const report::ColourScale chosen = report::scaleFor(values, "", "");
  viewer::Scale scale;
  scale.low = chosen.low;
  scale.high = chosen.high;
  for (int n = 0; n < kColours; ++n) {
    scale.colours.push_back(
        bytesOf(report::colourAt(chosen.map, static_cast<double>(n) / (kColours - 1))));
  }
  scale.unknown = bytesOf(report::colourAt(chosen.map, kNaN));
  return scale;
}

}  // namespace explica::app
