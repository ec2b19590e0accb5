// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "ReportParts.h"

#include <algorithm>

namespace explica::pipeline {
namespace {

/// The last three words of a path, which name a person and a file: "bert/mri/ribbon.mgz".
std::string endOf(const std::filesystem::path& path) {
  const std::filesystem::path folder = path.parent_path();
  return (folder.parent_path().filename() / folder.filename() / path.filename()).string();
}

/// Files that no step has made; the first few.
std::string inputsOf(const ResultFolder& results) {
  constexpr std::size_t kMost = 3;
  std::vector<std::string> names;
  for (const StepFolder& step : results.steps()) {
    const Json execution = step.record.value("execution", Json::object());
    for (const Json& input : execution.value("inputs", Json::array())) {
      if (input.contains("parent_record")) continue;
      const std::string name = endOf(input.value("given", ""));
      if (std::ranges::find(names, name) == names.end()) names.push_back(name);
    }
  }
  std::string words;
  for (std::size_t n = 0; n < std::min(kMost, names.size()); ++n) {
    words += (n == 0 ? "" : ", ") + names[n];
  }
  if (names.size() > kMost) words += " and " + std::to_string(names.size() - kMost) + " more";
  return words;
}

/// Where a patch was unfolded: its label or the point that it was chosen about.
std::string patchWords(const StepFolder& step) {
  const Json options = step.record.value("options", Json::object());
  const auto words = [&](const char* key) {
    return options.contains(key) && !options[key].is_null() ? readable(options[key]) : "";
  };
  const std::string centre = words("center"), radius = words("radius");
  if (centre.empty()) return words("label");
  return radius + " mm about (" + centre + ") mm" + step.sideWords();
}

}  // namespace

void showHead(ResultFolder& results) {
  report::ReportContent& content = results.content();
  const auto add = [&](const char* name, const std::string& value) {
    if (!value.empty()) content.facts.emplace_back(name, value);
  };
  add("Input", inputsOf(results));
  for (const StepFolder* step : results.stepsOf("unfold")) add("Patch", patchWords(*step));
  if (results.steps().empty()) return;
  const StepFolder& first = results.steps().front();
  const std::string started =
      first.record.value("execution", Json::object()).value("started", std::string());
  add("Date", started.substr(0, started.find('T')));
  add("Version", versionOf(first));
}

}  // namespace explica::pipeline
