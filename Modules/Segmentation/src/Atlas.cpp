// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Segmentation/Atlas.h"

#include "Explica/Core/Errors.h"

#include <algorithm>
#include <array>
#include <sstream>

namespace explica::segmentation {
namespace {

bool startsWithAny(std::string_view name, std::initializer_list<std::string_view> beginnings) {
  return std::any_of(beginnings.begin(), beginnings.end(),
                     [&](std::string_view b) { return name.substr(0, b.size()) == b; });
}

}  // namespace

AtlasStructure structureNamed(const std::string& name) {
  AtlasStructure structure{name, Side::Both, StructureKind::Cortex};
  const std::string_view ending =
      std::string_view(name).substr(name.size() - std::min<std::size_t>(2, name.size()));
  if (ending == "_L") structure.side = Side::Left;
  if (ending == "_R") structure.side = Side::Right;
  if (startsWithAny(name, {"Cerebel", "Vermis"})) structure.kind = StructureKind::BelowTent;
  if (startsWithAny(name,
                    {"Caudate", "Putamen", "Pallidum", "Thalamus", "Hippocampus", "Amygdala"})) {
    structure.kind = StructureKind::Deep;
  }
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

}  // namespace explica::segmentation
