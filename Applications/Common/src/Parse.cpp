// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Parse.h"

#include "Meeting.h"
#include "Wording.h"

#include "Explica/Core/Errors.h"
#include "Explica/Core/Text.h"

#include <CLI/CLI.hpp>

#include <algorithm>
#include <charconv>

namespace explica::app {
std::string dashed(const Parameter& parameter) {
  return parameter.positional ? parameter.option.name : "--" + parameter.option.name;
}

namespace {

/// Where CLI11 leaves the words of one parameter.
struct Words {
  Parameter* parameter = nullptr;
  std::vector<std::string> values;
  int flagCount = 0;
  CLI::Option* handle = nullptr;
};

/// ": files are given by --left, --right" of a command that takes none by its place; else nothing.
std::string optionsThatTakeFiles(const Declaration& declaration) {
  std::vector<std::string> names;
  for (const Parameter& p : declaration.parameters) {
    if (p.positional) return {};
    if (p.file && names.size() < 3) names.push_back("--" + p.option.name);
  }
  return names.empty() ? "" : ": files are given by " + joined(names, ", ");
}

/// `--viewpoint -10,2,3` would look like an option -1: binds a negative number to the option
/// before.
std::vector<std::string> bindNegativeNumbers(const std::vector<std::string>& words) {
  const auto startsNegative = [](const std::string& word) {
    if (word.size() < 2 || word[0] != '-') return false;
    const char next = word[1];
    return std::isdigit(static_cast<unsigned char>(next)) || next == '.' ||
           word.rfind("-inf", 0) == 0;
  };
  std::vector<std::string> bound;
  for (const auto& word : words) {
    const bool afterOption = !bound.empty() && bound.back().rfind("--", 0) == 0 &&
                             bound.back().size() > 2 && bound.back().find('=') == std::string::npos;
    if (afterOption && startsNegative(word)) {
      bound.back() += "=" + word;
    } else {
      bound.push_back(word);
    }
  }
  return bound;
}

/// A number, perhaps with a comma after it: what people type between spaces for a point.
bool looksLikeNumber(std::string word) {
  if (!word.empty() && word.back() == ',') word.pop_back();
  double value = 0;
  const char* end = word.data() + word.size();
  const auto parsed = std::from_chars(word.data(), end, value);
  return !word.empty() && parsed.ec == std::errc() && parsed.ptr == end;
}

/// `--center 0 0 19` for `--center 0,0,19`.
void refuseNumbersBetweenSpaces(const std::vector<Parameter*>& parameters,
                                const std::vector<std::string>& words) {
  for (std::size_t w = 0; w < words.size(); ++w) {
    const auto found = std::find_if(parameters.begin(), parameters.end(), [&](const Parameter* p) {
      return !p->positional && words[w] == "--" + p->option.name;
    });
    if (found == parameters.end() || (*found)->severalWords) continue;
    const std::string type = (*found)->option.type;
    const bool point = type == "point2" || type == "point3";
    const bool numbers = type == "integer" || type == "number";
    if (!point && !((*found)->option.isList && numbers)) continue;
    std::string joined;
    std::size_t count = 0;
    for (std::size_t n = w + 1; n < words.size() && looksLikeNumber(words[n]); ++n, ++count) {
      std::string number = words[n];
      if (number.back() == ',') number.pop_back();
      joined += (joined.empty() ? "" : ",") + number;
    }
    if (count > 1) {
      throw UsageError(words[w] + ": separate its numbers by commas, without spaces: " + words[w] +
                       " " + joined);
    }
  }
}

/// Whether --report may be asked for: not where pages are among the results already.
bool mayBeReported(const Declaration& declaration) {
  const bool ownPage =
      std::any_of(declaration.outputs.begin(), declaration.outputs.end(),
                  [](const OutputSlot& output) { return output.pattern == "report.html"; });
  return declaration.writesOutput && !declaration.writesInPlace && !declaration.handsOutputOn &&
         !ownPage;
}

}  // namespace

std::vector<Parameter> commonParameters(const Declaration& declaration, CommonOptions& common) {
  std::vector<Parameter> parameters;
  const Parameter* elsewhere = declaration.find("OUT_DIR");  // which other commands write into
  for (auto& option : provenance::listOptions(common)) {
    if (option.name == "out" && declaration.fallbackOut) continue;  // a positional: OUT_DIR
    const bool concernsOutput = option.name == "out" || option.name == "force" ||
                                option.name == "dry-run" || option.name == "private";
    const bool looksOnly = option.name == "dry-run" && elsewhere != nullptr && elsewhere->required;
    if (concernsOutput && !declaration.writesOutput && !looksOnly) continue;
    if (option.name == "accept" && !filesMeet(declaration)) continue;
    if (option.name == "report" && !mayBeReported(declaration)) continue;
    if (declaration.find(option.name) != nullptr) continue;  // a command's own
    Parameter parameter;
    parameter.option = std::move(option);
    parameter.option.category = "Common";
    parameters.push_back(std::move(parameter));
  }
  return parameters;
}

std::set<std::string> applyJson(std::vector<Parameter*> parameters, const provenance::Json& values,
                                const std::string& source) {
  if (!values.is_object()) throw UsageError(source + ": must hold one JSON object");
  const provenance::Json flat = provenance::flattenKeys(values);
  std::set<std::string> names;
  for (const auto& entry : flat.items()) {
    const std::string& key = entry.key();
    const provenance::Json& value = entry.value();
    const auto found = std::find_if(parameters.begin(), parameters.end(),
                                    [&](const Parameter* p) { return p->option.name == key; });
    if (found == parameters.end()) {
      std::vector<std::string> known;
      for (const Parameter* p : parameters) known.push_back(p->option.name);
      const std::string near = nearestWord(key, known);
      throw UsageError(source + ": unknown option '" + key + "'" +
                       (near.empty() ? "" : "; did you mean '" + near + "'?"));
    }
    try {
      provenance::setValue((*found)->option, value);
    } catch (const UsageError& error) {
      throw UsageError(source + ": " + error.what());
    }
    if (!value.is_null()) names.insert(key);
  }
  return names;
}

std::set<std::string> parseWords(Declaration& declaration, CommonOptions& common,
                                 const std::vector<std::string>& words) {
  std::vector<Parameter> shared = commonParameters(declaration, common);
  std::vector<Parameter*> all;
  for (Parameter& parameter : declaration.parameters) all.push_back(&parameter);
  for (Parameter& parameter : shared) all.push_back(&parameter);

  refuseNumbersBetweenSpaces(all, words);

  CLI::App parser;
  parser.set_help_flag();
  std::vector<Words> bindings(all.size());
  for (std::size_t i = 0; i < all.size(); ++i) {
    Words& binding = bindings[i];
    binding.parameter = all[i];
    const auto& option = all[i]->option;
    if (option.isFlag()) {
      std::string names = "--" + option.name;
      if (option.name.rfind("no-", 0) != 0) names += ",!--no-" + option.name;
      binding.handle = parser.add_flag(names, binding.flagCount);
      continue;
    }
    binding.handle = parser.add_option(dashed(*all[i]), binding.values);
    if (option.isList && (all[i]->positional || all[i]->severalWords)) {
      binding.handle->expected(1, 1 << 20);
    } else {
      binding.handle->expected(1)->allow_extra_args(false);
      binding.handle->multi_option_policy(option.isList ? CLI::MultiOptionPolicy::TakeAll
                                                        : CLI::MultiOptionPolicy::Throw);
    }
  }

  try {
    auto reversed = bindNegativeNumbers(words);
    std::reverse(reversed.begin(), reversed.end());
    parser.parse(reversed);
  } catch (const CLI::ExtrasError&) {
    std::vector<std::string> known;
    for (const Parameter* p : all) {
      if (!p->positional) known.push_back("--" + p->option.name);
    }
    const std::string extra = parser.remaining().empty() ? "" : parser.remaining().front();
    const std::string word = extra.substr(0, extra.find('='));
    if (word.rfind('-', 0) != 0) {
      throw UsageError("'" + extra + "' was not expected" + optionsThatTakeFiles(declaration));
    }
    if (word == "--out" && declaration.fallbackOut) {
      throw UsageError("--out is not an option of this command: OUT_DIR says where the results go");
    }
    const std::string near = nearestWord(word, known);
    throw UsageError("unknown option " + word +
                     (near.empty() ? "; see --help" : "; did you mean " + near + "?"));
  } catch (const CLI::ArgumentMismatch& error) {
    throw UsageError(std::string(error.what()) + " (give the option once, with one value)");
  } catch (const CLI::ParseError& error) {
    throw UsageError(error.what());
  }

  std::set<std::string> given;
  for (const Words& binding : bindings) {
    if (binding.parameter->option.name == "config" && !binding.values.empty()) {
      const std::string& path = binding.values.back();
      given = applyJson(all, provenance::readJson(path), path);
    }
  }
  for (Words& binding : bindings) {
    if (binding.handle->count() == 0) continue;
    auto& option = binding.parameter->option;
    if (option.isFlag()) {
      option.setText({binding.flagCount > 0 ? "true" : "false"});
    } else {
      option.setText(binding.values);
    }
    given.insert(option.name);
  }
  return given;
}

}  // namespace explica::app
