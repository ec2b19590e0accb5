// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Pipeline/UnfoldingFolder.h"

#include "Explica/Core/Folders.h"
#include "Explica/IO/VertexDataFile.h"

#include <nlohmann/json.hpp>

namespace explica::pipeline {

namespace fs = std::filesystem;

std::vector<fs::path> frameFiles(const fs::path& folder) {
  return entriesOf(folder / "frames", [](const std::string& name) {
    return name.starts_with("frame-") && name.find(".surf.gii") != std::string::npos;
  });
}

std::vector<std::int32_t> unfoldedRegion(const fs::path& folder,
                                         std::optional<std::int64_t> vertexCount) {
  std::vector<std::int32_t> region;
  const fs::path file = folder / "region.label.gii";
  if (!isThere(file)) return region;
  const io::LabelMap labels = io::readVertexLabels(file, vertexCount);
  for (Eigen::Index v = 0; v < labels.keys.size(); ++v) {
    if (labels.keys[v] != 0) region.push_back(static_cast<std::int32_t>(v));
  }
  return region;
}

double frameVisibility(const nlohmann::ordered_json& summary, std::size_t frame) {
  const auto found = summary.find("frame_visibilities");
  if (found == summary.end() || !found->is_array() || frame >= found->size()) return kNaN;
  const auto& value = (*found)[frame];
  return value.is_number() ? value.get<double>() : kNaN;
}

std::optional<Point> pointIn(const nlohmann::ordered_json& json, const std::string& key) {
  const auto found = json.find(key);
  if (found == json.end() || !found->is_array() || found->empty()) return {};
  const auto& first = found->front().is_array() ? found->front() : *found;
  if (first.size() % 3 != 0) return {};
  for (const auto& x : first) {
    if (!x.is_number()) return {};
  }
  return Point(first[0], first[1], first[2]);
}

}  // namespace explica::pipeline
