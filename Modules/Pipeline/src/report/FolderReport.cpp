// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Pipeline/FolderReport.h"

#include "Explica/Core/Errors.h"
#include "Explica/Core/Folders.h"
#include "Explica/Core/Termination.h"
#include "ReportParts.h"

#include <algorithm>
#include <cctype>

namespace explica::pipeline {
namespace {

namespace fs = std::filesystem;

constexpr int kMostSlices = 30;  // of a direction, so that a page stays below some megabytes

/// A word as a shell takes it.
std::string quoted(const std::string& word) {
  const bool plain =
      !word.empty() && word.find_first_of(" \t\"'\\$&;()<>|*?{}") == std::string::npos;
  return plain ? word : "'" + word + "'";
}

/// Values of an option, as a command line has them: numbers of one array belong together.
std::string wordsOf(const std::string& option, const Json& value) {
  if (!value.is_array()) {
    if (value.is_boolean()) return value.get<bool>() ? " " + option : "";
    const std::string text =
        value.is_string() ? value.get<std::string>() : provenance::textOf(value);
    return (option.empty() ? " " : " " + option + " ") + quoted(text);
  }
  std::string words, numbers;
  for (const Json& one : value) {
    if (one.is_number()) {
      numbers += (numbers.empty() ? "" : ",") + provenance::textOf(one);
    } else {
      words += wordsOf(option, one);
    }
  }
  // An equals sign, for the first number may be negative.
  if (!numbers.empty()) words += " " + option + (option.empty() ? "" : "=") + numbers;
  return words;
}

/// The command line of a step: `explica run` gives its steps their options as one JSON object.
std::string commandLineOf(const Json& execution) {
  const Json argv = execution.value("argv", Json::array());
  std::string line;
  for (const Json& word : argv) {
    const std::string text = word.is_string() ? word.get<std::string>() : provenance::textOf(word);
    const Json options = text.starts_with("{") ? Json::parse(text, nullptr, false) : Json();
    if (!options.is_object()) {
      line += (line.empty() ? "" : " ") + text;
      continue;
    }
    std::string inputs, others;
    for (const auto& [key, value] : options.items()) {
      const bool isInput = !key.empty() && std::isupper(static_cast<unsigned char>(key[0])) != 0;
      (isInput ? inputs : others) += wordsOf(isInput ? "" : "--" + key, value);
    }
    line += inputs + others;
    if (!options.contains("out") && execution.contains("out") && execution["out"].is_string()) {
      line += " --out " + quoted(execution["out"].get<std::string>());
    }
  }
  return line;
}

report::ReportStep reportStep(const StepFolder& step) {
  report::ReportStep out;
  out.name = titleOf(step.name);
  const Json execution = step.record.value("execution", Json::object());
  out.seconds = execution.value("seconds", 0.0);
  out.commandLine = commandLineOf(execution);
  out.version = versionOf(step);
  // A doubted result is complete: its flags say what is wrong.
  const auto termination = step.record.value("termination", std::string("not-run"));
  const bool ended = reachedGoal(valueOf<Termination>(termination));
  if (step.record.value("exit_code", 0) != 0 && !ended) {
    out.state = report::StepState::StoppedEarly;
    out.message = "stopped: " + termination;
  }
  for (const auto& [key, value] : step.summary.items()) {
    const bool number = value.is_number() || value.is_boolean();
    if (number || (value.is_string() && key != "command"))
      out.numbers.emplace_back(inWords(key), readable(value));
  }
  const Json options = step.record.value("options", Json::object());
  for (const auto& [key, value] : options.items()) {
    const bool plain = value.is_string() || value.is_boolean() || value.is_null();
    out.options.emplace_back(key, plain ? readable(value) : provenance::textOf(value));
  }
  const Json warnings = step.record.value("warnings", Json::array());
  for (const Json& warning : warnings) out.warnings.push_back(readable(warning));
  return out;
}

/// The step as its record tells it, or as the run noted where there is no record of its success.
report::ReportStep reportStep(const StepNote& note, const std::vector<StepFolder>& steps) {
  const auto found =
      std::ranges::find_if(steps, [&](const StepFolder& s) { return s.name == note.name; });
  if (found != steps.end() && note.state != report::StepState::Failed) return reportStep(*found);
  // Without a record a step that ended well is missing.
  const bool lost = note.state == report::StepState::Done;
  report::ReportStep step;
  step.name = titleOf(note.name);
  step.message = note.message;
  step.state = lost ? report::StepState::Missing : note.state;
  return step;
}

void listSteps(ResultFolder& results) {
  auto& steps = results.content().steps;
  for (const StepNote& note : results.notes()) steps.push_back(reportStep(note, results.steps()));
  if (!results.notes().empty()) return;
  // A folder by itself may be called anything: its command says what it is.
  for (const StepFolder& step : results.steps()) {
    steps.push_back(reportStep(step));
    if (!step.command.empty()) steps.back().name = inWords(step.command);
  }
}

/// What a step has of its own to show, beside what the parts above show of all steps together.
void showStep(ResultFolder& results, const StepFolder& step, const std::vector<GivenMap>& maps,
              const FolderReportOptions& options) {
  if (step.command == "unfold") {
    results.attempt("Evolution", [&] { showUnfolding(results, step, maps); });
    chartUnfolding(results, step);
  }
  if (step.command == "sample") {
    results.attempt("Sampled maps", [&] { showSampled(results, step); });
    results.attempt("Profiles", [&] { showProfiles(results, step); });
  }
  if (step.command == "regions" && step.has("regions.tsv")) {
    results.attempt("Table of regions", [&] { tabulateRegions(results, step); });
  }
  if (step.command == "flatten") {
    results.attempt("Flat map", [&] { showFlat(results, step, maps); });
    return;
  }
  if (step.command == "inflate") {
    results.attempt("Evolution", [&] { showInflation(results, step); });
    chartUnfolding(results, step);
  }
  results.attempt("Where faces cross", [&] { showCrossings(results, step, options); });
  results.attempt("Pictures of " + titleOf(step.name), [&] { showOwnPictures(results, step); });
  if (step.has("frames.tsv")) {
    results.attempt("Curves of " + titleOf(step.name), [&] { chartBeat(results, step); });
  }
}

}  // namespace

std::string versionOf(const StepFolder& step) {
  if (!step.record.contains("software")) return {};
  const Json& software = step.record["software"];
  return "explica " + software.value("version", "") + ", commit " +
         software.value("commit", "").substr(0, 10);
}

report::ReportContent collectReport(const fs::path& folder, const FolderReportOptions& options,
                                    const Monitor& monitor) {
  if (options.slices < 1 || options.slices > kMostSlices) {
    throw InvalidInput("slices: must be between 1 and " + std::to_string(kMostSlices));
  }
  if (!isFolder(folder)) throw InvalidInput(folder.string() + ": no such folder");
  report::ReportContent content;
  content.title = fs::weakly_canonical(folder).filename().string();
  ResultFolder results(folder, monitor, content);
  listSteps(results);
  results.attempt("Tissues", [&] { showTissues(results, options); });
  monitor.progress(0.2, "report");
  const std::vector<GivenMap> maps = readGivenMaps(results, options.maps);
  results.attempt("Surfaces", [&] { showSurfaces(results, options, maps); });
  monitor.progress(0.5, "report");
  for (const StepFolder* step : results.stepsOf("thickness")) {
    if (!step->has("thickness.nii.gz")) continue;
    // Where there are surfaces, they show it: a reader finds one thickness, by one definition.
    if (!results.stepsOf("surface").empty()) continue;
    results.attempt("Thickness", [&] { chartThickness(results, *step); });
    results.attempt("Layers", [&] { showLayers(results, *step, options); });
  }
  for (const StepFolder& step : results.steps()) showStep(results, step, maps, options);
  results.attempt("Numbers", [&] { findNumbers(results); });
  results.attempt("Head", [&] { showHead(results); });
  flagSteps(results);
  monitor.progress(1, "report");
  return content;
}

std::optional<report::Picture> thumbnailOf(const report::ReportContent& content) {
  const report::Picture* large = nullptr;
  for (const report::ReportGlance& glance : content.glance) {
    if (!glance.views.empty()) large = &glance.views.back().second;
  }
  if (large == nullptr || large->width < 2 || large->height < 2) return {};
  report::Picture small(large->width / 2, large->height / 2);
  for (int y = 0; y < small.height; ++y) {
    for (int x = 0; x < small.width; ++x) {
      for (int c = 0; c < 3; ++c) {
        int sum = 0;
        for (int n = 0; n < 4; ++n) sum += large->pixel(2 * x + n % 2, 2 * y + n / 2)[c];
        small.pixel(x, y)[c] = static_cast<std::uint8_t>((sum + 2) / 4);
      }
    }
  }
  return small;
}

}  // namespace explica::pipeline
