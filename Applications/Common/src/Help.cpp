// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Parse.h"

#include <algorithm>
#include <cmath>
#include <sstream>

namespace explica::app {
namespace {

using provenance::Json;

std::string upper(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  return text;
}

/// What stands for the value in help: "X,Y,Z", "MM", "hybrid|eulerian".
std::string placeholder(const Parameter& parameter) {
  const auto& option = parameter.option;
  if (option.isFlag()) return "";
  std::string word;
  if (parameter.file) {
    word = *parameter.file == FileKind::Folder ? "DIR" : "FILE";
  } else if (option.type() == "choice") {
    for (const auto& choice : option.choices()) word += (word.empty() ? "" : "|") + choice;
  } else if (option.type() == "point2") {
    word = "X,Y";
  } else if (option.type() == "point3") {
    word = "X,Y,Z";
  } else if (option.unit == "mm") {
    word = "MM";
  } else if (option.unit == "s") {
    word = "S";
  } else if (option.type() == "integer") {
    word = "N";
  } else if (option.type() == "number") {
    word = "V";
  } else if (option.name == "out") {
    word = "DIR";
  } else if (option.name == "config" || option.name == "log") {
    word = "FILE";
  } else {
    word = "TEXT";
  }
  const bool commas = option.isList() && !parameter.file && option.type() != "text";
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
  if (parameter.positional && option.isList()) append("one or more");
  if (!parameter.positional && option.isList() && parameter.file) append("may be repeated");
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
  constexpr std::size_t kWidth = 96;
  std::istringstream words(text);
  std::string word;
  std::size_t at = column;
  bool first = true;
  while (words >> word) {
    if (!first && at + 1 + word.size() > kWidth) {
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
  constexpr std::size_t kIndent = 30;
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
    if (p.option.isList()) word += "...";
    line += " " + (p.required ? word : "[" + word + "]");
  }
  for (const Parameter& p : d.parameters) {
    if (!p.positional && p.required) line += " " + leftColumn(p);
  }
  if (d.writesOutput) line += " --out DIR";
  return line + " [options]";
}

std::vector<std::string> categoriesOf(const std::vector<Parameter>& parameters) {
  std::vector<std::string> categories;
  for (const Parameter& p : parameters) {
    if (!p.positional &&
        std::find(categories.begin(), categories.end(), p.option.category) == categories.end()) {
      categories.push_back(p.option.category);
    }
  }
  return categories;
}

/// The declaration's parameters and the common ones.
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

std::string escapeCell(const std::string& text) {
  std::string escaped;
  for (const char c : text) {
    if (c == '|') escaped += '\\';
    escaped += c;
  }
  return escaped;
}

}  // namespace

std::string helpText(const Declaration& d) {
  std::ostringstream out;
  out << "explica " << d.name << ": " << d.synopsisText << "\n\nUsage: " << usageLine(d) << "\n";
  if (!d.descriptionText.empty()) {
    out << '\n';
    wrap(out, d.descriptionText, 0, 0);
  }
  bool heading = false;
  for (const Parameter& p : d.parameters) {
    if (!p.positional) continue;
    if (!heading) out << "\nArguments:\n";
    heading = true;
    row(out, leftColumn(p), rightColumn(p));
  }
  CommonOptions common;
  const auto all = allParameters(d, common);
  for (const auto& category : categoriesOf(all)) {
    out << '\n' << category << ":\n";
    for (const Parameter& p : all) {
      if (!p.positional && p.option.category == category) row(out, leftColumn(p), rightColumn(p));
    }
  }
  row(out, "--help", "this text");
  row(out, "--version", "version and commit");
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
  if (!d.references.empty()) {
    out << "\nReferences:\n";
    for (const auto& reference : d.references) {
      out << "  ";
      wrap(out, reference, 4, 2);
    }
  }
  out << "\nExit codes: 0 done, 1 usage, 2 bad input, 3 stopped before its goal (outputs written "
         "and marked),\n4 environment (disk full, out of memory).\n";
  return out.str();
}

Json describeJson(const Declaration& d) {
  Json json = Json::object();
  json["command"] = d.name;
  json["synopsis"] = d.synopsisText;
  json["description"] = d.descriptionText;
  json["usage"] = usageLine(d);
  json["references"] = d.references;
  json["examples"] = Json::array();
  for (const auto& e : d.examples) {
    json["examples"].push_back({{"command", e.commandLine}, {"what", e.what}});
  }
  CommonOptions common;
  json["parameters"] = Json::array();
  for (const Parameter& p : allParameters(d, common)) {
    Json entry = Json::object();
    entry["name"] = p.option.name;
    entry["positional"] = p.positional;
    entry["required"] = p.required;
    entry["type"] = p.option.type();
    entry["list"] = p.option.isList();
    entry["optional"] = p.option.isOptional();
    entry["unit"] = p.option.unit;
    const bool above = p.option.least == kAboveZero;
    entry["above"] = above ? Json(0) : Json(nullptr);
    entry["least"] = above || std::isinf(p.option.least) ? Json(nullptr) : Json(p.option.least);
    entry["range"] = p.option.range();
    entry["most"] = std::isinf(p.option.most) ? Json(nullptr) : Json(p.option.most);
    entry["category"] = p.option.category;
    entry["help"] = p.option.help;
    entry["file"] = p.file ? Json(nameOf(*p.file)) : Json(nullptr);
    entry["choices"] = p.option.choices();
    entry["default"] = p.positional ? Json(nullptr) : provenance::valueOf(p.option);
    entry["placeholder"] = p.positional ? upper(p.option.name) : placeholder(p);
    json["parameters"].push_back(entry);
  }
  json["writes_folder"] = d.writesOutput;
  json["outputs"] = Json::array();
  for (const auto& slot : allOutputs(d)) {
    json["outputs"].push_back({{"pattern", slot.pattern},
                               {"file", nameOf(slot.kind)},
                               {"help", slot.help},
                               {"varies", slot.varies}});
  }
  return json;
}

namespace {

/// The page of a command, seen from the page of another one.
std::string pageOf(const std::string& command) {
  std::string folder = command.substr(0, command.find(' '));
  folder[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(folder[0])));
  return "../" + folder + "/README.md";
}

/// The steps' options by their prefixes: each step's own page lists them.
void stepTable(std::ostringstream& out, const std::vector<Parameter>& parameters) {
  std::string last = "none yet";
  for (const Parameter& p : parameters) {
    if (p.stepCommand.empty() || p.stepCommand == last) continue;
    if (last == "none yet") out << "\n| Options of the steps | |\n|---|---|\n";
    last = p.stepCommand;
    out << "| `--" << p.stepPrefix << "NAME` | those of [explica " << last << "](" << pageOf(last)
        << ") |\n";
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
  stepTable(out, d.parameters);
  if (d.writesOutput) {
    out << "\n| Writes | |\n|---|---|\n";
    for (const auto& slot : allOutputs(d)) {
      out << "| `" << slot.pattern << "` | " << escapeCell(slot.help) << " (" << nameOf(slot.kind)
          << ") |\n";
    }
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
