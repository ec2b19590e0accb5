// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
// `explica --help`: the commands by task.  A new command is named in one of the groups.

#include "Explica/Core/Text.h"
#include "Parse.h"
#include "Wording.h"

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
std::string wordsOf(const std::vector<const Command*>& kinds) {
  return joined(kinds, ", ", [](const Command* kind) {
    return kind->name().substr(kind->name().find(' ') + 1);
  });
}

}  // namespace

std::string overviewText() {
  std::ostringstream out;
  out << "Explica measures layered tissue, such as the cortex or the wall of the heart, and "
         "unfolds it.\n\nUsage: explica COMMAND [arguments] [options]\n";
  for (const Task& task : kTasks) {
    out << '\n' << task.title << '\n';
    for (const std::string_view name : task.commands) {
      if (const Command* command = findCommand(name)) {
        row(out, command->name(), command->begin().declaration.synopsisText);
      } else if (const auto kinds = kindsOf(name); !kinds.empty()) {
        row(out, std::string(name) + " KIND", "generated data of these kinds: " + wordsOf(kinds));
      }
    }
  }
  out << '\n';
  wrap(out, "explica COMMAND --help says more, with an example.  " + exitCodesText());
  return out.str();
}

}  // namespace explica::app
