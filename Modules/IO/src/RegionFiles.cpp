// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/IO/RegionFiles.h"

#include "Explica/Core/Errors.h"
#include "Explica/Core/Text.h"

#include <algorithm>
#include <array>
#include <map>
#include <set>

namespace explica::io {
namespace {

/// "lh.aparc" of "lh.aparc.annot", "V1" of "V1.label.gii".
std::string stemOf(const std::filesystem::path& file) {
  std::string name = file.filename().string();
  for (const std::string_view ending : {".gz", ".gii", ".label", ".annot"}) {
    if (name.size() > ending.size() && name.ends_with(ending)) {
      name.resize(name.size() - ending.size());
    }
  }
  return name;
}

LabelMap regionsOf(const std::filesystem::path& file, Eigen::Index vertexCount) {
  LabelMap labels = readVertexLabels(file, vertexCount);
  labels.name = stemOf(file);
  std::map<Label, LabelEntry> entries;
  for (LabelEntry& entry : labels.table) entries[entry.key] = std::move(entry);
  const auto isRegion = [&](Label key) {
    const auto found = entries.find(key);
    if (found == entries.end() || found->second.name.empty()) return key != 0;
    return !meansNoRegion(found->second.name);
  };
  std::set<Label> used;
  for (Label& key : labels.keys) {
    if (used.contains(key)) continue;
    if (isRegion(key)) {
      used.insert(key);
    } else {
      key = kNoRegion;
    }
  }
  if (used.empty()) throw InvalidInput("'" + file.string() + "': holds no region");
  labels.table.clear();
  for (const Label key : used) {
    LabelEntry entry = entries.contains(key) ? entries[key] : LabelEntry{};
    entry.key = key;
    if (entry.name.empty()) entry.name = std::to_string(key);
    labels.table.push_back(std::move(entry));
  }
  return labels;
}

/// Puts the file's name before those that occur more than once.
void tellApart(std::vector<LabelMap>& all) {
  std::map<std::string, int> times;
  for (const LabelMap& labels : all) {
    for (const LabelEntry& entry : labels.table) ++times[entry.name];
  }
  std::set<std::string> taken;
  std::map<std::string, int> next;  // number of a name that was taken
  for (LabelMap& labels : all) {
    for (LabelEntry& entry : labels.table) {
      if (times[entry.name] > 1) entry.name = labels.name + " " + entry.name;
      // Two keys of one name in one file, or two files of one name.
      const std::string name = entry.name;
      for (int& n = next.try_emplace(name, 2).first->second; !taken.insert(entry.name).second;
           ++n) {
        entry.name = name + " " + std::to_string(n);
      }
    }
  }
}

}  // namespace

bool meansNoRegion(std::string_view name) {
  constexpr std::array<std::string_view, 10> kWords = {
      "unknown",    "Unknown",     "???",         "outside",    "none",
      "medialwall", "Medial_wall", "Medial_Wall", "MedialWall", "medial wall"};
  return name.empty() || std::ranges::find(kWords, name) != kWords.end();
}

std::vector<LabelMap> readRegions(const std::vector<std::filesystem::path>& files,
                                  Eigen::Index vertexCount) {
  std::vector<LabelMap> all;
  for (const std::filesystem::path& file : files) all.push_back(regionsOf(file, vertexCount));
  tellApart(all);
  return all;
}

void numberAlike(std::vector<LabelMap>& files) {
  std::map<std::string, Label> keyOf;
  std::vector<LabelEntry>& table = files.front().table;
  for (const LabelEntry& entry : table) keyOf.try_emplace(entry.name, entry.key);
  for (std::size_t f = 1; f < files.size(); ++f) {
    std::map<Label, Label> changed;
    for (LabelEntry entry : files[f].table) {
      const Label next = table.back().key + 1;
      const auto [at, added] = keyOf.try_emplace(entry.name, next);
      changed[entry.key] = at->second;
      if (!added) continue;
      entry.key = next;
      table.push_back(entry);
    }
    for (Label& key : files[f].keys) {
      if (const auto at = changed.find(key); at != changed.end()) key = at->second;
    }
  }
}

std::vector<bool> markedByNames(const std::filesystem::path& file,
                                const std::vector<std::string>& names, Eigen::Index vertexCount) {
  const LabelMap regions = readRegions({file}, vertexCount).front();
  std::vector<bool> marked(static_cast<std::size_t>(vertexCount));
  for (const std::string& name : names) {
    const auto named = std::ranges::find_if(
        regions.table, [&](const LabelEntry& entry) { return entry.name == name; });
    if (named == regions.table.end()) {
      throw InvalidInput(
          "'" + file.string() + "': has no region '" + name + "'; its regions are " +
          joined(regions.table, ", ", [](const LabelEntry& entry) { return entry.name; }));
    }
    for (Eigen::Index v = 0; v < vertexCount; ++v) {
      if (regions.keys[v] == named->key) marked[v] = true;
    }
  }
  return marked;
}

std::vector<bool> markedByLabels(const std::vector<std::filesystem::path>& files,
                                 const std::vector<int>& keys, Eigen::Index vertexCount) {
  std::vector<bool> marked(static_cast<std::size_t>(vertexCount));
  Label lowest = std::numeric_limits<Label>::max(), highest = std::numeric_limits<Label>::lowest();
  for (const std::filesystem::path& file : files) {
    const LabelMap labels = readVertexLabels(file, vertexCount);
    lowest = std::min(lowest, labels.keys.minCoeff());
    highest = std::max(highest, labels.keys.maxCoeff());
    for (Eigen::Index v = 0; v < vertexCount; ++v) {
      const Label key = labels.keys[v];
      const bool wanted = keys.empty() ? key != 0 : std::ranges::find(keys, key) != keys.end();
      if (wanted) marked[v] = true;
    }
  }
  if (std::ranges::find(marked, true) != marked.end()) return marked;
  const std::string wanted = joined(keys, " or ", [](int key) { return std::to_string(key); });
  throw InvalidInput(wanted.empty()
                         ? "label: it is 0 everywhere, so the region is empty"
                         : "label: no vertex has key " + wanted + ", keys go from " +
                               std::to_string(lowest) + " to " + std::to_string(highest));
}

}  // namespace explica::io
