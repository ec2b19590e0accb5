// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Study/StudyPage.h"

#include "Explica/Core/Html.h"
#include "Explica/Provenance/Json.h"
#include "PageParts.h"

#include <algorithm>

namespace explica::study {
namespace {

using provenance::Json;

struct Heading {
  std::string words, unit;
};

bool isAbout(const std::string& column) {
  return column.starts_with(kAboutPrefix);
}

/// The words of a column; one without its own is named by its step and key.
Heading headingOf(const std::string& column) {
  if (const KnownColumn* known = knownColumn(column)) return {known->words, known->unit};
  const std::size_t dot = column.find('.');
  std::string words = column.substr(dot + 1);
  if (isRegion(column)) return {words, "mm"};
  if (isAbout(column)) return {words, ""};
  std::ranges::replace(words, '_', ' ');
  return {column.substr(0, dot) + ": " + words, ""};
}

bool hasRegions(const std::vector<StudyRow>& rows) {
  return std::ranges::any_of(rows, [](const StudyRow& row) { return !row.region.empty(); });
}

Json headingsOf(const std::vector<std::string>& fixed, const std::vector<std::string>& columns) {
  Json headings = Json::array();
  for (const std::string& name : fixed) headings.push_back({{"words", name}, {"kind", "fixed"}});
  for (const std::string& column : columns) {
    const Heading heading = headingOf(column);
    headings.push_back({{"words", heading.words},
                        {"unit", heading.unit},
                        {"kind", isRegion(column)  ? "region"
                                 : isAbout(column) ? "about"
                                 : isFirst(column) ? "first"
                                                   : "other"},
                        {"compared", isCompared(column)}});
  }
  return headings;
}

Json rowJson(const StudyRow& row, const std::vector<StudyFlag>& flags, bool regions,
             std::size_t fixed, const std::vector<std::string>& columns) {
  Json cells = Json::array({row.participant, row.hemisphere});
  if (regions) cells.push_back(row.region);
  cells.push_back(row.state);
  for (const auto& column : columns) cells.push_back(valueIn(row, column));
  Json marks = Json::object();
  for (const StudyFlag& flag : flags) {
    const auto at = std::ranges::find(columns, flag.column);
    const auto index = at == columns.end() ? fixed - 1  // state
                                           : fixed + static_cast<std::size_t>(at - columns.begin());
    marks[std::to_string(index)] = flag.reason;
  }
  Json entry = {{"cells", cells}, {"flags", marks}};
  if (!row.report.empty()) entry["report"] = row.report.generic_string();
  if (!row.thumbnail.empty()) entry["thumbnail"] = row.thumbnail.generic_string();
  return entry;
}

// What the script fills from the data.
constexpr const char* kBody =
    R"(<noscript><p>Sorting and plots need JavaScript; study.tsv and study_internals.tsv hold the same table.</p></noscript>
<section id="failures" aria-label="what failed"></section>
<section id="distribution"><h2>Distribution across people</h2><p>A dot is a row; its name appears under the pointer, a click finds it in the table. Of many rows an area shows how many lie where, and dots are those far off. Yellow: far from the others, by a robust z above 3.5 (0.6745 (x - median) / MAD, over at least 8 rows). An axis holds what is within 4 robust deviations (1.4826 MAD) of the median; a triangle at its end is a row that lies beyond.</p><p><label>colour by <select id="by"><option value="">nothing</option></select></label> <span id="groups"></span></p><div id="strips"></div></section>
<section><h2>All rows</h2>
<form><input type="search" id="search" placeholder="participant, side or state" aria-label="filter rows">
<label><input type="checkbox" id="flagged"> only those that need a look</label>
<label>columns <select id="set"><option value="quality">quality</option><option value="regions">thickness by region, mm</option><option value="all">all</option></select></label></form>
<div class="wide" tabindex="0" role="region" aria-label="table of all rows"><table><thead><tr></tr></thead><tbody></tbody></table></div>
<nav aria-label="pages of the table"><button id="before" type="button">previous</button><span id="shown" aria-live="polite"></span><button id="after" type="button">next</button></nav></section>
<section id="regions"><h2>Thickness by region</h2><p>Mean and standard deviation over the rows of each side, mm.</p><div class="wide" tabindex="0" role="region" aria-label="thickness by region"></div></section>
)";

}  // namespace

std::string indexPage(const std::vector<StudyRow>& rows, const std::string& title,
                      const std::string& part) {
  std::vector<std::string> columns = columnsOf(rows);
  std::erase_if(
      columns, [](const std::string& column) { return isRegion(column) && !isRegionMean(column); });
  const auto flags = flagsOf(rows);
  const bool regions = hasRegions(rows);
  std::vector<std::string> fixed = {"participant", "hemisphere"};
  if (regions) fixed.emplace_back("region");
  fixed.emplace_back("state");
  Json data = {
      {"fixed", fixed.size()}, {"columns", headingsOf(fixed, columns)}, {"rows", Json::array()}};
  for (std::size_t n = 0; n < rows.size(); ++n) {
    data["rows"].push_back(rowJson(rows[n], flags[n], regions, fixed.size(), columns));
  }
  const auto done =
      std::ranges::count_if(rows, [](const StudyRow& row) { return row.state == "done"; });
  const auto marked = std::ranges::count_if(flags, [](const auto& row) { return !row.empty(); });
  return "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><meta name=\"viewport\" "
         "content=\"width=device-width\"><link rel=\"icon\" href=\"data:,\"><title>" +
         escapeHtml(title) + "</title><style>" + kStudyStyle + "</style></head><body>\n<main><h1>" +
         escapeHtml(title) + "</h1>\n<p>" + std::to_string(done) + " of " +
         std::to_string(rows.size()) + " hemispheres are done; " + std::to_string(marked) +
         " need a look. The numbers in full are in <a href=\"study.tsv\">study.tsv</a>, those of "
         "regions in <a href=\"study_regions.tsv\">study_regions.tsv</a> too, how each step went "
         "in <a href=\"study_internals.tsv\">study_internals.tsv</a>.</p>\n" +
         part + kBody + "</main><script type=\"application/json\" id=\"data\">" +
         scriptSafe(provenance::textOf(data)) + "</script>\n<script>" + kStudyScript +
         "</script>\n</body></html>\n";
}

}  // namespace explica::study
