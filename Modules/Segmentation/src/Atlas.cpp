// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Segmentation/Atlas.h"

#include "Explica/Core/Errors.h"

#include <algorithm>
#include <array>
#include <set>
#include <sstream>
#include <tuple>
#include <utility>

namespace explica::segmentation {
namespace {

bool startsWithAny(std::string_view name, std::initializer_list<std::string_view> beginnings) {
  return std::any_of(beginnings.begin(), beginnings.end(),
                     [&](std::string_view b) { return name.substr(0, b.size()) == b; });
}

/// FreeSurfer's numbers of one side's structures that the white surface encloses.
constexpr std::array kFreeSurferDeepLeft = {4, 5, 9, 10, 11, 12, 13, 17, 18, 26, 28, 30, 31, 78};
constexpr std::array kFreeSurferDeepRight = {43, 44, 48, 49, 50, 51, 52,
                                             53, 54, 58, 60, 62, 63, 79};
/// Ranges of numbers that no segmentation of FreeSurfer holds.
constexpr std::array kNotFreeSurfers = {std::pair{1, 1}, std::pair{19, 23}, std::pair{64, 71},
                                        std::pair{86, 116}};
constexpr std::array kFreeSurferBelowTent = {7, 8, 16, 46, 47};  // cerebellum and brain stem

}  // namespace

AtlasStructure structureNamed(const std::string& name) {
  AtlasStructure structure{name, Side::Both, StructureKind::Cortex};
  const std::string_view ending =
      std::string_view(name).substr(name.size() - std::min<std::size_t>(2, name.size()));
  if (ending == "_L") structure.side = Side::Left;
  if (ending == "_R") structure.side = Side::Right;
  if (startsWithAny(name, {"Cerebel", "Vermis", "Below_"})) {
    structure.kind = StructureKind::BelowTent;
  }
  if (startsWithAny(name, {"Caudate", "Putamen", "Pallidum", "Thalamus", "Hippocampus", "Amygdala",
                           "Deep_"})) {
    structure.kind = StructureKind::Deep;
  }
  if (startsWithAny(name, {"White_"})) structure.kind = StructureKind::White;
  return structure;
}

AtlasLegend parseAtlasLegend(std::string_view text, std::string_view name) {
  AtlasLegend legend;
  std::istringstream lines{std::string(text)};
  std::string line;
  for (int number = 1; std::getline(lines, line); ++number) {
    if (!line.empty() && line.back() == '\r') line.pop_back();
    std::istringstream words(line);
    std::string first;
    if (!(words >> first) || first[0] == '#') continue;
    if (legend.empty() && first == "index") continue;
    Label value = 0;
    std::string structure;
    std::istringstream digits(first);
    if (!(digits >> value) || !digits.eof() || !(words >> structure)) {
      throw InvalidInput(std::string(name) + ": line " + std::to_string(number) + " is '" + line +
                         "', expected a label's value and its name");
    }
    if (!legend.emplace(value, structureNamed(structure)).second) {
      throw InvalidInput(std::string(name) + ": line " + std::to_string(number) + " names label " +
                         std::to_string(value) + " a second time");
    }
  }
  for (const auto& [side, word] : {std::pair{Side::Left, "_L"}, std::pair{Side::Right, "_R"}}) {
    const bool found = std::any_of(legend.begin(), legend.end(), [s = side](const auto& entry) {
      return entry.second.side == s && entry.second.kind == StructureKind::Cortex;
    });
    if (!found) {
      throw InvalidInput(std::string(name) + ": no cortical structure's name ends in " + word +
                         "; expected an atlas that tells left from right as AAL does");
    }
  }
  return legend;
}

bool isFreeSurferAtlas(const Volume<Label>& labels) {
  const std::set<Label> found(labels.data.begin(), labels.data.end());
  const auto has = [&](Label first, Label last) {
    const auto at = found.lower_bound(first);
    return at != found.end() && *at <= last;
  };
  // Atlases that count their regions from 1 on, as AAL does, have FreeSurfer's numbers too.
  for (const auto& [first, last] : kNotFreeSurfers) {
    if (has(first, last)) return false;
  }
  const bool left = has(3, 3) || has(1001, 1035) || has(11101, 11175);
  const bool right = has(42, 42) || has(2001, 2035) || has(12101, 12175);
  return left && right && has(2, 2) && has(41, 41);
}

AtlasLegend freeSurferLegend() {
  AtlasLegend legend;
  const auto add = [&](Label label, const char* what, Side side, StructureKind kind) {
    legend[label] = {std::string(what) + std::to_string(label), side, kind};
  };
  for (const auto& [side, white, cortex, thousand] :
       {std::tuple{Side::Left, 2, 3, 1}, std::tuple{Side::Right, 41, 42, 2}}) {
    add(white, "white", side, StructureKind::White);
    add(cortex, "cortex", side, StructureKind::Cortex);
    for (Label n = 0; n <= 35; ++n) {
      add(1000 * thousand + n, "cortex", side, StructureKind::Cortex);
    }
    for (Label n = 100; n <= 175; ++n) {
      add(10000 + 1000 * thousand + n, "cortex", side, StructureKind::Cortex);
    }
  }
  for (const int n : kFreeSurferDeepLeft) add(n, "deep", Side::Left, StructureKind::Deep);
  for (const int n : kFreeSurferDeepRight) add(n, "deep", Side::Right, StructureKind::Deep);
  for (const int n : kFreeSurferBelowTent) add(n, "below", Side::Both, StructureKind::BelowTent);
  return legend;
}

void keepNamed(Volume<Label>& atlas, const AtlasLegend& legend) {
  for (Label& label : atlas.data) {
    if (legend.count(label) == 0) label = 0;
  }
}

}  // namespace explica::segmentation
