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

void title(std::ostringstream& out, const Declaration& d) {
  out << "explica " << d.name << ": " << d.synopsisText << "\n";
}

void arguments(std::ostringstream& out, const Declaration& d) {
  bool heading = false;
  for (const Parameter& p : d.parameters) {
    if (!p.positional) continue;
    if (!heading) out << "\nArguments:\n";
    heading = true;
    row(out, leftColumn(p), rightColumn(p));
  }
}

std::size_t optionCount(const std::vector<Parameter>& parameters) {
  return static_cast<std::size_t>(std::count_if(parameters.begin(), parameters.end(),
                                                [](const Parameter& p) { return !p.positional; }));
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

void exampleLines(std::ostringstream& out, const std::string& lines) {
  out << "\nExample, works as pasted into an empty folder:\n";
  std::istringstream text(lines);
  for (std::string line; std::getline(text, line);) out << "  " << line << '\n';
}

}  // namespace

bool shownAtFirst(const Declaration& d, const Parameter& p) {
  if (p.positional || p.required || p.option.name == "out") return true;
  const FirstHelp* first = firstHelpOf(d.name);
  if (first != nullptr && !first->options.empty()) {
    const auto& named = first->options;
    return std::find(named.begin(), named.end(), p.option.name) != named.end();
  }
  return d.find(p.option.name) != nullptr && optionCount(d.parameters) <= kFewOptions;
}

std::string firstHelpText(const Declaration& d) {
  std::ostringstream out;
  title(out, d);
  const FirstHelp* first = firstHelpOf(d.name);
  out << "\nUsage: " << usageLine(d) << "\n";
  arguments(out, d);
  CommonOptions common;
  const auto all = allParameters(d, common);
  if (const std::string files = filesOf(d); !files.empty()) {
    out << "\nWrites ";
    wrap(out, files, 7, 7);
  }
  out << "\nOptions that most people need:\n";
  for (const Parameter& p : all) {
    if (!p.positional && shownAtFirst(d, p)) row(out, leftColumn(p), rightColumn(p));
  }
  row(out, "--help-all",
      "all " + std::to_string(optionCount(all)) +
          " options, what each file written is, references, exit codes");
  if (const auto steps = stepsOf(d); !steps.empty()) {
    out << "\nOptions of the steps, with a prefix:\n";
    for (const auto& step : steps) {
      row(out, "--" + step.prefix + "NAME", "those of explica " + step.command);
    }
  }
  if (first != nullptr) exampleLines(out, first->example());
  return out.str();
}

std::string helpText(const Declaration& d) {
  std::ostringstream out;
  title(out, d);
  out << "\nUsage: " << usageLine(d) << "\n";
  if (!d.descriptionText.empty()) {
    out << '\n';
    wrap(out, d.descriptionText, 0, 0);
  }
  arguments(out, d);
  CommonOptions common;
  const auto all = allParameters(d, common);
  for (const auto& category : categoriesOf(all)) {
    out << '\n' << category << ":\n";
    for (const Parameter& p : all) {
      if (!p.positional && p.option.category == category) row(out, leftColumn(p), rightColumn(p));
    }
  }
  row(out, "--help", "the options that most people need, and an example");
  row(out, "--help-all", "this text");
  row(out, "--version", "version, commit, and what it was built with");
  if (d.writesOutput) {
    out << "\nWrites into --out:\n";
    for (const auto& slot : allOutputs(d)) row(out, slot.pattern, slot.help);
  }
  if (!d.examples.empty()) {
    out << "\nExamples:\n";
    for (const auto& example : d.examples) {
      out << "  " << example.commandLine << "\n      ";
      wrap(out, example.what, 6, 6);
    }
  }
  if (const FirstHelp* first = firstHelpOf(d.name)) exampleLines(out, first->example());
  if (!d.references.empty()) {
    out << "\nReferences:\n";
    for (const auto& reference : d.references) {
      out << "  ";
      wrap(out, reference, 4, 2);
    }
  }
  out << "\nExit codes: 0 done, 1 usage, 2 bad input, 3 a goal or check was missed (results "
         "written and\nmarked), 4 environment (disk full, out of memory).\n";
  return out.str();
}

}  // namespace explica::app
