// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Run.h"

#include "Explica/Core/Errors.h"
#include "Explica/Core/Memory.h"
#include "Explica/Core/Parallel.h"
#include "Explica/Core/StopScope.h"
#include "Explica/IO/ItkFormats.h"
#include "Explica/Provenance/Doubts.h"
#include "Explica/Provenance/Record.h"
#include "Explica/Provenance/Results.h"
#include "Explica/Provenance/Software.h"
#include "Explica/Provenance/Verify.h"
#include "JsonNumber.h"
#include "Meeting.h"
#include "OutputFolder.h"
#include "Parse.h"
#include "Signals.h"

#include <fnmatch.h>
#include <sys/resource.h>

#include <Eigen/Core>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <iostream>
#include <optional>

namespace explica::app {
namespace {

namespace fs = std::filesystem;
using provenance::Json;

/// Ends a dry run at the first step.
struct DryRunEnds {};

double secondsNow() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// Result keys that start so are times: they differ between equal runs.
bool isTime(const std::string& key) {
  return key.rfind("seconds", 0) == 0;
}

}  // namespace

struct Context::State {
  Run& run;
  Console& console;
  provenance::Record record;
  Json summary = Json::object();
  Monitor monitor;
  std::optional<OutputFolder> folder;
  std::vector<std::string> varying;  ///< names of outputs whose bytes may differ
  std::vector<std::pair<std::string, fs::path>> nestedRecords;
  std::optional<Json> flags;  ///< numbers outside of their limits; nothing if none was judged
  bool plausible = true;
  std::vector<std::pair<Judgement, std::string>> reasons;  ///< of results that are not good
  std::optional<Meeting> meeting = {};                     ///< the files read so far

