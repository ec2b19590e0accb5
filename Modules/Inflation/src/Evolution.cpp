// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Inflation/Inflate.h"

#include "Explica/Unfolding/Account.h"

#include <array>
#include <cstdio>
#include <string_view>

namespace explica::inflation {
namespace {

/// Columns of an unfolding that mean nothing where there are neither surroundings nor a knot
/// energy.
constexpr std::array<std::string_view, 8> kWithout = {
    "collar_stretch_mean", "collar_stretch_max", "energy_lift", "energy_guide",
    "energy_collar",       "energy_overhang",    "energy_knot", "seconds_repulsion"};

std::vector<unfolding::EvolutionColumn> columns() {
  std::vector<unfolding::EvolutionColumn> kept;
  for (const unfolding::EvolutionColumn& column : unfolding::evolutionColumns()) {
    bool without = false;
    for (const std::string_view name : kWithout) without = without || column.name == name;
    if (!without) kept.push_back(column);
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
    char text[80];
    std::snprintf(text, sizeof text, "%d\t%.6f\t%.6f", row.step.iteration, row.visibility,
                  row.seen);
    table += text;
    for (const unfolding::EvolutionColumn& column : kept) {
      std::snprintf(text, sizeof text, column.format, column.of(row.step));
      table += "\t" + std::string(text);
    }
    table += "\n";
  }
  return table;
}

}  // namespace explica::inflation
