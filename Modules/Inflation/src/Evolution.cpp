// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Inflation/Inflate.h"

#include "Explica/Core/Text.h"
#include "Explica/Unfolding/Account.h"
#include "Explica/Unfolding/Terms.h"

#include <algorithm>
#include <array>
#include <string_view>

namespace explica::inflation {
namespace {

/// Columns of an unfolding that mean nothing where there are neither surroundings nor a knot
/// energy, beside those of terms that a closed surface does not feel.
constexpr std::array<std::string_view, 3> kWithout = {"collar_stretch_mean", "collar_stretch_max",
                                                      "seconds_repulsion"};

bool hasMeaning(const std::string& column) {
  if (std::ranges::find(kWithout, column) != kWithout.end()) return false;
  return std::ranges::none_of(unfolding::kTerms, [&](const unfolding::TermInfo& info) {
    return !info.closed && column == "energy_" + std::string(info.name);
  });
}

std::vector<unfolding::EvolutionColumn> columns() {
  std::vector<unfolding::EvolutionColumn> kept;
  for (const unfolding::EvolutionColumn& column : unfolding::evolutionColumns()) {
    if (hasMeaning(column.name)) kept.push_back(column);
  }
  return kept;
}

}  // namespace

std::string evolutionTable(const std::vector<InflateRecord>& history) {
  const auto kept = columns();
  std::string table = "iteration\tvisibility\tseen";
  for (const unfolding::EvolutionColumn& column : kept) {
    table += "\t" + (column.name == "visibility" ? "turned" : column.name);
  }
  table += "\n";
  for (const InflateRecord& row : history) {
    table += printed("%d\t%.6f\t%.6f", row.step.iteration, row.visibility, row.seen);
    for (const unfolding::EvolutionColumn& column : kept) {
      table += "\t" + printed(column.format, column.of(row.step));
    }
    table += "\n";
  }
  return table;
}

}  // namespace explica::inflation
