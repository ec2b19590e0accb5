// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Wording.h"

#include "Parse.h"

#include "Explica/Core/Text.h"

#include <algorithm>
#include <cctype>

namespace explica::app {

namespace {

/// A list option whose elements are given by repeating it.
bool repeats(const Parameter& parameter) {
  return parameter.option.isList && (parameter.file || parameter.option.isPoint());
}

}  // namespace

std::string placeholder(const Parameter& parameter) {
  const auto& option = parameter.option;
  if (option.isFlag()) return "";
  std::string word;
  if (parameter.file) {
    word = *parameter.file == FileKind::Folder ? "DIR" : "FILE";
  } else if (option.type == "choice") {
    word = joined(option.choices, "|");
  } else if (option.type == "point2") {
    word = "X,Y";
  } else if (option.type == "point3") {
    word = "X,Y,Z";
  } else if (option.unit == "mm") {
    word = "MM";
  } else if (option.unit == "s") {
    word = "S";
  } else if (option.type == "integer") {
    word = "N";
  } else if (option.type == "number") {
    word = "V";
  } else if (option.name == "out") {
    word = "DIR";
  } else if (option.name == "config" || option.name == "log") {
    word = "FILE";
  } else {
    word = "TEXT";
  }
  const bool commas = option.isList && !repeats(parameter) && option.type != "text";
  return word + (commas ? "[," + word + "...]" : "");
}

std::string leftColumn(const Parameter& parameter) {
  if (parameter.positional) return parameter.option.name;
  const std::string value = placeholder(parameter);
  return "--" + parameter.option.name + (value.empty() ? "" : " " + value);
}

std::string rightColumn(const Parameter& parameter) {
  const auto& option = parameter.option;
  std::string text = option.help;
  std::string aside;
  const auto append = [&aside](const std::string& part) {
    aside += (aside.empty() ? "" : "; ") + part;
  };
  if (parameter.file) append(std::string(nameOf(*parameter.file)));
  if (!option.unit.empty()) append(option.unit);
  if (const std::string range = option.range(); !range.empty()) append(range);
  if (parameter.required && !parameter.positional) append("required");
  if (!parameter.required && parameter.positional) append("may be left out");
  if (parameter.positional && option.isList) append("one or more");
  if (!parameter.positional && repeats(parameter)) append("may be repeated");
  if (option.isFlag()) {
    if (parameter.defaultText == "true")
      append("default on; --no-" + option.name + " to switch off");
  } else if (!parameter.defaultText.empty()) {
    append("default " + parameter.defaultText);
  }
  return text + (aside.empty() ? "" : " (" + aside + ")");
}

void wrap(std::ostringstream& out, const std::string& text, std::size_t indent,
          std::size_t column) {
  std::istringstream words(text);
  std::string word;
  std::size_t at = column;
  bool first = true;
  while (words >> word) {
    // Markdown takes a line that begins with an operator for an item of a list.
    if (!first && word.size() > 1 && at + 1 + word.size() > 96) {
      out << '\n' << std::string(indent, ' ');
      at = indent;
    } else if (!first) {
      out << ' ';
      ++at;
    }
    out << word;
    at += word.size();
    first = false;
  }
  out << '\n';
}

void row(std::ostringstream& out, const std::string& left, const std::string& right) {
  constexpr std::size_t kIndent = 30;  // columns
  out << "  " << left;
  std::size_t at = left.size() + 2;
  if (at + 2 > kIndent) {
    out << '\n';
    at = 0;
  }
  out << std::string(kIndent - at, ' ');
  wrap(out, right, kIndent, kIndent);
}

std::string usageLine(const Declaration& d) {
  std::string line = "explica " + d.name;
  for (const Parameter& p : d.parameters) {
    if (!p.positional) continue;
    std::string word = p.option.name;
    if (p.option.isList) word += "...";
    line += " " + (p.required ? word : "[" + word + "]");
  }
  for (const Parameter& p : d.parameters) {
    if (!p.positional && p.required) line += " " + leftColumn(p);
  }
  if (d.writesOutput && !d.fallbackOut) line += " --out DIR";
  return line + " [options]";
}

std::string replaced(std::string text, std::string_view from, std::string_view by) {
  for (std::size_t at = 0; (at = text.find(from, at)) != std::string::npos; at += by.size()) {
    text.replace(at, from.size(), by);
  }
  return text;
}

std::string upperCase(std::string text) {
  for (char& c : text) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return text;
}

std::vector<Section> sectionsOf(const std::vector<Parameter>& parameters,
                                const std::string& arguments) {
  std::vector<Section> sections = {{arguments, {}}};
  for (const Parameter& p : parameters) {
    const std::string& title = p.positional ? arguments : p.option.category;
    auto section = std::ranges::find(sections, title, &Section::title);
    if (section == sections.end()) section = sections.insert(section, Section{title, {}});
    section->rows.emplace_back(leftColumn(p), rightColumn(p));
  }
  if (sections.front().rows.empty()) sections.erase(sections.begin());
  return sections;
}

std::vector<Parameter> allParameters(const Declaration& declaration, CommonOptions& common) {
  std::vector<Parameter> all = declaration.parameters;
  for (auto& p : commonParameters(declaration, common)) all.push_back(std::move(p));
  return all;
}

std::vector<OutputSlot> allOutputs(const Declaration& d) {
  std::vector<OutputSlot> outputs = d.outputs;
  if (d.writesOutput) {
    outputs.push_back({"summary.json", FileKind::JsonFile, "the numbers", true});
    outputs.push_back({"provenance.json", FileKind::Record, "what ran on what, with hashes", true});
  }
  return outputs;
}

std::vector<std::pair<std::string, std::string>> stepsOf(const Declaration& d) {
  std::vector<std::pair<std::string, std::string>> steps;
  for (const Parameter& p : d.parameters) {
    const bool isNew = steps.empty() || steps.back().second != p.stepCommand;
    if (isNew && !p.stepCommand.empty()) steps.emplace_back(p.stepPrefix, p.stepCommand);
  }
  return steps;
}

const std::vector<std::pair<std::string, std::string>>& exitCodes() {
  static const std::vector<std::pair<std::string, std::string>> all = {
      {"0", "done"},
      {"1", "usage"},
      {"2", "bad input"},
      {"3", "a goal or check was missed (results written and marked)"},
      {"4", "environment (disk full, out of memory)"}};
  return all;
}

std::string exitCodesText() {
  return "Exit codes: " +
         joined(exitCodes(), ", ",
                [](const auto& code) { return code.first + " " + code.second; }) +
         ".";
}

}  // namespace explica::app
