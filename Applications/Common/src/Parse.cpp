// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Parse.h"

#include "Meeting.h"
#include "Renamed.h"
#include "Wording.h"

#include "Explica/Core/Errors.h"

#include <CLI/CLI.hpp>

#include <algorithm>
#include <charconv>
#include <map>
#include <numeric>

namespace explica::app {
namespace {

/// Where CLI11 leaves the words of one parameter.
struct Words {
  Parameter* parameter = nullptr;
  std::vector<std::string> values;
  int flagCount = 0;
  CLI::Option* handle = nullptr;
};

std::string dashed(const Parameter& parameter) {
  return parameter.positional ? parameter.option.name : "--" + parameter.option.name;
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
    const std::string type = (*found)->option.type();
    const bool point = type == "point2" || type == "point3";
    const bool numbers = type == "integer" || type == "number";
    if (!point && !((*found)->option.isList() && numbers)) continue;
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

/// nowCalled() of words with their dashes.
std::string renamedWord(const std::string& word, std::vector<std::string> known) {
  for (std::string& name : known) name.erase(0, 2);
  const std::string now = nowCalled(word.substr(std::min(word.size(), std::size_t{2})), known);
  return now.empty() ? "" : "--" + now;
}

/// Words of other programs for what an option does here.
const std::map<std::string, std::vector<std::string>> kSynonyms = {
    {"--side", {"--hemisphere"}},
    {"--jobs", {"--threads"}},
    {"--nthreads", {"--threads"}},
    {"--n-threads", {"--threads"}},
    {"--openmp", {"--threads"}},
    {"--overwrite", {"--force"}},
    {"--clobber", {"--force"}},
    {"--output", {"--out"}},
    {"--subject", {"--participant-label"}},
    {"--subjects", {"--participant-label"}},
    {"--annot", {"--labels", "--parcellation", "--regions", "--atlas"}},
    {"--overlay", {"--map"}},
    {"--size", {"--radius"}},
    {"--steps-max", {"--max-iterations"}},
    {"--iterations", {"--max-iterations"}},
    {"--timeout", {"--max-time"}},
    {"--memory", {"--max-memory"}}};

/// The candidate that the word abbreviates or means; empty if there is none.
std::string meantBy(const std::string& word, const std::vector<std::string>& candidates) {
  constexpr std::size_t kTelling = 5;  // "--" and three letters
  std::string shortest;
  for (const auto& candidate : candidates) {
    if (word.size() < kTelling || !candidate.starts_with(word)) continue;
    if (shortest.empty() || candidate.size() < shortest.size()) shortest = candidate;
  }
  if (!shortest.empty()) return shortest;
  const auto synonyms = kSynonyms.find(word);
  if (synonyms == kSynonyms.end()) return {};
  for (const auto& synonym : synonyms->second) {
    if (std::find(candidates.begin(), candidates.end(), synonym) != candidates.end()) {
      return synonym;
    }
  }
  return {};
}

}  // namespace

std::string nearestWord(const std::string& word, const std::vector<std::string>& candidates) {
  std::string best = meantBy(word, candidates);
  if (!best.empty()) return best;
  std::size_t bestDistance = word.size() / 3 + 2;
  for (const auto& candidate : candidates) {
    std::vector<std::size_t> row(candidate.size() + 1);
    std::iota(row.begin(), row.end(), 0);
    for (std::size_t i = 1; i <= word.size(); ++i) {
      std::size_t diagonal = row[0];
      row[0] = i;
      for (std::size_t j = 1; j <= candidate.size(); ++j) {
        const std::size_t substituted = diagonal + (word[i - 1] == candidate[j - 1] ? 0 : 1);
        diagonal = row[j];
        row[j] = std::min({row[j] + 1, row[j - 1] + 1, substituted});
      }
    }
    if (row.back() < bestDistance) {
      bestDistance = row.back();
      best = candidate;
    }
  }
  return best;
}

namespace {

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
  for (auto& option : provenance::listOptions(common)) {
    if (option.name == "out" && declaration.fallbackOut) continue;  // a positional: OUT_DIR
    const bool concernsOutput = option.name == "out" || option.name == "force" ||
                                option.name == "dry-run" || option.name == "private";
    if (concernsOutput && !declaration.writesOutput) continue;
    if (option.name == "accept" && !filesMeet(declaration)) continue;
    if (option.name == "report" && !mayBeReported(declaration)) continue;
    if (declaration.find(option.name) != nullptr) continue;  // a command's own --max-time
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
      if (const std::string now = nowCalled(key, known); !now.empty()) {
        throw UsageError(source + ": option '" + key + "' is called '" + now + "' now");
      }
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
    if (option.isList() && (all[i]->positional || all[i]->severalWords)) {
      binding.handle->expected(1, 1 << 20);
    } else {
      binding.handle->expected(1)->allow_extra_args(false);
      binding.handle->multi_option_policy(option.isList() ? CLI::MultiOptionPolicy::TakeAll
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
    if (word.rfind('-', 0) != 0) throw UsageError("'" + extra + "' was not expected");
    if (word == "--out" && declaration.fallbackOut) {
      throw UsageError("--out is not an option of this command: OUT_DIR says where the results go");
    }
    if (const std::string now = renamedWord(word, known); !now.empty()) {
      throw UsageError(word + " is called " + now + " now");
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

namespace {

/// Whether a condition of Declaration::needs holds: "label" is given, "method=thesis" is its value.
bool holds(const Declaration& declaration, const std::set<std::string>& given,
           const std::string& condition) {
  const auto equals = condition.find('=');
  if (equals == std::string::npos) return given.count(condition) > 0;
  const Parameter* parameter = declaration.find(condition.substr(0, equals));
  return parameter && parameter->option.text() == condition.substr(equals + 1);
}

/// "--method thesis" of "method=thesis".
std::string conditionText(const Declaration& declaration, const std::string& condition) {
  const auto equals = condition.find('=');
  const Parameter* parameter = declaration.find(condition.substr(0, equals));
  if (equals == std::string::npos) return dashed(*parameter);
  return dashed(*parameter) + " " + condition.substr(equals + 1);
}

}  // namespace

std::string needsText(const Declaration& declaration, const Parameter& parameter) {
  std::string text;
  for (const std::string& condition : parameter.needs) {
    text += (text.empty() ? "" : " or ") + conditionText(declaration, condition);
  }
  return text;
}

void requireSomething(const Declaration& declaration, const std::set<std::string>& given) {
  const bool reads = std::any_of(declaration.parameters.begin(), declaration.parameters.end(),
                                 [](const Parameter& p) { return p.file.has_value(); });
  if (!reads || !given.empty()) return;
  throw UsageError("nothing is given to work on; usage: " + usageLine(declaration) +
                   " (see --help)");
}

void refuseIgnored(const Declaration& declaration, const std::set<std::string>& given) {
  for (const Parameter& parameter : declaration.parameters) {
    if (!given.count(parameter.option.name)) continue;
    for (const std::string& other : parameter.excludes) {
      const Parameter* beside = declaration.find(other);
      if (!beside || !given.count(other)) continue;
      throw UsageError(dashed(parameter) + " and " + dashed(*beside) +
                       " exclude each other: leave one of them out");
    }
    const bool effective =
        parameter.needs.empty() ||
        std::any_of(parameter.needs.begin(), parameter.needs.end(),
                    [&](const auto& condition) { return holds(declaration, given, condition); });
    if (!effective) {
      throw UsageError(dashed(parameter) + " has no effect without " +
                       needsText(declaration, parameter) + ": leave it out, or add that");
    }
  }
}

void requireGiven(const Declaration& declaration, const std::set<std::string>& given) {
  for (const Parameter& parameter : declaration.parameters) {
    if (parameter.required && !given.count(parameter.option.name)) {
      throw UsageError(dashed(parameter) + " is missing: " + parameter.option.help);
    }
  }
}

}  // namespace explica::app
