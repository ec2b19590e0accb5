// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "ResultFolder.h"

#include "Explica/Core/Errors.h"
#include "Explica/Core/Folders.h"
#include "Explica/Core/Text.h"
#include "Explica/Provenance/Record.h"
#include "Explica/Provenance/Verify.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <utility>

namespace explica::pipeline {

namespace fs = std::filesystem;

std::optional<double> StepFolder::number(std::string_view key) const {
  const auto found = summary.find(std::string(key));
  if (found == summary.end() || !found->is_number()) return {};
  return found->get<double>();
}

std::string StepFolder::text(std::string_view key) const {
  const auto found = summary.find(std::string(key));
  return found != summary.end() && found->is_string() ? found->get<std::string>() : "";
}

std::string StepFolder::side() const {
  const Json options = record.value("options", Json::object());
  std::string said = text("structure") + text("hemisphere");
  if (said.empty() && options.contains("hemisphere") && options["hemisphere"].is_string()) {
    said = options["hemisphere"].get<std::string>();
  }
  const bool left = said.starts_with("CortexLeft") || said == "L" || said == "left";
  const bool right = said.starts_with("CortexRight") || said == "R" || said == "right";
  if (left != right) return left ? "left" : "right";
  // A run on both sides names the folders of its steps by side.
  const std::string ending = name.size() > 2 ? name.substr(name.size() - 2) : "";
  if (ending == "-L" || ending == "_L") return "left";
  if (ending == "-R" || ending == "_R") return "right";
  return "";
}

std::string StepFolder::sideWords() const {
  return side().empty() ? "" : ", " + side();
}

ResultFolder::ResultFolder(const fs::path& folder, const Monitor& monitor,
                           report::ReportContent& content)
    : monitor_(monitor), content_(content) {
  notes_ = readRunState(folder / kRunStateName);
  if (notes_.empty() && isThere(folder / provenance::kRecordName)) {
    add(folder, fs::weakly_canonical(folder).filename().string());
  }
  for (const StepNote& note : notes_) {
    if (isThere(folder / note.name / provenance::kRecordName)) {
      add(folder / note.name, note.name);
    }
  }
  if (steps_.empty() && notes_.empty()) {
    const fs::path record = folder / provenance::kRecordName;
    if (isThere(record)) static_cast<void>(provenance::readRecord(record));  // why it cannot be
    throw InvalidInput(folder.string() +
                       ": no command has written it (it holds no provenance.json); give the --out "
                       "folder of a command or run");
  }
}

std::vector<const StepFolder*> ResultFolder::stepsOf(std::string_view command) const {
  std::vector<const StepFolder*> found;
  for (const StepFolder& s : steps_) {
    if (s.command == command) found.push_back(&s);
  }
  return found;
}

const StepFolder* ResultFolder::beside(const StepFolder& step, std::string_view command) const {
  const auto all = stepsOf(command);
  for (const StepFolder* s : all) {
    if (s->side() == step.side()) return s;
  }
  return all.size() == 1 ? all.front() : nullptr;
}

void ResultFolder::attempt(const std::string& what, const std::function<void()>& part) {
  try {
    part();
  } catch (const Error& fault) {
    monitor_.warn("report: " + what + " left out: " + fault.what());
    content_.flags.push_back({report::FlagLevel::Notice, what + " left out:", fault.what()});
  } catch (const Json::exception& fault) {
    monitor_.warn("report: " + what + " left out: a record is not as this program writes it");
    content_.flags.push_back({report::FlagLevel::Notice,
                              what + " left out:", "a record is not as this program writes it"});
  }
}

void ResultFolder::add(const fs::path& folder, const std::string& name) {
  StepFolder step;
  step.name = name;
  step.folder = folder;
  attempt("Record of " + name, [&] {
    step.record = provenance::readRecord(folder / provenance::kRecordName);
    step.command = step.record.value("command", "");
    if (isThere(folder / provenance::kSummaryName)) {
      step.summary = provenance::readJson(folder / provenance::kSummaryName);
    }
    steps_.push_back(std::move(step));
  });
}

namespace {

/// Where an input lies that is still what the step read: as the record says, or beside the step's
/// folder, where a whole run was moved to.  None if something else lies there now; the place of the
/// record if nothing does.
std::optional<fs::path> unchangedInput(const StepFolder& step, std::size_t input) {
  const Json& entry = step.record["inputs"].at(input);
  const fs::path recorded =
      provenance::locateInput(step.record, input, step.folder / provenance::kRecordName);
  const fs::path beside = step.folder.parent_path();
  bool any = false;
  for (const fs::path& path :
       {recorded, beside / recorded.parent_path().filename() / recorded.filename(),
        beside / recorded.filename()}) {
    std::error_code ignored;
    if (!fs::is_regular_file(path, ignored)) continue;
    any = true;
    if (!entry.contains("sha256") || provenance::digestOf(path).sha256 == entry["sha256"]) {
      return path;
    }
  }
  return any ? std::nullopt : std::optional(recorded);
}

}  // namespace

std::vector<fs::path> inputsOf(const StepFolder& step, std::string_view role) {
  std::vector<fs::path> found;
  const Json inputs = step.record.value("inputs", Json::array());
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    if (inputs[i].value("role", "") != role) continue;
    if (auto path = unchangedInput(step, i)) found.push_back(std::move(*path));
  }
  return found;
}

std::optional<fs::path> inputOf(const StepFolder& step, std::string_view role) {
  const std::vector<fs::path> all = inputsOf(step, role);
  return all.empty() ? std::nullopt : std::optional(all.front());
}

std::vector<fs::path> filesOf(const StepFolder& step, std::string_view ending) {
  return entriesOf(step.folder, [&](const std::string& name) { return name.ends_with(ending); });
}

std::optional<io::VertexMap> mapNamed(const fs::path& file, Eigen::Index vertexCount,
                                      std::string_view name) {
  if (!isThere(file)) return {};
  for (io::VertexMap& map : io::readVertexMaps(file, vertexCount)) {
    if (map.name == name || name.empty()) return std::move(map);
  }
  return {};
}

std::string percent(double share) {
  return readable(100 * share) + " %";
}

std::string readable(const Json& value) {
  if (value.is_string()) return value.get<std::string>();
  if (value.is_boolean()) return value.get<bool>() ? "yes" : "no";
  if (value.is_number()) return readable(value.get<double>());
  if (value.is_null()) return "not set";
  if (!value.is_array()) return provenance::textOf(value);
  return joined(value, ", ", [](const Json& entry) { return readable(entry); });
}

std::string titleOf(std::string_view step) {
  constexpr std::array kSides = {std::pair{"-L", " (left)"}, std::pair{"-R", " (right)"}};
  for (const auto& [ending, side] : kSides) {
    if (step.size() > 2 && step.substr(step.size() - 2) == ending) {
      return inWords(step.substr(0, step.size() - 2)) + side;
    }
  }
  return inWords(step);
}

std::string inWords(std::string_view key) {
  std::string words(key);
  for (char& c : words) {
    if (c == '_') c = ' ';
  }
  if (!words.empty())
    words[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(words[0])));
  return words;
}

}  // namespace explica::pipeline
