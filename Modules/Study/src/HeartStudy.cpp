// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Study/HeartStudy.h"

#include "Explica/Core/Errors.h"
#include "Explica/Core/FileText.h"
#include "Explica/Core/Folders.h"
#include "Explica/Core/Text.h"
#include "Explica/Provenance/Json.h"
#include "HeartColumns.h"

#include <algorithm>
#include <iterator>
#include <set>

namespace explica::study {
namespace {

namespace fs = std::filesystem;
using provenance::Json;

bool isOther(const std::string& name) {
  static const std::set<std::string> others = {"code", "derivatives", "sourcedata", "stimuli"};
  return name.starts_with(".") || others.contains(name);
}

std::vector<fs::path> foldersIn(const fs::path& parent) {
  return foldersOf(parent, [](const std::string& name) { return !isOther(name); });
}

/// Files below a folder, in the order of their names.
std::vector<fs::path> filesBelow(const fs::path& folder) {
  std::vector<fs::path> files;
  auto entry = fs::recursive_directory_iterator(folder);
  for (; entry != fs::recursive_directory_iterator(); ++entry) {
    if (entry.depth() >= 4) entry.disable_recursion_pending();
    if (entry->is_regular_file()) files.push_back(entry->path());
  }
  std::ranges::sort(files);
  return files;
}

bool endsWith(const fs::path& file, const std::string& ending) {
  const std::string name = file.filename().string();
  return name.ends_with(ending + ".nii.gz") || name.ends_with(ending + ".nii");
}

std::vector<fs::path> labelsBelow(const fs::path& folder, const HeartLayout& layout) {
  const std::vector<fs::path> files = filesBelow(folder);
  for (const std::string& ending : layout.endings) {
    std::vector<fs::path> labels;
    std::ranges::copy_if(files, std::back_inserter(labels),
                         [&](const fs::path& file) { return endsWith(file, ending); });
    if (!labels.empty()) return labels;
  }
  return {};
}

/// The person's sessions, or the person.
std::vector<HeartSubject> sessionsOf(const fs::path& person, const HeartLayout& layout) {
  const std::string name = person.filename().string();
  std::vector<HeartSubject> found;
  for (const fs::path& session : foldersIn(person)) {
    const std::string part = session.filename().string();
    if (!part.starts_with("ses-")) continue;
    found.push_back({name + '_' + part, fs::path(name) / part, labelsBelow(session, layout)});
  }
  if (found.empty()) found.push_back({name, name, labelsBelow(person, layout)});
  return found;
}

bool isWanted(const std::string& person, const std::vector<std::string>& wanted) {
  return wanted.empty() || std::ranges::any_of(wanted, [&](const std::string& one) {
           return one == person || "sub-" + one == person;
         });
}

std::string cellOf(const Json& value) {
  if (value.is_null()) return "n/a";
  return value.is_string() ? value.get<std::string>() : provenance::textOf(value);
}

/// Keys of the heart's summary.json, in the order of the table.
constexpr HeartColumn kColumns[] = {
    {"cavity_volume_ed_ml", "mL", "volume of the left ventricle's cavity at end-diastole"},
    {"cavity_volume_es_ml", "mL", "volume of the left ventricle's cavity at end-systole"},
    {"stroke_volume_ml", "mL", "end-diastolic less end-systolic volume"},
    {"ejection_fraction_percent", "%", "stroke volume over end-diastolic volume"},
    {"mass_ed_g", "g", "volume of the wall at end-diastole times 1.05 g/mL"},
    {"thickness_mean_ed", "mm",
     "mean over the part of the wall included in the mean, at end-diastole"},
    {"thickness_mean_es", "mm", "the same at end-systole"},
    {"thickening_percent", "%", "end-systolic over end-diastolic mean thickness, less 1"},
    {"thickness_plain_ed", "mm", "as thickness_mean_ed, not corrected for oblique cuts"},
    {"axis_angle_deg", "degree", "tilt of the heart's axis to the slices' normal"},
    {"septum_deg", "degree", "angle over which the right ventricle touches the wall"},
    {"orientation", "", "what tells where segments begin"},
    {"labels", "", "convention of the labels"},
    {"measured", "", "by slice or in space"},
    {"frames", "", "frames read"},
    {"frames_with_wall", "", "frames that have a wall"},
    {"frame_ed", "", "number of the end-diastolic frame"},
    {"frame_es", "", "number of the end-systolic frame"}};

/// Thickness of the segments at both phases, and thickening.
void addSegments(StudyRow& row, const fs::path& file, const Json& summary) {
  if (!isThere(file)) return;
  const auto phase = [&](const char* key) {
    return summary.contains(key) ? cellOf(summary[key]) : std::string();
  };
  const std::string diastole = phase("frame_ed"), systole = phase("frame_es");
  for (TableRow& cells : tableRows(fileText(file))) {
    const std::string& segment = cells["segment"];
    if (segment.empty()) continue;
    const std::string name =
        "segment_" + std::string(segment.size() < 2 ? "0" : "") + segment + "_";
    if (cells["frame"] == diastole) row.values[name + "thickness_ed"] = cells["thickness"];
    if (cells["frame"] != systole) continue;
    row.values[name + "thickness_es"] = cells["thickness"];
    row.values[name + "thickening"] = cells["thickening"];
  }
}

StudyRow rowOf(const fs::path& out, const HeartSubject& subject) {
  StudyRow row;
  row.participant = subject.name;
  const fs::path folder = out / subject.folder / "heart";
  row.state = problemIn(folder);
  if (!row.state.empty()) return row;
  row.state = "not begun";
  if (!isThere(folder / "summary.json")) return row;
  try {
    const Json summary = provenance::readJson(folder / "summary.json");
    row.state = "done";
    for (const Json& flag : summary.value("flags", Json::array())) {
      if (!flag.value("accepted", false)) row.state = "implausible: " + cellOf(flag["message"]);
    }
    for (const HeartColumn& column : kColumns) {
      if (summary.contains(column.key)) row.values[column.key] = cellOf(summary[column.key]);
    }
    addSegments(row, folder / "segments.tsv", summary);
  } catch (const std::exception& fault) {  // a damaged file is a fact of the study, not its end
    row.state = std::string("failed: ") + fault.what();
  }
  if (isThere(folder / "bullseye.png")) row.thumbnail = subject.folder / "heart/bullseye.svg";
  return row;
}

std::vector<std::string> segmentColumns(const std::vector<StudyRow>& rows) {
  std::set<std::string> names;
  for (const StudyRow& row : rows) {
    for (const auto& [name, value] : row.values) {
      if (name.starts_with("segment_")) names.insert(name);
    }
  }
  return {names.begin(), names.end()};
}

}  // namespace

std::vector<HeartSubject> findHearts(const fs::path& dataset,
                                     const std::vector<std::string>& wanted,
                                     const HeartLayout& layout) {
  if (!isFolder(dataset)) throw InvalidInput(dataset.string() + ": is not a folder");
  std::vector<HeartSubject> subjects;
  std::set<std::string> people;
  for (const fs::path& person : foldersIn(dataset)) {
    const std::string name = person.filename().string();
    if (!isWanted(name, wanted)) continue;
    const bool participant = name.starts_with("sub-");
    for (HeartSubject& subject : sessionsOf(person, layout)) {
      // A participant without labels is a row that says so; another folder is not a person.
      if (subject.labels.empty() && !participant) continue;
      people.insert(name);
      subjects.push_back(std::move(subject));
    }
  }
  for (const std::string& one : wanted) {
    if (!people.count(one) && !people.count("sub-" + one)) {
      throw InvalidInput(dataset.string() + ": has nobody named " + one);
    }
  }
  if (subjects.empty()) {
    std::string endings;
    for (const std::string& ending : layout.endings) endings += " *" + ending + ".nii.gz";
    throw InvalidInput(dataset.string() + ": no folder in it holds label volumes; looked for" +
                       endings);
  }
  return subjects;
}

std::map<std::string, TableRow> aboutParticipants(const fs::path& dataset) {
  std::map<std::string, TableRow> about;
  if (!isThere(dataset / "participants.tsv")) return about;
  for (TableRow& row : tableRows(fileText(dataset / "participants.tsv"))) {
    const auto person = row.extract("participant_id");
    if (person.empty()) {
      throw InvalidInput((dataset / "participants.tsv").string() +
                         ": has no column participant_id, which BIDS asks for");
    }
    about[person.mapped()] = std::move(row);
  }
  return about;
}

std::vector<StudyRow> heartRows(const fs::path& out, const std::vector<HeartSubject>& subjects,
                                const std::map<std::string, TableRow>& about) {
  std::vector<StudyRow> rows;
  for (const HeartSubject& subject : subjects) {
    rows.push_back(rowOf(out, subject));
    std::map<std::string, std::string>& values = rows.back().values;
    const auto known = about.find(subject.folder.begin()->string());
    for (const auto& [name, value] : known == about.end() ? TableRow{} : known->second) {
      values[std::string(kAboutPrefix) + name] = value;
    }
    std::erase_if(values, [](const auto& value) { return value.second.empty(); });
  }
  return rows;
}

std::string heartTable(const std::vector<StudyRow>& rows) {
  const std::vector<std::string> about = aboutColumns(rows), segments = segmentColumns(rows);
  std::string text = "participant_id";
  for (const std::string& name : about) text += '\t' + cellText(name.substr(kAboutPrefix.size()));
  text += "\tstate";
  for (const HeartColumn& column : kColumns) text += std::string("\t") + column.key;
  for (const std::string& name : segments) text += '\t' + name;
  text += '\n';
  for (const StudyRow& row : rows) {
    text += cellText(row.participant);
    for (const std::string& name : about) text += '\t' + cellText(valueIn(row, name));
    text += '\t' + cellText(row.state);
    for (const HeartColumn& column : kColumns) text += '\t' + cellText(valueIn(row, column.key));
    for (const std::string& name : segments) text += '\t' + valueIn(row, name);
    text += '\n';
  }
  return text;
}

std::string heartColumns(const std::vector<StudyRow>& rows) {
  Json columns = Json::object();
  columns["state"] = {{"Description", "done, or what became of the run and why"}};
  for (const HeartColumn& column : kColumns) {
    columns[column.key] = {{"Description", column.meaning}};
    if (*column.unit != '\0') columns[column.key]["Units"] = column.unit;
  }
  for (const std::string& name : segmentColumns(rows)) {
    const bool percent = name.ends_with("thickening");
    columns[name] = {
        {"Description", "mean over columns of a segment of the American Heart Association's 17"},
        {"Units", percent ? "%" : "mm"}};
  }
  return provenance::textOf(columns, 2) + "\n";
}

}  // namespace explica::study
