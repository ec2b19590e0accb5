// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Run.h"

#include "Explica/Application/TimeKept.h"
#include "Explica/Core/Errors.h"
#include "Explica/Core/Folders.h"
#include "Explica/Core/Memory.h"
#include "Explica/Core/Parallel.h"
#include "Explica/Core/StopScope.h"
#include "Explica/IO/ItkFormats.h"
#include "Explica/Provenance/Doubts.h"
#include "Limits.h"
#include "RunState.h"
#include "Signals.h"

#include <sys/resource.h>

#include <Eigen/Core>

#include <algorithm>
#include <ctime>

namespace explica::app {
namespace {

namespace fs = std::filesystem;
using provenance::Json;

/// Result keys that start so are times: they differ between equal runs.
bool isTime(const std::string& key) {
  return key.rfind("seconds", 0) == 0;
}

/// ", such as FILE" by a file of that kind in the folder; empty if there is none.
std::string exampleIn(const fs::path& folder, FileKind kind) {
  const std::string ending = kind == FileKind::Surface       ? ".surf.gii"
                             : kind == FileKind::VertexData  ? ".shape.gii"
                             : kind == FileKind::VertexLabel ? ".label.gii"
                                                             : ".nii.gz";
  const auto found = entriesOf(folder, [&](const auto& name) { return name.ends_with(ending); });
  return found.empty() ? "" : ", such as " + found.front().string();
}

/// Hashes every file that a declared input names: a missing one is reported before any work.
void noteDeclaredInputs(Context& context, const Declaration& declaration) {
  for (const Parameter& parameter : declaration.parameters) {
    if (!parameter.file) continue;
    const Json value = provenance::valueOf(parameter.option);
    if (value.is_null()) continue;
    for (const auto& element : value.is_array() ? value : Json::array({value})) {
      const std::string path = element.get<std::string>();
      const bool mayBeFolder =
          *parameter.file == FileKind::Folder || *parameter.file == FileKind::Any;
      if (mayBeFolder && isFolder(path)) continue;
      if (*parameter.file == FileKind::Folder) {
        throw IOError(path +
                      (isThere(path) ? ": is a file; a folder is needed" : ": no such folder"));
      }
      if (isFolder(path)) {
        throw IOError(path + ": is a folder; a file is needed" + exampleIn(path, *parameter.file));
      }
      context.input(path, parameter.option.name);
    }
  }
}

/// What the user accepts, by the command's own option or by that of all commands.
std::vector<std::string> acceptedOf(const Run& run) {
  const Parameter* own = run.invocation.declaration.find("accept");
  if (!own) return run.common.accept;
  return provenance::valueOf(own->option).get<std::vector<std::string>>();
}

std::uint64_t peakMemory() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<std::uint64_t>(usage.ru_maxrss) * 1024;
}

double cpuSeconds() {
  return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

/// The values of a declaration: those of files apart, because paths may differ between equal runs.
void recordValues(const Declaration& declaration, const std::set<std::string>& given,
                  provenance::Record& record) {
  for (const Parameter& parameter : declaration.parameters) {
    const Json value = provenance::valueOf(parameter.option);
    if (given.count(parameter.option.name)) record.given.push_back(parameter.option.name);
    if (parameter.file || parameter.positional) {
      if (!value.is_null()) record.arguments[parameter.option.name] = value;
    }
    // The folder for the results, by position, is a path like --out.
    const bool isOut =
        parameter.positional && declaration.fallbackOut && value == *declaration.fallbackOut;
    if (!parameter.file && !isOut && !value.is_null()) {
      record.options[parameter.option.name] = value;
    }
  }
}

/// A sentence that names no input file gets those that were given: modules see values, not paths.
std::string withInputNames(const std::string& message, const provenance::Record& record,
                           const std::set<std::string>& given) {
  std::string names;
  for (const auto& input : record.inputs) {
    const std::string path = input.given.string();
    if (message.find(path) != std::string::npos) return message;
    if (!given.count(input.role)) continue;
    names += (names.empty() ? "" : ", ") + input.role + " is " + path;
  }
  return names.empty() ? message : message + " (" + names + ")";
}

/// The program, its words and its processors: what is known before anything is read.
provenance::Record beginRecord(const Run& run, const ThreadChoice& threads) {
  provenance::Record record;
  record.command = run.invocation.declaration.name;
  record.argv = run.argv;
  record.directory = fs::current_path();
  record.started = timeNow();
  record.threads = threads.count;
  record.threadsBecause = threads.because;
  record.withNames = !run.common.privateRecord;
  return record;
}

/// Warnings go to the record and to whoever listens, progress to the console; signals, limits and
/// the run around this one stop it.
Monitor monitorOf(Run& run, Console& console, provenance::Record& record, std::mutex& warnings) {
  Monitor monitor;
  monitor.onWarning = [&](const std::string& message) {
    const std::lock_guard<std::mutex> lock(warnings);
    if (std::ranges::count(record.warnings, message) > 0) return;  // of a file that is read twice
    record.warnings.push_back(message);
    if (run.parent) {
      run.parent->warn(run.name + message);  // it puts its own name before
    } else {
      console.warning(message);
    }
  };
  monitor.onProgress = [&](double fraction, std::string_view activity) {
    console.progress(fraction, run.prefix, activity);
  };
  monitor.stopWanted = [&] {
    return run.parent ? run.parent->shouldStop() : endWanted() || timeIsOver();
  };
  return monitor;
}

/// Where the results are gathered until they are whole; none if the command writes none itself.
void openFolder(Run& run, Context::State& state) {
  const Declaration& declaration = run.invocation.declaration;
  if (!declaration.writesOutput) return;
  if (!run.common.out && declaration.fallbackOut) run.common.out = *declaration.fallbackOut;
  if (!run.common.out) throw UsageError("--out is missing: the folder for the results");
  if (declaration.handsOutputOn) return;
  const bool reuse = declaration.reuse && *declaration.reuse;
  const OutputRules rules{
      run.common.force || reuse, run.common.force && !reuse,
      declaration.writesInPlace, run.common.dryRun,
      declaration.name,          declaration.share ? declaration.share() : std::string()};
  state.folder.emplace(*run.common.out, rules,
                       [&](const std::string& message) { state.monitor.warn(message); });
  std::error_code ignored;
  state.record.out = fs::absolute(*run.common.out, ignored);
  for (const Parameter& parameter : declaration.parameters) {
    if (!parameter.namesOutput) continue;
    const Json value = provenance::valueOf(parameter.option);
    if (value.is_string() && fs::path(value).is_absolute()) requirePlaceFor(value);
  }
}

/// How the command ended, as its exit code says it.
Outcome outcomeOf(Termination termination, const Context::State& state) {
  if (termination == Termination::NotRun) termination = Termination::Finished;
  Outcome outcome;
  outcome.termination = causeOf(termination);
  outcome.plausible = !state.doubtful();
  outcome.exitCode = reachedGoal(termination) && outcome.plausible ? kDone : kStoppedEarly;
  return outcome;
}

/// summary.json: the command's numbers, then what every command states.
Json summaryOf(const Context::State& state) {
  const provenance::Record& record = state.record;
  const Json reasons = state.reasonsInWords();
  Json summary = {{"command", record.command},
                  {"termination", nameOf(record.termination)},
                  {"verdict", state.verdict(reasons)},
                  {"reasons", reasons}};
  summary.update(state.summary);
  if (state.flags) {
    summary["plausible"] = state.plausible;
    summary["flags"] = *state.flags;
  }
  if (!summary.contains("seconds")) summary["seconds"] = record.seconds;
  summary["peak_memory_bytes"] = record.peakMemoryBytes;
  summary["warnings"] = record.warnings;
  return summary;
}

/// What may be compared between two runs: all but times, memory and what was said on the way.
void recordResults(const Json& summary, provenance::Record& record) {
  for (const auto& [key, value] : summary.items()) {
    if (isTime(key) || key == "peak_memory_bytes" || key == "warnings") continue;
    record.results[key] = value;
  }
}

void recordOutputs(Context::State& state) {
  const std::vector<std::string> files = state.folder->files();
  std::vector<fs::path> places;
  for (const auto& name : files) places.push_back(state.folder->place(name));
  std::vector<provenance::Digest> digests(files.size());
  parallelFor(files.size(), 1,
              [&](std::size_t f) { digests[f] = provenance::digestOf(places[f]); });
  for (std::size_t f = 0; f < files.size(); ++f) {
    const bool varies =
        std::find(state.varying.begin(), state.varying.end(), files[f]) != state.varying.end();
    state.record.outputs.push_back({files[f], digests[f], varies});
  }
  for (const auto& [name, path] : state.nestedRecords) {
    state.record.outputs.push_back({name, provenance::digestOf(path), true});
  }
}

/// Writes summary and record and lets the folder appear.
void publish(Context::State& state) {
  Json summary = summaryOf(state);
  recordResults(summary, state.record);
  if (!state.record.withNames) summary = provenance::withoutFolders(summary);
  provenance::writeJson(state.folder->place(provenance::kSummaryName), summary);
  state.varying.push_back(provenance::kSummaryName);
  recordOutputs(state);
  provenance::writeJson(state.folder->place(provenance::kRecordName), toJson(state.record));
  state.folder->publish(provenance::kRecordName);
}

void limitThreads(int count) {
  setThreadCount(count);
  Eigen::setNbThreads(count);
  fixBlocksOfProducts();
  io::setItkThreadCount(count);  // Embree runs on TBB and follows it
}

}  // namespace

Outcome execute(Run& run, Console& console) {
  const Declaration& declaration = run.invocation.declaration;
  const ThreadChoice threads = chooseThreads(run.common.threads);
  if (!run.parent) limitThreads(threads.count);  // of steps, too, which may run side by side

  Context::State state{.run = run, .console = console, .record = {}, .monitor = {}};
  Context context(state);
  provenance::Record& record = state.record;
  record = beginRecord(run, threads);
  const double cpuBegin = cpuSeconds();
  std::mutex warnings;
  state.monitor = monitorOf(run, console, record, warnings);

  state.meeting.emplace(declaration, run.given, acceptedOf(run));
  if (!declaration.parameters.empty()) context.doubt(provenance::kInputsChanged, 0);
  Termination termination = Termination::NotRun;
  try {
    const StopScope abandoned(&state.monitor);
    noteDeclaredInputs(context, declaration);
    recordValues(declaration, run.given, record);
    openFolder(run, state);
    termination = run.invocation.run(context);
  } catch (const DryRunEnds&) {
    return outcomeOf(Termination::NotRun, state);
  } catch (const Interrupted&) {
    console.endStep(run.prefix);
    Outcome outcome = outcomeOf(Termination::Interrupted, state);
    outcome.abandoned = true;
    outcome.plausible = true;  // nothing is left whose numbers could be doubted
    return outcome;
  } catch (const InvalidInput& error) {
    throw InvalidInput(withInputNames(error.what(), record, run.given));
  }
  console.endStep(run.prefix);
  Outcome outcome = outcomeOf(termination, state);
  if (run.common.dryRun) return outcome;
  if (!state.folder) return outcome;
  record.termination = outcome.termination;
  record.exitCode = outcome.exitCode;
  record.ended = timeNow();
  record.seconds = state.seconds();
  record.cpuSeconds = cpuSeconds() - cpuBegin;
  record.peakMemoryBytes = peakMemory();
  publish(state);
  outcome.record = fs::path(*run.common.out) / provenance::kRecordName;
  outcome.head = std::move(state.head);
  return outcome;
}

}  // namespace explica::app