  [[nodiscard]] bool doubtful() const {
    return !plausible || std::any_of(reasons.begin(), reasons.end(), [](const auto& reason) {
      return reason.first == Judgement::Doubt;
    });
  }
  /// What a step's summary says against its results is said of the whole, too.
  void adoptReasons(const std::string& step, const fs::path& recordPath) {
    const Json results = provenance::readRecord(recordPath)["results"];
    const bool doubtful = results.value("verdict", "") == "doubtful";
    for (const Json& reason : results.value("reasons", Json::array())) {
      reasons.emplace_back(doubtful ? Judgement::Doubt : Judgement::Look,
                           step + ": " + reason.get<std::string>());
    }
  }
  [[nodiscard]] const Declaration& declaration() const { return run.invocation.declaration; }
  void setResult(const std::string& key, Json value) { summary[key] = std::move(value); }
};

Context::Step::Step(Context& context, std::string name)
    : context_(context), entry_(context.state_->record.steps.size()), begin_(secondsNow()) {
  context.state_->console.detail(context.state_->run.prefix + name);
  context.state_->record.steps.push_back({std::move(name), 0, {}, Termination::NotRun});
}

Context::Step::~Step() {
  auto& entry = context_.state_->record.steps[entry_];
  entry.seconds = secondsNow() - begin_;
  if (entry.termination == Termination::NotRun) entry.termination = Termination::Finished;
  context_.state_->console.endProgress();
}

void Context::Step::iterations(int count) {
  context_.state_->record.steps[entry_].iterations = count;
}

void Context::Step::termination(Termination termination) {
  context_.state_->record.steps[entry_].termination = termination;
}

fs::path Context::input(const fs::path& path, std::string_view role) {
  provenance::InputFile file;
  file.role = role;
  file.given = path;
  file.digest = provenance::digestOf(path);
  std::error_code ignored;
  file.absolute = fs::absolute(path, ignored).lexically_normal();
  auto& inputs = state_->record.inputs;
  const bool known = std::any_of(inputs.begin(), inputs.end(), [&](const auto& other) {
    return other.absolute == file.absolute && other.role == file.role;
  });
  if (known) return path;
  const auto found = provenance::findRecordOf(path, file.digest);
  for (const std::string& sentence :
       state_->meeting->add(file.role, path, file.digest.sha256, found)) {
    doubt(provenance::kInputsContradict, 1, sentence + "; accepted");
  }
  if (found) {
    if (found->sameContent) {
      file.parent = provenance::Parent{found->record["id"],
                                       provenance::digestOf(found->path).sha256, found->path};
    } else {
      doubt(provenance::kInputsChanged, 1,
            path.string() + " was changed since " + found->path.string() + " recorded it");
    }
  }
  inputs.push_back(std::move(file));
  return path;
}

fs::path Context::output(const std::string& name) {
  if (state_->run.common.dryRun) throw DryRunEnds{};
  if (!state_->folder) throw std::logic_error("command writes no folder, yet asks for " + name);
  const auto& slots = state_->declaration().outputs;
  const auto slot = std::find_if(slots.begin(), slots.end(), [&](const OutputSlot& s) {
    return fnmatch(s.pattern.c_str(), name.c_str(), 0) == 0;
  });
  if (slot == slots.end()) throw std::logic_error("undeclared output " + name);
  if (slot->varies) state_->varying.push_back(name);
  return state_->folder->place(name);
}

fs::path Context::outputFolder() const {
  return state_->run.common.out ? fs::path(*state_->run.common.out) : fs::path();
}

Context::Step Context::step(std::string name) {
  if (state_->run.common.dryRun) throw DryRunEnds{};
  checkpoint();
  return Step(*this, std::move(name));
}

void Context::results(const Results& listed) {
  for (const Result& result : listed) {
    if (!state_->declaration().stageResults.find(result.key)) {
      throw std::logic_error("undeclared result " + result.key);
    }
    if (std::holds_alternative<std::monostate>(result.value)) continue;
    state_->setResult(result.key, provenance::valueOf(result.value));
    state_->record.meanings[result.key] = provenance::meaningOf(result);
    const Judgement judgement = result.judgement().value_or(Judgement::Good);
    if (judgement != Judgement::Good) state_->reasons.emplace_back(judgement, result.sentence());
  }
}

void Context::result(const std::string& key, double value) {
  state_->setResult(key, numberOrNull(value));
}
void Context::result(const std::string& key, int value) {
  state_->setResult(key, value);
}
void Context::result(const std::string& key, long value) {
  state_->setResult(key, value);
}
void Context::result(const std::string& key, long long value) {
  state_->setResult(key, value);
}
void Context::result(const std::string& key, std::size_t value) {
  state_->setResult(key, value);
}
void Context::result(const std::string& key, bool value) {
  state_->setResult(key, value);
}
void Context::result(const std::string& key, const std::string& value) {
  state_->setResult(key, value);
}
void Context::result(const std::string& key, const char* value) {
  state_->setResult(key, value);
}
void Context::result(const std::string& key, const std::vector<double>& values) {
  Json array = Json::array();
  for (const double value : values) array.push_back(numberOrNull(value));
  state_->setResult(key, array);
}
void Context::result(const std::string& key, const Json& value) {
  state_->setResult(key, value);
}

void Context::note(const std::string& key, const Json& value) {
  state_->record.notes[key] = value;
}

void Context::judged() {
  if (!state_->flags) state_->flags = Json::array();
}

void Context::flag(const Json& flag) {
  judged();
  for (const Json& known : *state_->flags) {
    if (known == flag) return;
  }
  state_->flags->push_back(flag);
  if (flag["accepted"].get<bool>()) {
    info("accepted: " + flag["message"].get<std::string>());
    return;
  }
  state_->plausible = false;
  if (flag.contains("step")) return;  // the step has said it
  warn(flag["message"].get<std::string>());
}

void Context::doubt(const char* key, std::size_t count, const std::string& sentence) {
  Json& number = state_->summary[key];
  number = number.is_null() ? count : number.get<std::size_t>() + count;
  if (count > 0 && !sentence.empty()) warn(sentence);
}

const Monitor& Context::monitor() const {
  return state_->monitor;
}

void Context::info(const std::string& message) {
  state_->console.info(state_->run.prefix + message);
}
void Context::detail(const std::string& message) {
  state_->console.detail(state_->run.prefix + message);
}
void Context::warn(const std::string& message) {
  state_->monitor.warn(message);
}

bool Context::given(std::string_view name) const {
  if (name == "dry-run") return state_->run.common.dryRun;  // of steps, too
  return state_->run.given.count(std::string(name)) > 0;
}
int Context::threads() const {
  return state_->record.threads;
}
bool Context::isPrivate() const {
  return state_->run.common.privateRecord;
}

namespace {

/// A run of `command` as a part of `outer`, its values taken from JSON.
Run nestedRun(const Command& command, const Json& options, const Run& outer,
              const Monitor& monitor) {
  Run nested;
  nested.invocation = command.begin();
  std::vector<Parameter*> parameters;
  for (Parameter& p : nested.invocation.declaration.parameters) parameters.push_back(&p);
  nested.given = applyJson(parameters, options, command.name());
  requireGiven(nested.invocation.declaration, nested.given);
  nested.common = outer.common;
  nested.argv = {"explica", command.name(), provenance::textOf(options)};
  nested.parent = &monitor;
  nested.limit = outer.limit;
  return nested;
}

/// Whether all files that a run names are there: what an earlier step would make is not.
bool filesExist(const Declaration& declaration) {
  for (const Parameter& parameter : declaration.parameters) {
    if (!parameter.file) continue;
    const Json value = provenance::valueOf(parameter.option);
    for (const Json& name : value.is_array() ? value : Json::array({value})) {
      std::error_code ignored;
      if (name.is_string() && !fs::exists(name.get<std::string>(), ignored)) return false;
    }
  }
  return true;
}

}  // namespace

Outcome Context::runCommand(const Command& command, const std::string& name, const Json& options) {
  if (!state_->folder || !state_->declaration().writesInPlace) {
    throw std::logic_error("runCommand: the command must be declared inPlace()");
  }
  Run nested = nestedRun(command, options, state_->run, state_->monitor);
  nested.common.out = (outputFolder() / name).string();
  nested.common.force = true;
  nested.name = name + ": ";
  nested.prefix = state_->run.prefix + nested.name;
  if (nested.common.dryRun) {
    const bool ready = filesExist(nested.invocation.declaration);
    return ready ? execute(nested, state_->console) : Outcome{};
  }
  Step timing = step(name);
  Outcome outcome = execute(nested, state_->console);
  timing.termination(outcome.termination);
  if (!outcome.record.empty()) {
    state_->nestedRecords.emplace_back(name + "/" + provenance::kRecordName, outcome.record);
    state_->adoptReasons(name, outcome.record);
  }
  return outcome;
}

Outcome Context::runApart(const Command& command, const fs::path& out, const Json& options) {
  Run nested = nestedRun(command, options, state_->run, state_->monitor);
  nested.common.out = out.string();
  nested.name = out.filename().string() + ": ";
  nested.prefix = state_->run.prefix + nested.name;
  Outcome outcome = execute(nested, state_->console);
  if (!outcome.record.empty()) state_->adoptReasons(out.filename().string(), outcome.record);
  return outcome;
}

std::optional<Outcome> Context::reuseCommand(const Command& command, const std::string& name,
                                             const Json& options) {
  if (state_->run.common.dryRun) return {};  // what would be done is checked
  const fs::path path = outputFolder() / name / provenance::kRecordName;
  std::error_code ignored;
  if (!fs::exists(path, ignored)) return {};
  const Run nested = nestedRun(command, options, state_->run, state_->monitor);
  try {
    const Json record = provenance::readRecord(path);
    const auto& here = provenance::software();
    const Json& made = record["software"];
    const auto ended = valueOf<Termination>(record["termination"].get<std::string>());
    if (record["command"] != command.name() || ended == Termination::Interrupted ||
        ended == Termination::MaxTime || made["version"] != here.version ||
        made["commit"] != here.commit) {
      return {};
    }
    std::multiset<std::string> wanted, found;
    for (const Parameter& parameter : nested.invocation.declaration.parameters) {
      const Json value = provenance::valueOf(parameter.option);
      if (!parameter.file) {
        if (record["options"].value(parameter.option.name, Json()) != value) return {};
        continue;
      }
      const Json& named = record["execution"]["arguments"];
      if (value.is_null() != named.value(parameter.option.name, Json()).is_null()) return {};
      if (value.is_null()) continue;
      for (const Json& input : record["inputs"]) {
        if (input["role"] == parameter.option.name) {
          found.insert(parameter.option.name + " " + input["sha256"].get<std::string>());
        }
      }
      for (const auto& element : value.is_array() ? value : Json::array({value})) {
        const std::string file = element.get<std::string>();
        if (fs::is_directory(file, ignored)) continue;
        wanted.insert(parameter.option.name + " " + provenance::digestOf(file).sha256);
      }
    }
    if (wanted != found || !provenance::verifyRecord(path).allSame()) return {};
    Outcome outcome;
    outcome.termination = ended;
    outcome.exitCode = record["exit_code"];
    outcome.plausible = record["results"].value("verdict", "") != "doubtful";
    outcome.record = path;
    state_->nestedRecords.emplace_back(name + "/" + provenance::kRecordName, path);
    state_->adoptReasons(name, path);
    return outcome;
  } catch (const Error&) {
    return {};  // a record or file that cannot be read proves nothing
  }
}

void Context::dropCommand(const std::string& name) {
  if (state_->run.common.dryRun) return;
  removeRecorded(outputFolder() / name);
  auto& records = state_->nestedRecords;
  std::erase_if(records, [&](const auto& entry) {
    return entry.first == name + "/" + provenance::kRecordName;
  });
}

Outcome Context::runThrough(const Command& command, const Json& options) {
  if (!state_->declaration().handsOutputOn) {
    throw std::logic_error("runThrough: the command must be declared writesThrough()");
  }
  Run nested = nestedRun(command, options, state_->run, state_->monitor);
  Outcome outcome = execute(nested, state_->console);
  if (outcome.abandoned) throw Interrupted{};
  return outcome;
}

namespace {

/// Hashes every file that a declared input names, so that a missing one is reported before any
/// work.
void noteDeclaredInputs(Context& context, const Declaration& declaration) {
  for (const Parameter& parameter : declaration.parameters) {
    if (!parameter.file) continue;
    const Json value = provenance::valueOf(parameter.option);
    if (value.is_null()) continue;
    for (const auto& element : value.is_array() ? value : Json::array({value})) {
      const std::string path = element.get<std::string>();
      const bool mayBeFolder =
          *parameter.file == FileKind::Folder || *parameter.file == FileKind::Any;
      std::error_code fault;
      if (mayBeFolder && fs::is_directory(path, fault)) continue;
      if (*parameter.file == FileKind::Folder) {
        throw IOError(path + (fs::exists(path, fault) ? ": is a file; a folder is needed"
                                                      : ": no such folder"));
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
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_utime.tv_sec + usage.ru_stime.tv_sec) +
         1e-6 * static_cast<double>(usage.ru_utime.tv_usec + usage.ru_stime.tv_usec);
}

/// The values of a declaration: those of files apart, because paths may differ between equal runs.
void recordValues(const Declaration& declaration, provenance::Record& record) {
  for (const Parameter& parameter : declaration.parameters) {
    const Json value = provenance::valueOf(parameter.option);
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

/// A sentence that names no input file gets those named that were given: modules see values, not
/// paths.
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
    record.warnings.push_back(message);
    if (run.parent) {
      run.parent->warn(run.name + message);  // it puts its own name before
    } else {
      console.warning(message);
    }
  };
  monitor.onProgress = [&](double fraction, std::string_view activity) {
    console.progress(fraction, run.prefix + std::string(activity));
  };
  monitor.stopWanted = [&] {
    return run.parent ? run.parent->shouldStop()
                      : endWanted() || (run.limit && run.limit->passed());
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
Outcome outcomeOf(Termination termination, const Run& run, const Context::State& state) {
  if (termination == Termination::NotRun) termination = Termination::Finished;
  if (termination == Termination::Interrupted && !signalled() && run.limit && run.limit->passed()) {
    termination = Termination::MaxTime;
  }
  Outcome outcome;
  outcome.termination = termination;
  outcome.plausible = !state.doubtful();
  outcome.exitCode = reachedGoal(termination) && outcome.plausible ? kDone : kStoppedEarly;
  return outcome;
}

/// Why the verdict is not "right", in sentences.
Json reasonsOf(const Context::State& state) {
  Json reasons = Json::array();
  if (!reachedGoal(state.record.termination)) {
    reasons.push_back("stopped before its goal: " + std::string(nameOf(state.record.termination)));
  }
  for (const auto& [judgement, sentence] : state.reasons) reasons.push_back(sentence);
  for (const Json& flag : state.flags.value_or(Json::array())) {
    if (!flag.contains("step")) reasons.push_back(flag["message"]);  // else the step's own reason
  }
  for (const provenance::Doubt& doubt : provenance::kDoubts) {
    const auto count = state.summary.value(doubt.key, std::size_t{0});
    if (count > 0) {
      reasons.push_back(std::string(doubt.what) + ": " + std::to_string(count) + " " +
                        doubt.meaning);
    }
  }
  return reasons;
}

/// "right", "look", "doubtful" or "stopped": the worst of what can be said.
const char* verdictOf(const Context::State& state, const Json& reasons) {
  if (!reachedGoal(state.record.termination)) return "stopped";
  if (state.doubtful()) return "doubtful";
  return reasons.empty() ? "right" : "look";
}

/// summary.json: the command's numbers, then what every command states.
Json summaryOf(const Context::State& state) {
  const provenance::Record& record = state.record;
  const Json reasons = reasonsOf(state);
  Json summary = {{"command", record.command},
                  {"termination", nameOf(record.termination)},
                  {"verdict", verdictOf(state, reasons)},
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

}  // namespace

Outcome execute(Run& run, Console& console) {
  const Declaration& declaration = run.invocation.declaration;
  const ThreadChoice threads = chooseThreads(run.common.threads);
  setThreadCount(threads.count);
  Eigen::setNbThreads(threads.count);
  fixBlocksOfProducts();
  io::setItkThreadCount(threads.count);  // Embree runs on TBB and follows it

  Context::State state{run, console, {}, Json::object(), {}, {}, {}, {}, {}, true, {}};
  Context context(state);
  provenance::Record& record = state.record;
  record = beginRecord(run, threads);
  const double begin = secondsNow();
  const double cpuBegin = cpuSeconds();
  std::mutex warnings;
  state.monitor = monitorOf(run, console, record, warnings);

  state.meeting.emplace(declaration, run.given, acceptedOf(run));
  if (!declaration.parameters.empty()) context.doubt(provenance::kInputsChanged, 0);
  Termination termination = Termination::NotRun;
  try {
    const StopScope abandoned(&state.monitor);
    noteDeclaredInputs(context, declaration);
    recordValues(declaration, record);
    openFolder(run, state);
    termination = run.invocation.run(context);
  } catch (const DryRunEnds&) {
    return outcomeOf(Termination::NotRun, run, state);
  } catch (const Interrupted&) {
    console.endProgress();
    Outcome outcome = outcomeOf(Termination::Interrupted, run, state);
    outcome.abandoned = true;
    return outcome;
  } catch (const InvalidInput& error) {
    throw InvalidInput(withInputNames(error.what(), record, run.given));
  }
  console.endProgress();
  Outcome outcome = outcomeOf(termination, run, state);
  if (run.common.dryRun) return outcome;
  if (!state.folder) return outcome;
  record.termination = outcome.termination;
  record.exitCode = outcome.exitCode;
  record.ended = timeNow();
  record.seconds = secondsNow() - begin;
  record.cpuSeconds = cpuSeconds() - cpuBegin;
  record.peakMemoryBytes = peakMemory();
  publish(state);
  outcome.record = fs::path(*run.common.out) / provenance::kRecordName;
  return outcome;
}

}  // namespace explica::app
