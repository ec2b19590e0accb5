// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Application/Execute.h"
#include "Explica/Core/Errors.h"
#include "Explica/Provenance/Software.h"
#include "Explica/Provenance/Verify.h"

#include <filesystem>
#include <iostream>

namespace explica::app {
namespace {

using provenance::Json;
namespace fs = std::filesystem;

struct Settings {
  std::string record;
};

void declare(Declaration& d, Settings& s) {
  d.synopsis("run again what a record describes, and compare the results with it")
      .description(
          "Takes command, options and inputs from the record. Prints one line per output: "
          "identical, "
          "DIFFERENT or MISSING. Ends with exit code 3 if any output is not identical. Files that "
          "hold times are compared by their numbers.")
      .example("explica replay shell/provenance.json --out again", "The same shell once more")
      .input("PROVENANCE", FileKind::Any, "a provenance.json, or the folder that holds it",
             s.record)
      .writesThrough();
}

/// The command's arguments with every path replaced by where its file is now.
Json argumentsNow(const Json& record, const fs::path& recordPath, Context& context) {
  Json arguments = record["execution"]["arguments"];
  const Json& paths = record["execution"]["inputs"];
  const auto now = [&](const Json& given) -> Json {
    if (!given.is_string()) return given;
    for (std::size_t i = 0; i < paths.size(); ++i) {
      if (paths[i]["given"] != given) continue;
      const fs::path found = provenance::locateInput(record, i, recordPath);
      if (provenance::digestOf(found).sha256 != record["inputs"][i]["sha256"]) {
        context.warn(found.string() + " is not the file that was read then");
      }
      return found.string();
    }
    const fs::path relative = given.get<std::string>();
    const std::string directory = record["execution"].value("directory", "");
    std::error_code ignored;
    // A folder, or a file that was named but not read.
    if (!directory.empty() && fs::exists(fs::path(directory) / relative, ignored)) {
      return (fs::path(directory) / relative).string();
    }
    return given;
  };
  for (auto& [name, value] : arguments.items()) {
    if (value.is_array()) {
      for (auto& element : value) element = now(element);
    } else {
      value = now(value);
    }
  }
  return arguments;
}

/// Prints how each output compares; @return how many are not identical
int compare(const Json& before, const fs::path& beforeFolder, const fs::path& afterFolder,
            const std::string& prefix) {
  int different = 0;
  const auto say = [&](const char* word, const std::string& name) {
    if (std::string_view(word) != "identical") ++different;
    std::cout << word << "  " << prefix << name << "\n";
  };
  const Json after = provenance::readRecord(afterFolder / provenance::kRecordName);
  for (const Json& output : before["outputs"]) {
    const std::string name = output["path"];
    const fs::path path = afterFolder / name;
    std::error_code ignored;
    if (!fs::exists(path, ignored)) {
      say("MISSING  ", name);
    } else if (name == provenance::kSummaryName) {
      say(before["results"] == after["results"] ? "identical" : "DIFFERENT", name);
    } else if (path.filename() == provenance::kRecordName && fs::exists(beforeFolder / name)) {
      // A step with a record of its own.
      different +=
          compare(provenance::readRecord(beforeFolder / name), (beforeFolder / name).parent_path(),
                  path.parent_path(), prefix + fs::path(name).parent_path().string() + "/");
    } else if (output.contains("sha256")) {
      say(provenance::digestOf(path).sha256 == output["sha256"] ? "identical" : "DIFFERENT", name);
    }
  }
  return different;
}

Termination run(Context& context, const Settings& s) {
  fs::path recordPath = s.record;
  if (fs::is_directory(recordPath)) recordPath /= provenance::kRecordName;
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
  Json values = record["options"];
  values.update(argumentsNow(record, recordPath, context));
  const Outcome outcome = context.runThrough(*command, values);
  if (outcome.record.empty()) return outcome.termination;
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
  return makeCommand<Settings>("replay", declare, run);
}

}  // namespace explica::app
