// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "FirstHelp.h"
#include "Parse.h"
#include "Wording.h"

#include <algorithm>

namespace explica::app {
namespace {

/// A command without a row that has no more options than this shows them all.
constexpr std::size_t kFewOptions = 12;

void begin(std::ostringstream& out, const Declaration& d) {
  out << "explica " << d.name << ": " << d.synopsisText << "\n\nUsage: " << usageLine(d) << "\n";
}

void add(std::ostringstream& out, const Section& section) {
  out << '\n' << section.title << ":\n";
  for (const auto& [left, right] : section.rows) row(out, left, right);
}

std::size_t optionCount(const std::vector<Parameter>& parameters) {
  return static_cast<std::size_t>(std::ranges::count(parameters, false, &Parameter::positional));
}

/// The first files that it writes, by name.
std::string filesOf(const Declaration& d) {
  constexpr std::size_t kNamed = 6;  // options named before "..."
  std::string names;
  for (std::size_t f = 0; f < std::min(kNamed, d.outputs.size()); ++f) {
    names += (f ? ", " : "") + d.outputs[f].pattern;
  }
  return names + (d.outputs.size() > kNamed ? ", ..." : "");
}

void addExample(std::ostringstream& out, const Declaration& d) {
  const FirstHelp* first = firstHelpOf(d.name);
  if (first == nullptr) return;
  out << "\nExample, works as pasted into an empty folder:\n";
  std::istringstream text(first->example());
  for (std::string line; std::getline(text, line);) out << "  " << line << '\n';
}

}  // namespace

bool shownAtFirst(const Declaration& d, const Parameter& p) {
  if (p.positional || p.required || p.option.name == "out") return true;
  const FirstHelp* first = firstHelpOf(d.name);
  if (first != nullptr && !first->options.empty()) {
    return std::ranges::find(first->options, p.option.name) != first->options.end();
  }
  return d.find(p.option.name) != nullptr && optionCount(d.parameters) <= kFewOptions;
}

std::string firstHelpText(const Declaration& d) {
  CommonOptions common;
  const auto all = allParameters(d, common);
  std::ostringstream out;
  begin(out, d);
  Section options{"Options that most people need", {}};
  for (const Parameter& p : all) {
    if (!p.positional && shownAtFirst(d, p)) {
      options.rows.emplace_back(leftColumn(p), rightColumn(p));
    }
  }
  options.rows.emplace_back("--help-all",
                            "all " + std::to_string(optionCount(all)) +
                                " options, what each file written is, references, exit codes");
  const auto sections = sectionsOf(all);
  if (sections.front().title == "Arguments") add(out, sections.front());
  if (const std::string files = filesOf(d); !files.empty()) {
    out << "\nWrites ";
    wrap(out, files, 7, 7);
  }
  add(out, options);
  Section steps{"Options of the steps, with a prefix", {}};
  for (const auto& [prefix, command] : stepsOf(d)) {
    steps.rows.emplace_back("--" + prefix + "NAME", "those of explica " + command);
  }
  if (!steps.rows.empty()) add(out, steps);
  addExample(out, d);
  return out.str();
}

std::string helpText(const Declaration& d) {
  CommonOptions common;
  std::ostringstream out;
  begin(out, d);
  if (!d.descriptionText.empty()) {
    out << '\n';
    wrap(out, d.descriptionText);
  }
  for (const Section& section : sectionsOf(allParameters(d, common))) add(out, section);
  row(out, "--help", "the options that most people need, and an example");
  row(out, "--help-all", "this text");
  row(out, "--version", "version, commit, and what it was built with");
  Section files{"Writes into --out", {}};
  for (const auto& slot : allOutputs(d)) files.rows.emplace_back(slot.pattern, slot.help);
  if (d.writesOutput) add(out, files);
  if (!d.examples.empty()) out << "\nExamples:\n";
  for (const auto& example : d.examples) {
    out << "  " << example.commandLine << "\n      ";
    wrap(out, example.what, 6, 6);
  }
  addExample(out, d);
  if (!d.references.empty()) out << "\nReferences:\n";
  for (const auto& reference : d.references) {
    out << "  ";
    wrap(out, reference, 4, 2);
  }
  out << '\n';
  wrap(out, exitCodesText());
  return out.str();
}

}  // namespace explica::app
