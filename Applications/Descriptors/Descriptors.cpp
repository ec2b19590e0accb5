// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Application/Descriptors.h"
#include "Explica/Application/Command.h"
#include "Explica/Core/WholeFile.h"
#include "Explica/Provenance/Software.h"

#include <algorithm>

namespace explica::app {
namespace {

struct DescriptorsSettings {};

void declare(Declaration& d, DescriptorsSettings&) {
  d.synopsis("descriptions of every command for shells and man")
      .description(
          "All files are generated from the commands' own declarations, the same that parse the "
          "command line, so they cannot disagree with it.")
      .example("explica descriptors --out descriptors", "Completion and manual pages")
      .output("completion/explica.bash", FileKind::Any, "completion for bash")
      .output("completion/_explica", FileKind::Any, "completion for zsh")
      .output("man/explica*.1", FileKind::Any, "manual pages");
}

Termination run(Context& context, const DescriptorsSettings&) {
  const std::string& version = provenance::software().version;
  const Json commands = describeAllCommands();
  for (const Json& command : commands) {
    std::string name = "explica-" + command["command"].get<std::string>();
    std::replace(name.begin(), name.end(), ' ', '-');
    writeTextFile(context.output("man/" + name + ".1"), manPageOf(command, version));
  }
  writeTextFile(context.output("man/explica.1"), overviewManPageOf(commands, version));
  writeTextFile(context.output("completion/explica.bash"), bashCompletionOf(commands));
  writeTextFile(context.output("completion/_explica"), zshCompletionOf(commands));
  context.result("commands", commands.size());
  return Termination::NotRun;
}

}  // namespace

Command descriptorsCommand() {
  return makeCommand<DescriptorsSettings>("descriptors", declare, run);
}

}  // namespace explica::app
