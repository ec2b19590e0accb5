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

namespace fs = std::filesystem;

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
  viewer::WindowLabels labels{readLabelsOn(surface, path), path.string()};
  labels.name = path.filename().string();
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
    opened.what = name + ": " + counted(opened.labels[0].table.size(), "label");
  } else {
    for (io::VertexMap& map : readMapsOn(surface, path)) {
      // Some programs name a map by the path of the file that it came from.
      map.name = fs::path(map.name).filename().string();
      opened.maps.push_back({std::move(map), opened.maps.empty() ? path.string() : ""});
    }
    opened.what = name + ": " + counted(opened.maps.size(), "map");
  }
  return opened;
}

}  // namespace explica::app
