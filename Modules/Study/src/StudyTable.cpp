// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Study/StudyTable.h"

#include "Explica/Core/Errors.h"
#include "Explica/Provenance/Json.h"

#include <algorithm>
#include <fstream>
#include <set>

namespace explica::study {
namespace {

namespace fs = std::filesystem;
using provenance::Json;

/// Columns that come first, in this order; others follow by name.
constexpr const char* kFirstColumns[] = {"thickness.thickness_mean",
                                         "thickness.thickness_median",
                                         "thickness.sulcal_voxels_recovered",
                                         "surface.faces",
                                         "surface.euler_characteristic",
                                         "surface.defects_corrected",
                                         "surface.voxels_changed",
                                         "surface.self_intersections",
                                         "surface.area_white",
                                         "surface.area_pial",
                                         "surface.thickness_mean",
                                         "unfold.region_area",
                                         "unfold.visibility_initial",
                                         "unfold.visibility_final",
                                         "unfold.seen_initial",
                                         "unfold.seen_final",
                                         "unfold.area_error_mean",
                                         "unfold.edge_strain_mean",
                                         "unfold.self_intersections_final",
                                         "unfold.iterations",
                                         "unfold.stop_reason"};

std::string textOf(const Json& value) {
  if (value.is_null()) return "n/a";
  std::string text = value.is_string() ? value.get<std::string>() : value.dump();
  std::replace_if(
      text.begin(), text.end(), [](char c) { return c == '\t' || c == '\n' || c == '\r'; }, ' ');
  return text;
}

/// Numbers and words of a step's summary; lists and objects do not fit a table, times do not
/// belong.
void addSummary(StudyRow& row, const std::string& step, const Json& summary) {
  static const std::set<std::string> left = {"command", "peak_memory_bytes", "warnings"};
  for (const auto& [key, value] : summary.items()) {
    if (value.is_structured() || left.count(key) || key.rfind("seconds", 0) == 0) continue;
    row.values[step + "." + key] = textOf(value);
  }
}

void addState(StudyRow& row, const fs::path& run) {
  row.state = "failed: it did not begin";
  if (!fs::exists(run / "run.json")) return;
  row.state = "done";
  const Json account = provenance::readJson(run / "run.json");
  for (const Json& step : account["steps"]) {
    std::string state = textOf(step["state"]);
    if (state == "done") continue;
    if (state == "stopped") state = "stopped early";
    const std::string message = step.contains("message") ? textOf(step["message"]) : "";
    row.state = state + " (" + textOf(step["name"]) + ")" + (message.empty() ? "" : ": " + message);
    if (state == "failed") return;  // the first fault explains the rest
  }
}

StudyRow rowOf(const fs::path& out, const fs::path& run) {
  StudyRow row;
  const std::string name = run.filename().string();
  const std::size_t hemi = name.rfind("_hemi-");
  row.participant = name.substr(0, hemi);
  row.hemisphere = name.substr(hemi + 6);
  try {
    addState(row, run);
    for (const char* step : {"segment", "thickness", "surface", "unfold"}) {
      const fs::path summary = run / step / "summary.json";
      if (fs::exists(summary)) addSummary(row, step, provenance::readJson(summary));
    }
  } catch (const std::exception& fault) {  // a damaged file is a fact of the study, not its end
    row.state = std::string("failed: ") + fault.what();
  }
  if (fs::exists(run / "problem.txt")) {
    std::ifstream file(run / "problem.txt");
    std::string problem;
    std::getline(file, problem);
    row.state = "failed: " + problem;
  }
  if (fs::exists(run / "report.html")) row.report = fs::relative(run / "report.html", out);
  return row;
}

std::vector<std::string> columnsOf(const std::vector<StudyRow>& rows) {
  std::set<std::string> all;
  for (const StudyRow& row : rows) {
    for (const auto& [column, value] : row.values) all.insert(column);
  }
  std::vector<std::string> columns;
  for (const char* first : kFirstColumns) {
    if (all.erase(first)) columns.emplace_back(first);
  }
  columns.insert(columns.end(), all.begin(), all.end());
  return columns;
}

std::string escaped(const std::string& text) {
  std::string result;
  for (const char c : text) {
    switch (c) {
      case '&':
        result += "&amp;";
        break;
      case '<':
        result += "&lt;";
        break;
      case '>':
        result += "&gt;";
        break;
      case '"':
        result += "&quot;";
        break;
      default:
        result += c;
    }
  }
  return result;
}

constexpr const char* kStyle = R"(
body{font:15px/1.4 system-ui,sans-serif;margin:1.5rem;color:#222}
h1{font-size:1.4rem}div{overflow-x:auto}
table{border-collapse:collapse;font-variant-numeric:tabular-nums}
th,td{padding:.25rem .6rem;border-bottom:1px solid #ddd;text-align:right;white-space:nowrap}
th:first-child,td:first-child,td:nth-child(3){text-align:left}
th button{font:inherit;font-weight:600;border:0;background:none;cursor:pointer}
th[aria-sort=ascending] button::after{content:" \25B2"}
th[aria-sort=descending] button::after{content:" \25BC"}
tr.flag td:nth-child(3){color:#9b2c00;font-weight:600}
)";

constexpr const char* kScript = R"(
const table=document.querySelector('table');
table.querySelectorAll('th').forEach((th,column)=>th.firstChild.addEventListener('click',()=>{
  const up=th.getAttribute('aria-sort')!=='ascending';
  table.querySelectorAll('th').forEach(t=>t.removeAttribute('aria-sort'));
  th.setAttribute('aria-sort',up?'ascending':'descending');
  const rows=[...table.tBodies[0].rows];
  const key=r=>r.cells[column].textContent;
  rows.sort((a,b)=>{const x=key(a),y=key(b),n=x-y;
    return (up?1:-1)*(Number.isNaN(n)?x.localeCompare(y):n);});
  table.tBodies[0].append(...rows);
}));
)";

}  // namespace

std::vector<StudyRow> collectRows(const fs::path& out) {
  const fs::path runs = out / "runs";
  if (!fs::is_directory(runs)) {
    throw InvalidInput(out.string() + ": holds no runs; do the participant level first");
  }
  std::vector<fs::path> folders;
  for (const auto& entry : fs::directory_iterator(runs)) {
    const std::string name = entry.path().filename().string();
    if (entry.is_directory() && name.rfind("sub-", 0) == 0 &&
        name.find("_hemi-") != std::string::npos) {
      folders.push_back(entry.path());
    }
  }
  std::sort(folders.begin(), folders.end());
  std::vector<StudyRow> rows;
  for (const fs::path& run : folders) rows.push_back(rowOf(out, run));
  return rows;
}

std::string tableText(const std::vector<StudyRow>& rows) {
  const std::vector<std::string> columns = columnsOf(rows);
  std::string text = "participant_id\themisphere\tstate";
  for (const auto& column : columns) text += "\t" + column;
  text += "\n";
  for (const StudyRow& row : rows) {
    text += row.participant + "\t" + row.hemisphere + "\t" + row.state;
    for (const auto& column : columns) {
      const auto value = row.values.find(column);
      text += "\t" + (value == row.values.end() ? "n/a" : value->second);
    }
    text += "\n";
  }
  return text;
}

std::string indexPage(const std::vector<StudyRow>& rows, const std::string& title) {
  const std::vector<std::string> columns = columnsOf(rows);
  const auto done = std::count_if(rows.begin(), rows.end(),
                                  [](const StudyRow& row) { return row.state == "done"; });
  std::string page =
      "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><meta "
      "name=\"viewport\" content=\"width=device-width\"><title>" +
      escaped(title) + "</title><style>" + kStyle + "</style></head><body>\n<h1>" + escaped(title) +
      "</h1>\n<p>" + std::to_string(done) + " of " + std::to_string(rows.size()) +
      " hemispheres are done. A click on a heading sorts.</p>\n<div><table><thead><tr>";
  const auto heading = [&](const std::string& text) {
    page += "<th scope=\"col\"><button>" + escaped(text) + "</button></th>";
  };
  heading("participant");
  heading("hemisphere");
  heading("state");
  for (const auto& column : columns) heading(column);
  page += "</tr></thead><tbody>\n";
  for (const StudyRow& row : rows) {
    const std::string name = escaped(row.participant);
    page += row.state == "done" ? "<tr>" : "<tr class=\"flag\">";
    page += "<td>" +
            (row.report.empty()
                 ? name
                 : "<a href=\"" + escaped(row.report.generic_string()) + "\">" + name + "</a>") +
            "</td><td>" + escaped(row.hemisphere) + "</td><td>" + escaped(row.state) + "</td>";
    for (const auto& column : columns) {
      const auto value = row.values.find(column);
      page += "<td>" + (value == row.values.end() ? "n/a" : escaped(value->second)) + "</td>";
    }
    page += "</tr>\n";
  }
  return page + "</tbody></table></div>\n<script>" + kScript + "</script>\n</body></html>\n";
}

}  // namespace explica::study
