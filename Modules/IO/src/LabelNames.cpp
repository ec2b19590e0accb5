// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/IO/LabelNames.h"

#include "ByteSource.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <set>
#include <sstream>
#include <vector>

namespace explica::io {
namespace {

namespace fs = std::filesystem;

/// Words of a line: split at tabs if it has any, so that names may hold spaces; else at spaces.
std::vector<std::string> wordsOf(const std::string& line) {
  std::vector<std::string> words;
  std::istringstream stream(line);
  std::string word;
  if (line.find('\t') != std::string::npos) {
    while (std::getline(stream, word, '\t')) words.push_back(word);
  } else {
    while (stream >> word) words.push_back(word);
  }
  return words;
}

constexpr std::uint64_t kMostLegend = std::uint64_t{8} << 20;  // bytes

/// A label's number, all of the word.
std::optional<Label> labelIn(const std::string& word) {
  Label label = 0;
  const auto [end, fault] = std::from_chars(word.data(), word.data() + word.size(), label);
  if (fault != std::errc{} || end != word.data() + word.size()) return std::nullopt;
  return label;
}

}  // namespace

std::optional<fs::path> findLegend(const fs::path& volume) {
  fs::path stem = volume;
  if (stem.extension() == ".gz") stem.replace_extension();
  fs::path text = stem;
  text += ".txt";
  for (const fs::path& legend : {fs::path(stem).replace_extension(".tsv"), text}) {
    std::error_code ignored;
    if (fs::is_regular_file(legend, ignored)) return legend;
  }
  return std::nullopt;
}

std::optional<fs::path> findColours(const fs::path& volume) {
  fs::path file = volume;
  if (file.extension() == ".gz") file.replace_extension();
  file += ".lut";
  std::error_code ignored;
  return fs::is_regular_file(file, ignored) ? std::optional(file) : std::nullopt;
}

LabelColours readLabelColours(const fs::path& file) {
  constexpr std::size_t kColours = 256;  // of MRIcron's table
  ByteSource source(file);
  if (source.compressed() || source.leftAtMost() != 3 * kColours) {
    failToRead(file, "is no colour table of 768 bytes, as MRIcron writes them");
  }
  const Bytes bytes = source.rest();
  LabelColours colours;
  for (std::size_t key = 1; key < kColours; ++key) {
    const auto channel = [&](std::size_t c) {
      return static_cast<float>(bytes[c * kColours + key]) / 255;
    };
    colours[static_cast<Label>(key)] = {channel(0), channel(1), channel(2), 1};
  }
  return colours;
}

LabelNames readLabelNames(const fs::path& legend) {
  constexpr std::size_t kMostNames = 100'000;  // of an atlas
  const Bytes bytes = ByteSource(legend).rest(kMostLegend);
  if (bytes.size() > kMostLegend) refuse(legend, "is longer than any table of names (8 MB)");
  ByteCursor cursor(legend, bytes, false);
  LabelNames names;
  std::size_t index = 0, name = 1;
  for (int number = 1; cursor.left() > 0; ++number) {
    const std::string line(cursor.line());
    if (line.empty() || line.front() == '#') continue;
    const auto words = wordsOf(line);
    const auto heading = [&](const char* word) {
      return static_cast<std::size_t>(std::ranges::find(words, word) - words.begin());
    };
    if (names.empty() && heading("index") < words.size() && heading("name") < words.size()) {
      index = heading("index");
      name = heading("name");
      continue;
    }
    const std::optional<Label> label =
        words.size() > std::max(index, name) ? labelIn(words[index]) : std::nullopt;
    if (!label) {
      refuse(legend, "line " + std::to_string(number) + " has no number of a label and name");
    }
    names[*label] = words[name];
    if (names.size() > kMostNames) {
      refuse(legend, "holds more than " + std::to_string(kMostNames) + " names of labels");
    }
  }
  return names;
}

namespace {

using Rgb = std::array<std::uint8_t, 3>;

struct RegionRow {
  const char* name;
  Rgb colour;
};
/// Labels 1 to 35 of each hemisphere's thousand.
constexpr RegionRow kRegions[] = {{"bankssts", {25, 100, 40}},
                                  {"caudalanteriorcingulate", {125, 100, 160}},
                                  {"caudalmiddlefrontal", {100, 25, 0}},
                                  {"corpuscallosum", {120, 70, 50}},
                                  {"cuneus", {220, 20, 100}},
                                  {"entorhinal", {220, 20, 10}},
                                  {"fusiform", {180, 220, 140}},
                                  {"inferiorparietal", {220, 60, 220}},
                                  {"inferiortemporal", {180, 40, 120}},
                                  {"isthmuscingulate", {140, 20, 140}},
                                  {"lateraloccipital", {20, 30, 140}},
                                  {"lateralorbitofrontal", {35, 75, 50}},
                                  {"lingual", {225, 140, 140}},
                                  {"medialorbitofrontal", {200, 35, 75}},
                                  {"middletemporal", {160, 100, 50}},
                                  {"parahippocampal", {20, 220, 60}},
                                  {"paracentral", {60, 220, 60}},
                                  {"parsopercularis", {220, 180, 140}},
                                  {"parsorbitalis", {20, 100, 50}},
                                  {"parstriangularis", {220, 60, 20}},
                                  {"pericalcarine", {120, 100, 60}},
                                  {"postcentral", {220, 20, 20}},
                                  {"posteriorcingulate", {220, 180, 220}},
                                  {"precentral", {60, 20, 220}},
                                  {"precuneus", {160, 140, 180}},
                                  {"rostralanteriorcingulate", {80, 20, 140}},
                                  {"rostralmiddlefrontal", {75, 50, 125}},
                                  {"superiorfrontal", {20, 220, 160}},
                                  {"superiorparietal", {20, 180, 140}},
                                  {"superiortemporal", {140, 220, 220}},
                                  {"supramarginal", {80, 160, 20}},
                                  {"frontalpole", {100, 0, 100}},
                                  {"temporalpole", {70, 20, 170}},
                                  {"transversetemporal", {150, 150, 200}},
                                  {"insula", {255, 192, 32}}};

struct StructureRow {
  Label label;
  const char* name;
  Rgb colour;
};
// FreeSurfer's aseg: numbers, names and colours of its FreeSurferColorLUT.txt.
constexpr StructureRow kStructures[] = {{2, "Left-Cerebral-White-Matter", {245, 245, 245}},
                                        {3, "Left-Cerebral-Cortex", {205, 62, 78}},
                                        {4, "Left-Lateral-Ventricle", {120, 18, 134}},
                                        {5, "Left-Inf-Lat-Vent", {196, 58, 250}},
                                        {7, "Left-Cerebellum-White-Matter", {220, 248, 164}},
                                        {8, "Left-Cerebellum-Cortex", {230, 148, 34}},
                                        {10, "Left-Thalamus", {0, 118, 14}},
                                        {11, "Left-Caudate", {122, 186, 220}},
                                        {12, "Left-Putamen", {236, 13, 176}},
                                        {13, "Left-Pallidum", {12, 48, 255}},
                                        {14, "3rd-Ventricle", {204, 182, 142}},
                                        {15, "4th-Ventricle", {42, 204, 164}},
                                        {16, "Brain-Stem", {119, 159, 176}},
                                        {17, "Left-Hippocampus", {220, 216, 20}},
                                        {18, "Left-Amygdala", {103, 255, 255}},
                                        {24, "CSF", {60, 60, 60}},
                                        {26, "Left-Accumbens-area", {255, 165, 0}},
                                        {28, "Left-VentralDC", {165, 42, 42}},
                                        {41, "Right-Cerebral-White-Matter", {245, 245, 245}},
                                        {42, "Right-Cerebral-Cortex", {205, 62, 78}},
                                        {43, "Right-Lateral-Ventricle", {120, 18, 134}},
                                        {44, "Right-Inf-Lat-Vent", {196, 58, 250}},
                                        {46, "Right-Cerebellum-White-Matter", {220, 248, 164}},
                                        {47, "Right-Cerebellum-Cortex", {230, 148, 34}},
                                        {49, "Right-Thalamus", {0, 118, 14}},
                                        {50, "Right-Caudate", {122, 186, 220}},
                                        {51, "Right-Putamen", {236, 13, 176}},
                                        {52, "Right-Pallidum", {13, 48, 255}},
                                        {53, "Right-Hippocampus", {220, 216, 20}},
                                        {54, "Right-Amygdala", {103, 255, 255}},
                                        {58, "Right-Accumbens-area", {255, 165, 0}},
                                        {60, "Right-VentralDC", {165, 42, 42}}};

const RegionRow* regionOf(Label label) {
  const Label within = label % 1000;
  const bool cortex = label / 1000 == 1 || label / 1000 == 2;
  if (!cortex || within < 1 || within > static_cast<Label>(std::size(kRegions))) return nullptr;
  return &kRegions[within - 1];
}

LabelEntry entryOf(Label key, std::string name, const Rgb& colour) {
  LabelEntry entry{key, std::move(name), {0, 0, 0, 1}};
  for (int c = 0; c < 3; ++c) entry.colour[c] = static_cast<float>(colour[c]) / 255.0F;
  return entry;
}

}  // namespace

std::string freeSurferRegion(Label label) {
  const RegionRow* region = regionOf(label);
  return region == nullptr ? "" : region->name;
}

std::optional<LabelEntry> freeSurferEntry(Label label) {
  if (const RegionRow* region = regionOf(label)) {
    const char* side = label / 1000 == 1 ? "ctx-lh-" : "ctx-rh-";
    return entryOf(label, std::string(side) + region->name, region->colour);
  }
  for (const StructureRow& row : kStructures) {
    if (row.label == label) return entryOf(label, row.name, row.colour);
  }
  return {};
}

std::array<float, 4> distinctColour(Label label) {
  // Hues apart by the golden ratio, so that neighbours in number differ most.
  constexpr double kGolden = 0.61803398874989485;
  const double hue = 6 * std::fmod(kGolden * (static_cast<double>(label) + 1), 1.0);
  std::array<float, 4> colour = {0, 0, 0, 1};
  for (int c = 0; c < 3; ++c) {
    const double from = std::fmod(hue + 6 - 2 * c, 6.0);  // of this channel's own hue
    const double level = std::clamp(std::abs(from - 3) - 1, 0.0, 1.0);
    colour[c] = static_cast<float>(0.25 + 0.7 * level);
  }
  return colour;
}

std::vector<LabelEntry> tableFor(const std::vector<Label>& keys, const LabelNames& names,
                                 bool freeSurfer) {
  std::vector<LabelEntry> table;
  std::set<Label> sorted(keys.begin(), keys.end());
  for (const Label key : sorted) {
    std::optional<LabelEntry> entry;
    if (freeSurfer) entry = freeSurferEntry(key);
    if (!entry) entry = LabelEntry{key, std::to_string(key), distinctColour(key)};
    if (const auto named = names.find(key); named != names.end()) entry->name = named->second;
    table.push_back(*entry);
  }
  return table;
}

}  // namespace explica::io
