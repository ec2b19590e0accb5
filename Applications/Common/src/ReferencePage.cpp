// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Parse.h"
#include "Wording.h"

namespace explica::app {
namespace {

std::string escapeCell(const std::string& text) {
  std::string escaped;
  for (const char c : text) {
    if (c == '|') escaped += '\\';
    escaped += c;
  }
  return escaped;
}

/// The page of a command, seen from the page of another one.
std::string pageOf(const std::string& command) {
  std::string folder = command.substr(0, command.find(' '));
  folder[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(folder[0])));
  return "../" + folder + "/README.md";
}

/// The steps' options by their prefixes: each step's own page lists them.
void stepTable(std::ostringstream& out, const Declaration& d) {
  const auto steps = stepsOf(d);
  if (!steps.empty()) out << "\n| Options of the steps | |\n|---|---|\n";
  for (const auto& step : steps) {
    out << "| `--" << step.prefix << "NAME` | those of [explica " << step.command << "]("
        << pageOf(step.command) << ") |\n";
  }
}

/// The keys of summary.json, with what is expected of them.
void resultTable(std::ostringstream& out, const Results& results) {
  if (results.begin() == results.end()) return;
  out << "\n| Results in summary.json | |\n|---|---|\n";
  for (const Result& result : results) {
    out << "| `" << escapeCell(result.key) << "` | " << escapeCell(result.title);
    if (!result.unit.empty()) out << " (" << result.unit << ")";
    if (!result.meaning.empty()) out << ". " << escapeCell(result.meaning);
    for (const Limit& limit : result.limits) {
      out << " " << escapeCell(result.expectation(limit));
      if (limit.outside != Judgement::Good) out << ", otherwise " << nameOf(limit.outside);
      out << ".";
    }
    out << " |\n";
  }
}

}  // namespace

std::string referencePage(const Declaration& d) {
  std::ostringstream out;
  out << "## explica " << d.name << "\n\n" << d.synopsisText << ".\n\n    " << usageLine(d) << "\n";
  if (!d.descriptionText.empty()) {
    out << '\n';
    wrap(out, d.descriptionText, 0, 0);
  }
  const auto table = [&](const std::string& title, const std::vector<Parameter>& parameters,
                         const auto& wanted) {
    bool heading = false;
    for (const Parameter& p : parameters) {
      if (!wanted(p)) continue;
      if (!heading) out << "\n| " << title << " | |\n|---|---|\n";
      heading = true;
      out << "| `" << escapeCell(leftColumn(p)) << "` | " << escapeCell(rightColumn(p)) << " |\n";
    }
  };
  table("Argument", d.parameters, [](const Parameter& p) { return p.positional; });
  for (const auto& category : categoriesOf(d.parameters)) {
    table(category, d.parameters, [&](const Parameter& p) {
      return !p.positional && p.stepCommand.empty() && p.option.category == category;
    });
  }
  stepTable(out, d);
  if (d.writesOutput) {
    out << "\n| Writes | |\n|---|---|\n";
    for (const auto& slot : allOutputs(d)) {
      out << "| `" << slot.pattern << "` | " << escapeCell(slot.help) << " (" << nameOf(slot.kind)
          << ") |\n";
    }
    resultTable(out, d.stageResults);
  }
  for (const auto& example : d.examples) {
    out << "\n" << example.what << ":\n\n    " << example.commandLine << "\n";
  }
  if (!d.references.empty()) {
    out << "\nReferences:\n\n";
    for (const auto& reference : d.references) out << "- " << reference << "\n";
  }
  return out.str();
}

}  // namespace explica::app
