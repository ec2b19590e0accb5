// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Core/Text.h"
#include "Parse.h"
#include "Wording.h"

namespace explica::app {
namespace {

std::string escapeCell(const std::string& text) {
  return replaced(text, "|", "\\|");
}

void add(std::ostringstream& out, const Section& section) {
  if (!section.rows.empty()) out << "\n| " << section.title << " | |\n|---|---|\n";
  for (const auto& [left, right] : section.rows) out << "| " << left << " | " << right << " |\n";
}

/// In the table's words: the left column as it is typed.
Section typed(Section section) {
  for (auto& [left, right] : section.rows) {
    left = "`" + escapeCell(left) + "`";
    right = escapeCell(right);
  }
  return section;
}

/// The page of a command, seen from the page of another one.
std::string pageOf(const std::string& command) {
  const std::string folder = command.substr(0, command.find(' '));
  return "../" + upperCase(folder.substr(0, 1)) + folder.substr(1) + "/README.md";
}

/// A key of summary.json, with what is expected of it.
std::string meaningOf(const Result& result) {
  std::string text = result.title;
  if (!result.unit.empty()) text += " (" + result.unit + ")";
  if (!result.meaning.empty()) text += ". " + result.meaning;
  for (const Limit& limit : result.limits) {
    text += " " + result.expectation(limit);
    if (limit.outside != Judgement::Good)
      text += ", otherwise " + std::string(nameOf(limit.outside));
    text += ".";
  }
  return text;
}

}  // namespace

std::string referencePage(const Declaration& d) {
  std::ostringstream out;
  out << "## explica " << d.name << "\n\n" << d.synopsisText << ".\n\n    " << usageLine(d) << "\n";
  if (!d.descriptionText.empty()) {
    out << '\n';
    wrap(out, d.descriptionText);
  }
  std::vector<Parameter> own = d.parameters;  // the steps' own pages list theirs
  std::erase_if(own, [](const Parameter& p) { return !p.stepCommand.empty(); });
  for (const Section& section : sectionsOf(own, "Argument")) add(out, typed(section));
  Section steps{"Options of the steps", {}}, files{"Writes", {}},
      keys{"Results in summary.json", {}};
  for (const auto& [prefix, command] : stepsOf(d)) {
    steps.rows.emplace_back("`--" + prefix + "NAME`",
                            "those of [explica " + command + "](" + pageOf(command) + ")");
  }
  for (const auto& slot : allOutputs(d)) {
    files.rows.emplace_back(slot.pattern, slot.help + " (" + std::string(nameOf(slot.kind)) + ")");
  }
  for (const Result& result : d.stageResults) keys.rows.emplace_back(result.key, meaningOf(result));
  add(out, steps);
  if (d.writesOutput) {
    add(out, typed(files));
    add(out, typed(keys));
  }
  for (const auto& example : d.examples) {
    out << "\n" << example.what << ":\n\n    " << example.commandLine << "\n";
  }
  if (!d.references.empty()) out << "\nReferences:\n\n";
  for (const auto& reference : d.references) out << "- " << reference << "\n";
  return out.str();
}

}  // namespace explica::app
