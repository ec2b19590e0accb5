// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Application/Execute.h"
#include "Explica/Core/Errors.h"
#include "Explica/Core/Folders.h"
#include "Explica/Provenance/Software.h"
#include "Explica/Provenance/Verify.h"
#include "StrangersRecord.h"

#include <filesystem>
#include <iostream>

namespace explica::app {
namespace {

using provenance::Json;
namespace fs = std::filesystem;

struct ReplaySettings {
  std::string record;
};

void declare(Declaration& d, ReplaySettings& s) {
  d.synopsis("repeat an earlier run from its record and compare the results")
      .description(
          R"(Takes command, options and inputs from the record. Prints one line per output: identical, DIFFERENT or MISSING. Ends with exit code 3 if any output is not identical. Files that hold times are compared by their numbers. The record may be a stranger's: what would write outside --out, or read other files than the inputs that it names, is refused.)")
      .example("explica replay shell/provenance.json --out again", "The same shell once more")
      .input("PROVENANCE", FileKind::Any, "a provenance.json, or the folder that holds it",
             s.record)
      .writesThrough();
}

/// Prints how each output compares; @return how many are not identical
int compare(const Json& before, const fs::path& beforeFolder, const fs::path& afterFolder,
            const std::string& prefix, int depth = 0) {
  constexpr int kDeepest = 4;  // steps within steps
  int different = 0;
  const auto say = [&](const char* word, const std::string& name) {
    if (std::string_view(word) != "identical") ++different;
    std::cout << word << "  " << provenance::printable(prefix + name) << "\n";
  };
  const Json after = provenance::readRecord(afterFolder / provenance::kRecordName);
  for (const Json& output : before["outputs"]) {
    const std::string name = output["path"];
    const fs::path path = afterFolder / name;
    if (!isThere(path)) {
      say("MISSING  ", name);
    } else if (name == provenance::kSummaryName) {
      say(before["results"] == after["results"] ? "identical" : "DIFFERENT", name);
    } else if (path.filename() == provenance::kRecordName && name != provenance::kRecordName &&
               depth < kDeepest && isThere(beforeFolder / name)) {
      // A step with a record of its own.
      different += compare(provenance::readRecord(beforeFolder / name),
                           (beforeFolder / name).parent_path(), path.parent_path(),
                           prefix + fs::path(name).parent_path().string() + "/", depth + 1);
    } else if (output.contains("sha256")) {
      say(provenance::digestOf(path).sha256 == output["sha256"] ? "identical" : "DIFFERENT", name);
    }
  }
  return different;
}

Termination run(Context& context, const ReplaySettings& s) {
  const fs::path recordPath = provenance::recordAt(s.record);
  const Json record = provenance::readRecord(recordPath);
  const std::string name = record["command"];
  const Command* command = findCommand(name);
  if (!command) {
    throw InvalidInput(recordPath.string() + ": explica " + name + " is not known to this version");
  }
  const auto& made = record["software"];
  const auto& here = provenance::software();
  if (made["version"] != here.version || made["commit"] != here.commit) {
    context.info("the record is by version " + made["version"].get<std::string>() + ", commit " +
                 made["commit"].get<std::string>().substr(0, 10) + "; this is " +
                 provenance::softwareText());
  }
  Invocation described = command->begin();
  requireConfined(described.declaration, recordPath);
  const Json values =
      confinedValues(context, described.declaration, record, recordPath, context.outputFolder());
  const Outcome outcome = context.runThrough(*command, values);
  if (outcome.record.empty()) return outcome.termination;
  if (!reachedGoal(outcome.termination) && context.monitor().shouldStop()) {
    context.warn("interrupted before all outputs were made: they are not compared");
    return outcome.termination;
  }
  const int different = compare(record, recordPath.parent_path(), outcome.record.parent_path(), "");
  std::cout.flush();
  if (different > 0) {
    context.warn(std::to_string(different) + " output(s) are not identical");
    return Termination::Stalled;
  }
  context.info("all outputs are identical");
  return Termination::Converged;
}

}  // namespace

Command replayCommand() {
  return makeCommand<ReplaySettings>("replay", declare, run);
}

}  // namespace explica::app
