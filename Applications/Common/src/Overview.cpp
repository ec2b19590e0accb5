// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
// `explica --help`: the commands by task.  A new command is named in one of the groups.

#include "Explica/Application/Command.h"
#include "Parse.h"
#include "Wording.h"

#include <algorithm>
#include <array>
#include <sstream>

namespace explica::app {
namespace {

struct Task {
  std::string_view title;
  std::vector<std::string_view> commands;
};

const std::array kTasks = {
    Task{"Everything at once, from a T1, a FreeSurfer subject or a BIDS data set", {"run", "bids"}},
    Task{"From images and labels to surfaces and thickness",
         {"segment", "thickness", "surface", "repair"}},
    Task{"On surfaces",
         {"unfold", "flatten", "inflate", "sample", "smooth", "regions", "compare", "figure",
          "view", "cifti"}},
    Task{"Between surfaces, and many people",
         {"sphere", "register", "resample", "parcellate", "template", "longitudinal", "glm",
          "study check", "study participant", "study group", "study list", "study schema"}},
    Task{"Heart", {"heart", "study hearts"}},
    Task{"Theory in the plane, shapes, and phantoms of known measures",
         {"polygon", "embed", "phantom"}},
    Task{"Results: where they come from, and pages on them",
         {"report", "history", "verify", "replay", "descriptors"}},
};

/// "cortex, shell" of phantom cortex and phantom shell.
std::string kindsOf(std::string_view verb) {
  std::string kinds;
  for (const Command& command : allCommands()) {
    if (!command.name().starts_with(std::string(verb) + " ")) continue;
    kinds += (kinds.empty() ? "" : ", ") + command.name().substr(verb.size() + 1);
  }
  return kinds;
}

/// The commands that no task names.
std::vector<std::string_view> others() {
  std::vector<std::string_view> names;
  for (const Command& command : allCommands()) {
    const bool listed = std::any_of(kTasks.begin(), kTasks.end(), [&](const Task& task) {
      return std::any_of(task.commands.begin(), task.commands.end(), [&](std::string_view name) {
        return command.name() == name || command.name().starts_with(std::string(name) + " ");
      });
    });
    if (!listed) names.push_back(command.name());
  }
  return names;
}

void list(std::ostringstream& out, const Task& task) {
  out << '\n' << task.title << '\n';
  for (const std::string_view name : task.commands) {
    if (const Command* command = findCommand(name)) {
      row(out, command->name(), command->begin().declaration.synopsisText);
    } else if (const std::string kinds = kindsOf(name); !kinds.empty()) {
      row(out, std::string(name) + " KIND", "generated data of these kinds: " + kinds);
    }
  }
}

}  // namespace

std::string overviewText() {
  std::ostringstream out;
  out << "Explica measures layered tissue, such as the cortex or the wall of the heart, and "
         "unfolds it.\n\nUsage: explica COMMAND [arguments] [options]\n";
  for (const Task& task : kTasks) list(out, task);
  if (const auto left = others(); !left.empty()) list(out, {"Other", left});
  out << "\nexplica COMMAND --help says more, with an example.  Exit codes: 0 done, 1 usage, 2 bad "
         "input,\n3 ended before its goal or to be checked (results are there and marked), 4 "
         "environment.\n";
  return out.str();
}

}  // namespace explica::app
