// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
// Commands that a command runs as its steps.

#include "Explica/Core/Errors.h"
#include "Explica/Core/Folders.h"
#include "Explica/Core/StopScope.h"
#include "Explica/Provenance/Software.h"
#include "Explica/Provenance/Verify.h"
#include "Parse.h"
#include "RunState.h"

#include <set>

namespace explica::app {

namespace fs = std::filesystem;
using provenance::Json;

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
  return nested;
}

/// Whether all files that a run names are there: what an earlier step would make is not.
bool filesExist(const Declaration& declaration) {
  for (const Parameter& parameter : declaration.parameters) {
    if (!parameter.file) continue;
    const Json value = provenance::valueOf(parameter.option);
    for (const Json& name : value.is_array() ? value : Json::array({value})) {
      if (name.is_string() && !isThere(name.get<std::string>())) return false;
    }
  }
  return true;
}

}  // namespace

Outcome Context::runCommand(const Command& command, const std::string& name, const Json& options) {
  if (!state_->declaration().writesInPlace) {
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
  if (!isThere(path)) return {};
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
        if (isFolder(file)) continue;
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

}  // namespace explica::app
