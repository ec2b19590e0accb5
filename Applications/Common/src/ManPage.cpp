// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Application/Command.h"
#include "Explica/Application/Descriptors.h"
#include "Explica/Provenance/Software.h"
#include "Wording.h"

namespace explica::app {
namespace {

std::string roff(const std::string& text) {
  const bool isRequest = text.starts_with('.') || text.starts_with('\'');
  return (isRequest ? "\\&" : "") + replaced(replaced(text, "\\", "\\e"), "-", "\\-");
}

std::string beginning(const std::string& name, const std::string& synopsis) {
  return ".TH " + roff(upperCase(name)) + " 1 \"\" \"Explica " +
         roff(provenance::software().version) + "\" \"User Commands\"\n.ad l\n.SH NAME\n" +
         roff(name) + " \\- " + roff(synopsis) + "\n";
}

std::string item(const std::string& term, const std::string& meaning) {
  // A list of choices may break after each of them.
  return ".TP\n.B " + replaced(roff(term), "|", "|\\:") + "\n" + roff(meaning) + "\n";
}

std::string textOf(const Section& section) {
  std::string text = ".SH \"" + roff(upperCase(section.title)) + "\"\n";
  for (const auto& [left, right] : section.rows) text += item(left, right);
  return text;
}

}  // namespace

std::string manPageName(const std::string& command) {
  return "explica-" + replaced(command, " ", "-");
}

std::string manPageOf(const Declaration& d) {
  CommonOptions common;
  std::string text = beginning(manPageName(d.name), d.synopsisText) + ".SH SYNOPSIS\n.B " +
                     roff(usageLine(d)) + "\n";
  if (!d.descriptionText.empty()) text += ".SH DESCRIPTION\n" + roff(d.descriptionText) + "\n";
  for (const Section& section : sectionsOf(allParameters(d, common))) text += textOf(section);
  Section files{"Files", {}}, examples{"Examples", {}};
  for (const auto& slot : allOutputs(d)) files.rows.emplace_back(slot.pattern, slot.help);
  for (const auto& e : d.examples) examples.rows.emplace_back(e.commandLine, e.what);
  if (d.writesOutput) text += textOf(files);
  text += textOf({"Exit status", exitCodes()});
  if (!d.examples.empty()) text += textOf(examples);
  if (!d.references.empty()) {
    text += ".SH REFERENCES\n" + joined(d.references, "\n.PP\n", roff) + "\n";
  }
  return text;
}

std::string overviewManPage() {
  Section commands{"Commands", {}};
  for (const Command& command : allCommands()) {
    commands.rows.emplace_back(manPageName(command.name()) + "(1)",
                               command.begin().declaration.synopsisText);
  }
  return beginning("explica",
                   "measures layered tissue such as cortex or the heart wall, and unfolds it") +
         ".SH SYNOPSIS\n.B explica\n.I COMMAND\n[arguments] [options]\n" + textOf(commands) +
         textOf({"Exit status", exitCodes()});
}

}  // namespace explica::app
