// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Core/Text.h"
#include "ReportParts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

namespace explica::pipeline {
namespace {

struct Shown {
  const char* measure;  ///< as regions.tsv has it
  const char* heading;
};
constexpr std::array kShown = {Shown{"thickness_mean", "mean thickness [mm]"},
                               Shown{"thickness_sd_vertices", "its SD over vertices [mm]"},
                               Shown{"area", "area [mm\u00b2]"},
                               Shown{"volume", "volume [mm\u00b3]"}, Shown{"vertices", "vertices"}};

}  // namespace

void tabulate(ResultFolder& results, const Table& read, const std::string& title,
              const std::string& caption) {
  constexpr std::size_t kMost = 60;  // rows
  report::ReportTable table{"", title, caption, {}, {}};
  for (const std::string& name : read.names) {
    if (name != "key") table.columns.push_back(inWords(name));
  }
  for (std::size_t n = 0; n < std::min(read.rows.size(), kMost); ++n) {
    std::vector<std::string>& cells = table.rows.emplace_back();
    for (const std::string& name : read.names) {
      if (name == "key") continue;
      const double value = numberIn(read.rows[n], name);
      const bool isNumber = &name != &read.names.front() && std::isfinite(value);
      cells.push_back(isNumber ? readable(value) : read.rows[n].at(name));
    }
  }
  if (read.rows.size() > kMost) {
    table.caption += printed(" The first %zu of %zu rows.", kMost, read.rows.size());
  }
  results.content().tables.push_back(std::move(table));
}

void tabulateRegions(ResultFolder& results, const StepFolder& step) {
  const Table read = readTable(step.folder / "regions.tsv");
  std::map<std::string, std::array<std::string, kShown.size()>> rows;
  for (const TableRow& row : read.rows) {
    for (std::size_t c = 0; c < kShown.size(); ++c) {
      if (cellIn(row, "measure") == kShown[c].measure) {
        rows[cellIn(row, "region")][c] = readable(numberIn(row, "value"));
      }
    }
  }
  report::ReportTable table{"",
                            "Regions" + step.sideWords(),
                            "The mean is over the area; regions.tsv has all digits and measures.",
                            {"region"},
                            {}};
  for (const Shown& shown : kShown) table.columns.emplace_back(shown.heading);
  for (const auto& [name, cells] : rows) {
    table.rows.push_back({name});
    table.rows.back().insert(table.rows.back().end(), cells.begin(), cells.end());
  }
  results.content().tables.push_back(std::move(table));
}

}  // namespace explica::pipeline
