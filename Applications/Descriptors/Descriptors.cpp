// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Application/Descriptors.h"
#include "Explica/Application/Command.h"
#include "Explica/Core/WholeFile.h"

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
  for (const Command& command : allCommands()) {
    writeTextFile(context.output("man/" + manPageName(command.name()) + ".1"),
                  manPageOf(command.begin().declaration));
  }
  writeTextFile(context.output("man/explica.1"), overviewManPage());
  writeTextFile(context.output("completion/explica.bash"), bashCompletion());
  writeTextFile(context.output("completion/_explica"), zshCompletion());
  context.result("commands", allCommands().size());
  return Termination::NotRun;
}

}  // namespace

Command descriptorsCommand() {
  return makeCommand<DescriptorsSettings>("descriptors", declare, run);
}

}  // namespace explica::app
