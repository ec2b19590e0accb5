// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Pipeline/DepthProfiles.h"

#include "Explica/Core/Folders.h"
#include "Explica/Core/Types.h"
#include "Table.h"

#include <algorithm>
#include <cmath>

namespace explica::pipeline {
namespace {

namespace fs = std::filesystem;

constexpr const char* kProfiles = "profiles.tsv";    // on vertices, as `explica sample` names it
constexpr std::string_view kLayers = "_layers.tsv";  // after the name of the volume, in voxels
constexpr const char* kAll = "all";                  // the row of all regions together

/// Mean of the known values, each to the power of 1 or 2.
double averageOf(const std::vector<double>& values, int power) {
  double sum = 0;
  std::size_t count = 0;
  for (const double value : values) {
    if (!std::isfinite(value)) continue;
    sum += power == 2 ? value * value : value;
    ++count;
  }
  return count == 0 ? kNaN : sum / static_cast<double>(count);
}

/// Rows of a table that belong to one volume, by region in the table's order.
std::vector<DepthProfile> profilesOf(const Table& table, const std::string& volume) {
  const auto *volumes = table.text("volume"), *regions = table.text("region");
  const auto *depth = table.column("depth"), *mean = table.column("mean"),
             *deviation = table.column("sd"), *count = table.column("n");
  std::vector<DepthProfile> profiles;
  if (!regions || !depth || !mean || !deviation || !count) return profiles;
  std::map<std::string, std::size_t> number;
  for (std::size_t row = 0; row < table.rows(); ++row) {
    if (volumes && (*volumes)[row] != volume) continue;
    const auto [found, isNew] = number.emplace((*regions)[row], profiles.size());
    if (isNew) profiles.push_back({(*regions)[row], {}, 0});
    DepthProfile& profile = profiles[found->second];
    AtDepth& at = profile.depths[(*depth)[row]];
    at.mean.push_back((*mean)[row]);
    at.deviation.push_back((*deviation)[row]);
    profile.count = std::max(profile.count, (*count)[row]);
  }
  return profiles;
}

/// Names in a column, each once.
std::vector<std::string> namesIn(const Table& table, std::string_view column) {
  std::vector<std::string> names;
  const auto* texts = table.text(column);
  if (!texts) return names;
  for (const std::string& name : *texts) {
    if (std::ranges::find(names, name) == names.end()) names.push_back(name);
  }
  return names;
}

}  // namespace

double AtDepth::average() const {
  return averageOf(mean, 1);
}

double AtDepth::spread() const {
  return std::sqrt(averageOf(deviation, 2));
}

const DepthProfile* VolumeProfiles::all() const {
  const auto found =
      std::ranges::find_if(regions, [](const DepthProfile& p) { return p.region == kAll; });
  return found == regions.end() ? nullptr : &*found;
}

std::vector<const DepthProfile*> VolumeProfiles::largest(std::size_t most) const {
  std::vector<const DepthProfile*> chosen;
  for (const DepthProfile& profile : regions) {
    if (profile.region != kAll && profile.count > 0) chosen.push_back(&profile);
  }
  std::ranges::stable_sort(
      chosen, [](const DepthProfile* a, const DepthProfile* b) { return a->count > b->count; });
  if (chosen.size() > most) chosen.resize(most);
  return chosen;
}

std::vector<VolumeProfiles> readDepthProfiles(const fs::path& folder) {
  std::vector<VolumeProfiles> found;
  if (isThere(folder / kProfiles)) {
    const Table table = readTable(folder / kProfiles);
    for (const std::string& volume : namesIn(table, "volume")) {
      found.push_back({volume, "vertices", kProfiles, profilesOf(table, volume)});
    }
  }
  for (const fs::path& file :
       entriesOf(folder, [](const std::string& name) { return name.ends_with(kLayers); })) {
    std::string volume = file.filename().string();
    volume.resize(volume.size() - kLayers.size());
    found.push_back(
        {volume, "voxels", file.filename().string(), profilesOf(readTable(file), volume)});
  }
  return found;
}

}  // namespace explica::pipeline
