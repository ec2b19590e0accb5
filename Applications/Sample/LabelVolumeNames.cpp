// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "LabelVolumeNames.h"

#include "Explica/Sampling/Sampler.h"

#include <algorithm>
#include <vector>

namespace explica::app {

LabelVolumeNames::LabelVolumeNames(const std::string& path)
    : freeSurfer_(path.find(".mgz") != std::string::npos ||
                  path.find("aseg") != std::string::npos ||
                  path.find("aparc") != std::string::npos) {
  if (const auto legend = io::findLegend(path)) names_ = io::readLabelNames(*legend);
  if (const auto file = io::findColours(path)) colours_ = io::readLabelColours(*file);
}

io::LabelMap LabelVolumeNames::mapOf(const std::string& name, std::span<const Label> keys) const {
  constexpr Label kNotKnownKey = -1;
  io::LabelMap map{name, {}, {}};
  map.keys.resize(static_cast<Eigen::Index>(keys.size()));
  for (std::size_t v = 0; v < keys.size(); ++v) {
    map.keys[v] = keys[v] == sampling::kNoLabel ? kNotKnownKey : keys[v];
  }
  std::vector<Label> used(map.keys.begin(), map.keys.end());
  std::sort(used.begin(), used.end());
  used.erase(std::unique(used.begin(), used.end()), used.end());
  map.table = io::tableFor(used, names_, freeSurfer_);
  for (io::LabelEntry& entry : map.table) {
    if (const auto own = colours_.find(entry.key); own != colours_.end()) {
      entry.colour = own->second;
    }
    if (entry.key == kNotKnownKey) entry = {kNotKnownKey, "not known", {0, 0, 0, 0}};
  }
  return map;
}

}  // namespace explica::app
