// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Core/Html.h"
#include "Explica/Core/Text.h"
#include "Explica/Study/HeartStudy.h"
#include "HeartColumns.h"

#include <algorithm>
#include <cstdlib>
#include <iterator>

namespace explica::study {
namespace {

/// What the page shows of each person.
constexpr HeartColumn kShown[] = {{"cavity_volume_ed_ml", "ml", "cavity, end-diastole"},
                                  {"cavity_volume_es_ml", "ml", "cavity, end-systole"},
                                  {"ejection_fraction_percent", "%", "ejection fraction"},
                                  {"mass_ed_g", "g", "mass"},
                                  {"thickness_mean_ed", "mm", "wall, end-diastole"},
                                  {"thickness_mean_es", "mm", "wall, end-systole"},
                                  {"thickening_percent", "%", "thickening"}};

/// "63.27618" as "63.3".
std::string rounded(const std::string& text) {
  char* end = nullptr;
  const double number = std::strtod(text.c_str(), &end);
  if (end == text.c_str() || *end != '\0') return text;
  return printed("%.1f", number);
}

constexpr char kStyle[] =
    R"(:root{color-scheme:light dark;--ink:#1a1d21;--paper:#fff;--line:#d5d9dd;--soft:#f1f3f5;--bad:#fbf0ee;--link:#145ab4}
@media(prefers-color-scheme:dark){:root{--ink:#e6e9ed;--paper:#16191d;--line:#3a424b;--soft:#20252b;--bad:#3a2321;--link:#7ab8ee}}
body{font:16px/1.5 system-ui,sans-serif;color:var(--ink);background:var(--paper);max-width:1180px;margin:2em auto;padding:0 1em}
.scroll{overflow-x:auto}table{border-collapse:collapse}td,th{border:1px solid var(--line);padding:4px 10px;text-align:left;vertical-align:top}
td.n{text-align:right}th{background:var(--soft)}tr.bad{background:var(--bad)}td.wide{padding:8px 10px 20px}img{height:460px;background:#fff}a{color:var(--link)})";

/// A line of numbers, and below it the pictures or what went wrong.
std::string pageRow(const StudyRow& row, const std::vector<std::string>& about) {
  const std::size_t colon = row.state.find(": ");
  const std::string open = row.state == "done" ? "<tr><td>" : "<tr class=\"bad\"><td>";
  std::string text = open + escapeHtml(row.participant) + "</td><td>" +
                     escapeHtml(row.state.substr(0, colon)) + "</td>";
  for (const std::string& name : about) {
    text += "<td>" + escapeHtml(valueIn(row, name)) + "</td>";
  }
  for (const HeartColumn& column : kShown) {
    text += "<td class=\"n\">" + escapeHtml(rounded(valueIn(row, column.key))) + "</td>";
  }
  text += "</tr>\n<tr><td class=\"wide\" colspan=\"" +
          std::to_string(2 + about.size() + std::size(kShown)) + "\">";
  if (colon != std::string::npos) text += escapeHtml(row.state.substr(colon + 2));
  if (!row.thumbnail.empty()) {
    const std::string picture = escapeHtml(row.thumbnail.generic_string());
    text += "<a href=\"" + picture + "\"><img loading=\"lazy\" alt=\"bull's-eyes of " +
            escapeHtml(row.participant) + "\" src=\"" + picture + "\"></a>";
  }
  return text + "</td></tr>\n";
}

}  // namespace

std::string heartPage(const std::vector<StudyRow>& rows, const std::string& title) {
  const std::vector<std::string> about = aboutColumns(rows);
  const auto done =
      std::ranges::count_if(rows, [](const StudyRow& row) { return row.state == "done"; });
  std::string text =
      "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><meta name=\"viewport\" "
      "content=\"width=device-width, initial-scale=1\"><link rel=\"icon\" href=\"data:,\"><title>" +
      escapeHtml(title) + "</title><style>" + kStyle + "</style></head><body><main>\n<h1>" +
      escapeHtml(title) + "</h1>\n<p>" + std::to_string(done) + " of " +
      std::to_string(rows.size()) +
      " hearts are done. All numbers, segments too, are in <a href=\"hearts.tsv\">hearts.tsv</a>; "
      "each folder holds what healthy adults have beside it (reference.tsv).</p>\n"
      "<div class=\"scroll\" tabindex=\"0\" role=\"region\" "
      "aria-label=\"hearts\"><table><tr><th>heart</th><th>state</th>";
  for (const std::string& name : about) {
    text += "<th>" + escapeHtml(name.substr(kAboutPrefix.size())) + "</th>";
  }
  for (const HeartColumn& column : kShown) {
    text += std::string("<th>") + column.meaning + ", " + column.unit + "</th>";
  }
  text += "</tr>\n";
  for (const StudyRow& row : rows) text += pageRow(row, about);
  return text + "</table></div>\n</main></body></html>\n";
}

}  // namespace explica::study
