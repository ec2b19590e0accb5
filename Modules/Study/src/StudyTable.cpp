// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Study/StudyTable.h"

#include "Explica/Core/Errors.h"
#include "Explica/Provenance/Json.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <optional>
#include <set>
#include <sstream>

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

/// Numbers that should be alike in all rows.
constexpr const char* kComparedColumns[] = {
    "thickness.thickness_mean", "surface.thickness_mean",    "surface.area_white",
    "surface.area_pial",        "surface.defects_corrected", "surface.voxels_changed",
    "unfold.area_error_mean",   "unfold.edge_strain_mean",   "unfold.visibility_final",
    "unfold.seen_final",        "thickness.traced_fraction", "surface.volume_white"};

constexpr std::string_view kRegionPrefix = "region.";
constexpr double kFar = 3.5;            // robust z [IglewiczHoaglin1993]
constexpr std::size_t kFewestRows = 8;  // below, a median and its spread say little

bool isRegion(const std::string& column) {
  return column.rfind(kRegionPrefix, 0) == 0;
}

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

/// Mean thickness of each region, from the table that `explica surface --atlas` writes.
void addRegions(StudyRow& row, const fs::path& file) {
  std::ifstream table(file);
  std::string line;
  std::getline(table, line);  // headings: index name vertices area mean sd
  while (std::getline(table, line)) {
    std::istringstream cells(line);
    std::string index, name, vertices, area, mean;
    std::getline(cells, index, '\t');
    std::getline(cells, name, '\t');
    std::getline(cells, vertices, '\t');
    std::getline(cells, area, '\t');
    std::getline(cells, mean, '\t');
    if (!mean.empty()) row.values[std::string(kRegionPrefix) + name] = mean;
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

/// A step whose numbers cannot be believed fails the row; what failed before explains more.
void addFlags(StudyRow& row, const std::string& step, const Json& summary) {
  if (summary.value("plausible", true) || row.state != "done") return;
  for (const Json& flag : summary.value("flags", Json::array())) {
    if (flag.value("accepted", false)) continue;
    row.state = "implausible (" + step + "): " + textOf(flag.value("message", Json("")));
    return;
  }
}

StudyRow rowOf(const fs::path& out, const fs::path& run) {
  StudyRow row;
  const std::string name = run.filename().string();
  const std::size_t hemi = name.rfind("_hemi-");
  row.participant = name.substr(0, hemi);
  row.hemisphere = name.substr(hemi + 6);
  constexpr std::string_view kRegion = "_region-";
  if (const auto at = row.hemisphere.find(kRegion); at != std::string::npos) {
    row.region = row.hemisphere.substr(at + kRegion.size());
    row.hemisphere.resize(at);
  }
  try {
    addState(row, run);
    for (const char* step : {"segment", "thickness", "surface", "unfold"}) {
      const fs::path summary = run / step / "summary.json";
      if (!fs::exists(summary)) continue;
      const Json numbers = provenance::readJson(summary);
      addSummary(row, step, numbers);
      addFlags(row, step, numbers);
    }
    addRegions(row, run / "surface" / "regions.tsv");
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

/// Columns of all rows: those that come first, others by name, regions last.
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
  std::stable_partition(columns.begin(), columns.end(),
                        [](const std::string& column) { return !isRegion(column); });
  return columns;
}

std::optional<double> numberIn(const StudyRow& row, const std::string& column) {
  const auto value = row.values.find(column);
  if (value == row.values.end()) return std::nullopt;
  char* end = nullptr;
  const double number = std::strtod(value->second.c_str(), &end);
  const bool whole = end != value->second.c_str() && *end == '\0' && std::isfinite(number);
  return whole ? std::optional(number) : std::nullopt;
}

double medianOf(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  if (values.size() % 2 == 1) return *middle;
  return 0.5 * (*middle + *std::max_element(values.begin(), middle));
}

/// Marks the rows whose number is far from the others'.
void flagOutliers(const std::vector<StudyRow>& rows, const std::vector<std::size_t>& group,
                  const std::string& column, std::vector<std::vector<StudyFlag>>& flags) {
  std::vector<double> values;
  for (const std::size_t n : group) {
    if (const auto number = numberIn(rows[n], column)) values.push_back(*number);
  }
  if (values.size() < kFewestRows) return;
  const double median = medianOf(values);
  for (double& value : values) value = std::abs(value - median);
  const double spread = medianOf(std::move(values));
  if (!(spread > 0)) return;
  for (const std::size_t n : group) {
    const auto number = numberIn(rows[n], column);
    if (!number) continue;
    const double z = 0.6745 * (*number - median) / spread;
    if (std::abs(z) <= kFar) continue;
    char reason[64];
    std::snprintf(reason, sizeof reason, "robust z %.1f", z);
    flags[n].push_back({column, reason});
  }
}

/// Text for HTML.
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

/// JSON that may stand in a script element.
std::string scriptText(const Json& value) {
  std::string text = value.dump(-1, ' ', false, Json::error_handler_t::replace);
  for (auto at = text.find('<'); at != std::string::npos; at = text.find('<', at)) {
    text.replace(at, 1, "\\u003c");
  }
  return text;
}

constexpr const char* kStyle = R"(
:root{color-scheme:light dark;--ink:#1d2330;--dim:#5b6474;--line:#d9dee7;--bad:#9b2c00;--badback:#fdeee6;--odd:#8a5a00;--oddback:#fff3d6;--back:#fff;--head:#f3f5f9;--link:#0b57a4}
@media(prefers-color-scheme:dark){:root{--ink:#e6e9f0;--dim:#9aa4b5;--line:#343b49;--bad:#ff9d76;--badback:#3d241b;--odd:#ffd27a;--oddback:#3a2f17;--back:#14181f;--head:#1d232d;--link:#8ec2ff}}
body{font:14px/1.45 system-ui,sans-serif;margin:1.5rem;color:var(--ink);background:var(--back)}
h1{font-size:1.35rem;margin:0 0 .3rem}p{margin:.2rem 0 .8rem;color:var(--dim)}a{color:var(--link)}
form{display:flex;flex-wrap:wrap;gap:.6rem 1.2rem;align-items:center;margin:.6rem 0}
input[type=search]{font:inherit;padding:.25rem .5rem;min-width:14rem}select{font:inherit;padding:.2rem}
div.wide{overflow:auto;max-height:78vh;border:1px solid var(--line);border-radius:6px}
table{border-collapse:separate;border-spacing:0;font-variant-numeric:tabular-nums}
th,td{padding:.28rem .65rem;border-bottom:1px solid var(--line);text-align:right;white-space:nowrap}
thead th{position:sticky;top:0;background:var(--head);z-index:1;vertical-align:bottom}
th.t,td.t{text-align:left}td.t{max-width:26rem;white-space:normal;overflow-wrap:anywhere}td.t:first-child{white-space:nowrap}
tbody td:first-child{position:sticky;left:0;background:var(--back)}thead th:first-child{left:0;z-index:2}
th button{font:inherit;font-weight:600;border:0;background:none;color:inherit;cursor:pointer;padding:0;text-align:inherit}
th small{display:block;font-weight:400;color:var(--dim)}
th[aria-sort=ascending] button::after{content:" \25B2"}th[aria-sort=descending] button::after{content:" \25BC"}
td.bad{color:var(--bad);background:var(--badback);font-weight:600}td.odd{color:var(--odd);background:var(--oddback);font-weight:600}
nav{margin:.7rem 0;display:flex;gap:.8rem;align-items:center}nav button{font:inherit}
)";

constexpr const char* kScript = R"(
const data=JSON.parse(document.getElementById('data').textContent),perPage=200;
const shown=document.getElementById('shown'),search=document.getElementById('search');
const flagged=document.getElementById('flagged'),set=document.getElementById('set');
const head=document.querySelector('thead tr'),body=document.querySelector('tbody');
let sorted=-1,up=true,page=0;
const short=v=>{const n=Number(v);return v===''||v==='n/a'||Number.isNaN(n)||Number.isInteger(n)?v:
  String(Number(n.toPrecision(4)));};
const wanted=()=>data.columns.map((c,i)=>i).filter(i=>i<data.fixed||set.value==='all'||
  (set.value==='regions')===(data.columns[i][0]==='region')&&(set.value==='regions'||i<data.first));
const key=(r,c)=>r.cells[c]===undefined?'n/a':r.cells[c];
function rows(){
  const words=search.value.toLowerCase().split(/\s+/).filter(w=>w);
  let list=data.rows.filter(r=>(!flagged.checked||Object.keys(r.flags).length)&&
    words.every(w=>r.text.includes(w)));
  if(sorted>=0)list=list.slice().sort((a,b)=>{
    const x=key(a,sorted),y=key(b,sorted),m=Number(x),n=Number(y);
    const xn=x!==''&&!Number.isNaN(m),yn=y!==''&&!Number.isNaN(n);
    if(xn!==yn)return xn?-1:1;
    return (up?1:-1)*(xn?m-n:x.localeCompare(y));});
  return list;
}
function draw(){
  const columns=wanted(),list=rows(),pages=Math.max(1,Math.ceil(list.length/perPage));
  page=Math.min(page,pages-1);
  head.textContent='';
  for(const c of columns){
    const th=document.createElement('th'),button=document.createElement('button');
    th.scope='col';
    if(c<data.fixed)th.className='t';
    if(data.columns[c][0]){const step=document.createElement('small');step.textContent=data.columns[c][0];th.append(step);}
    button.textContent=data.columns[c][1].replaceAll('_',' ');
    button.onclick=()=>{up=sorted===c?!up:true;sorted=c;page=0;draw();};
    if(sorted===c)th.setAttribute('aria-sort',up?'ascending':'descending');
    th.append(button);head.append(th);
  }
  body.textContent='';
  for(const r of list.slice(page*perPage,(page+1)*perPage)){
    const tr=document.createElement('tr');
    for(const c of columns){
      const td=document.createElement('td'),value=key(r,c);
      if(c<data.fixed)td.className='t';
      if(c===0&&r.report){const a=document.createElement('a');a.href=r.report;a.textContent=value;td.append(a);}
      else td.textContent=short(value);
      if(r.flags[c]){td.classList.add(r.flags[c].startsWith('robust')?'odd':'bad');td.title=r.flags[c]+(value===td.textContent?'':' ('+value+')');}
      else if(c<data.fixed||value!==td.textContent)td.title=value;
      tr.append(td);
    }
    body.append(tr);
  }
  shown.textContent=list.length+' rows'+(pages>1?', page '+(page+1)+' of '+pages:'');
  document.getElementById('before').disabled=page===0;
  document.getElementById('after').disabled=page>=pages-1;
}
for(const r of data.rows)r.text=r.cells.slice(0,data.fixed).join(' ').toLowerCase();
search.oninput=flagged.onchange=set.onchange=()=>{page=0;draw();};
document.getElementById('before').onclick=()=>{--page;draw();};
document.getElementById('after').onclick=()=>{++page;draw();};
document.querySelector('form').onsubmit=e=>e.preventDefault();
draw();
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

std::vector<std::vector<StudyFlag>> flagsOf(const std::vector<StudyRow>& rows) {
  std::vector<std::vector<StudyFlag>> flags(rows.size());
  std::map<std::string, std::vector<std::size_t>> groups;
  for (std::size_t n = 0; n < rows.size(); ++n) {
    const StudyRow& row = rows[n];
    groups[row.region].push_back(n);
    if (row.state != "done")
      flags[n].push_back({"state", row.state.substr(0, row.state.find(':'))});
    const auto number = [&](const char* column) { return numberIn(row, column); };
    if (number("surface.euler_characteristic").value_or(2) != 2) {
      flags[n].push_back({"surface.euler_characteristic", "the white surface is no sphere"});
    }
    if (number("surface.self_intersections").value_or(0) > 0) {
      flags[n].push_back({"surface.self_intersections", "the surfaces meet themselves"});
    }
    if (number("unfold.self_intersections_final").value_or(0) >
        number("unfold.self_intersections_initial").value_or(0)) {
      flags[n].push_back({"unfold.self_intersections_final", "the patch meets itself"});
    }
  }
  for (const auto& [region, group] : groups) {
    for (const std::string& column : columnsOf(rows)) {
      const bool compared =
          isRegion(column) || std::find(std::begin(kComparedColumns), std::end(kComparedColumns),
                                        column) != std::end(kComparedColumns);
      if (compared) flagOutliers(rows, group, column, flags);
    }
  }
  return flags;
}

std::string tableText(const std::vector<StudyRow>& rows) {
  const std::vector<std::string> columns = columnsOf(rows);
  const auto flags = flagsOf(rows);
  const bool regions = std::any_of(rows.begin(), rows.end(),
                                   [](const StudyRow& row) { return !row.region.empty(); });
  std::string text = "participant_id\themisphere";
  if (regions) text += "\tregion";
  text += "\tstate\tflags";
  for (const auto& column : columns) text += "\t" + column;
  text += "\n";
  for (std::size_t n = 0; n < rows.size(); ++n) {
    const StudyRow& row = rows[n];
    text += row.participant + "\t" + row.hemisphere;
    if (regions) text += "\t" + (row.region.empty() ? "n/a" : row.region);
    std::string marks;
    for (const StudyFlag& flag : flags[n]) {
      marks += (marks.empty() ? "" : "; ") + flag.column + ": " + flag.reason;
    }
    text += "\t" + row.state + "\t" + (marks.empty() ? "n/a" : marks);
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
  const auto flags = flagsOf(rows);
  const bool regions = std::any_of(rows.begin(), rows.end(),
                                   [](const StudyRow& row) { return !row.region.empty(); });
  std::vector<std::string> fixed = {"participant", "hemisphere"};
  if (regions) fixed.emplace_back("region");
  fixed.emplace_back("state");
  Json data = Json::object();
  data["fixed"] = fixed.size();
  Json headings = Json::array();
  for (const std::string& name : fixed) headings.push_back({"", name});
  std::size_t first = fixed.size();
  for (const std::string& column : columns) {
    const auto dot = column.find('.');
    headings.push_back({column.substr(0, dot), column.substr(dot + 1)});
    first += std::find(std::begin(kFirstColumns), std::end(kFirstColumns), column) !=
             std::end(kFirstColumns);
  }
  data["first"] = first;  // columns of the short view
  data["columns"] = headings;
  data["rows"] = Json::array();
  for (std::size_t n = 0; n < rows.size(); ++n) {
    const StudyRow& row = rows[n];
    Json cells = Json::array({row.participant, row.hemisphere});
    if (regions) cells.push_back(row.region);
    cells.push_back(row.state);
    for (const auto& column : columns) {
      const auto value = row.values.find(column);
      cells.push_back(value == row.values.end() ? "n/a" : value->second);
    }
    Json marks = Json::object();
    for (const StudyFlag& flag : flags[n]) {
      const auto at = std::find(columns.begin(), columns.end(), flag.column);
      const auto index = at == columns.end() ? fixed.size() - 1  // state
                                             : fixed.size() + (at - columns.begin());
      marks[std::to_string(index)] = flag.reason;
    }
    Json entry = {{"cells", cells}, {"flags", marks}};
    if (!row.report.empty()) entry["report"] = row.report.generic_string();
    data["rows"].push_back(entry);
  }

  const auto done = std::count_if(rows.begin(), rows.end(),
                                  [](const StudyRow& row) { return row.state == "done"; });
  const auto marked =
      std::count_if(flags.begin(), flags.end(), [](const auto& row) { return !row.empty(); });
  const bool hasRegions = std::any_of(columns.begin(), columns.end(), isRegion);
  std::string page =
      "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><meta "
      "name=\"viewport\" content=\"width=device-width\"><title>" +
      escaped(title) + "</title><style>" + kStyle + "</style></head><body>\n<h1>" + escaped(title) +
      "</h1>\n<p>" + std::to_string(done) + " of " + std::to_string(rows.size()) +
      " hemispheres are done; " + std::to_string(marked) +
      " need a look. Red: failed, or not as a surface should be; yellow: far from the others "
      "(robust z above 3.5). A click on a heading sorts, a name leads to its report. The numbers "
      "in full are in <a href=\"study.tsv\">study.tsv</a>.</p>\n"
      "<noscript><p>Sorting needs JavaScript; study.tsv holds the same table.</p></noscript>\n"
      "<form><input type=\"search\" id=\"search\" placeholder=\"participant, side or state\" "
      "aria-label=\"filter rows\"><label><input type=\"checkbox\" id=\"flagged\"> only those that "
      "need a look</label><label>columns <select id=\"set\"><option value=\"quality\">quality"
      "</option>" +
      (hasRegions ? "<option value=\"regions\">thickness by region, mm</option>" : "") +
      "<option value=\"all\">all</option></select></label></form>\n"
      "<div class=\"wide\"><table><thead><tr></tr></thead><tbody></tbody></table></div>\n"
      "<nav><button id=\"before\">previous</button><span id=\"shown\"></span>"
      "<button id=\"after\">next</button></nav>\n<script type=\"application/json\" id=\"data\">" +
      scriptText(data) + "</script>\n<script>" + kScript + "</script>\n</body></html>\n";
  return page;
}

}  // namespace explica::study
