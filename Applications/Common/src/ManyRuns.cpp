// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Application/ManyRuns.h"

#include "Explica/Core/Errors.h"
#include "Explica/Core/Text.h"
#include "Explica/Core/WholeFile.h"
#include "Explica/Provenance/Digest.h"
#include "Explica/Provenance/Record.h"
#include "Explica/Study/Derivatives.h"

#include <set>

namespace explica::app {

std::string shareOfWork(const std::vector<std::string>& people,
                        const std::vector<std::string>& further) {
  if (people.empty()) return {};
  std::set<std::string> labels;
  for (const std::string& label : people) {
    labels.insert(label.starts_with("sub-") ? label.substr(4) : label);
  }
  std::string name;
  for (const std::string& label : labels) name += label + "_";
  for (const std::string& part : further) name += part + "_";
  return provenance::sha256Of(name).substr(0, 16);
}

provenance::Json givenOptions(const Context& context, const Declaration& declaration) {
  provenance::Json values = provenance::Json::object();
  for (const Parameter& parameter : declaration.parameters) {
    if (!parameter.positional && context.given(parameter.option.name)) {
      values[parameter.option.name] = provenance::valueOf(parameter.option);
    }
  }
  return values;
}

void sayProblem(Context& context, const std::string& name, const std::filesystem::path& folder,
                const std::string& why) {
  context.warn(name + ": " + why);
  if (context.given("dry-run")) return;
  std::filesystem::create_directories(folder);
  writeTextFile(
      folder / "problem.txt",
      provenance::printable(context.isPrivate() ? provenance::textWithoutFolders(why) : why) +
          "\n");
}

Termination endOfRuns(Context& context, const std::string& data, const char* what, std::size_t all,
                      const std::vector<std::string>& failed, Termination worst) {
  if (failed.empty()) return worst;
  const std::string count = std::to_string(failed.size());
  if (failed.size() == all) {
    throw InvalidInput(data + ": all " + count + " " + what +
                       " failed; each one's problem.txt says why");
  }
  context.warn(count + " of " + std::to_string(all) + " " + what + " failed: " + joined(failed));
  return reachedGoal(worst) ? Termination::Stalled : worst;
}

void dropSteps(Context& context, const std::string& run) {
  for (const char* step : study::kRunSteps) {
    for (const char* ending : {"", "-L", "-R"}) context.dropCommand(run + "/" + step + ending);
  }
}

void sayInterrupted(const std::filesystem::path& folder) {
  std::filesystem::create_directories(folder);
  writeTextFile(folder / "problem.txt", "interrupted\n");
}

void passFlagsOn(Context& context, const char* kind, const std::filesystem::path& part) {
  const provenance::Json summary = provenance::readJson(part / provenance::kSummaryName);
  for (provenance::Json flag : summary.value("flags", provenance::Json::array())) {
    flag[kind] = part.filename().string();
    context.flag(flag);
  }
}

}  // namespace explica::app
