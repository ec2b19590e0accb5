// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
// The bounds that commands declare for their numbers are held: commands and options are taken from
// `explica --describe`, so that a new one is tried by itself.

#include "DescribedCommands.h"
#include "QuickRuns.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

namespace explica::testing {
namespace {

bool isNumber(const Json& parameter) {
  return parameter["type"] == "integer" || parameter["type"] == "number";
}

/// The numbers closest to the declared range that lie outside of it.
std::vector<std::string> justOutside(const Json& parameter) {
  const bool whole = parameter["type"] == "integer";
  const auto text = [whole](double x) {
    char word[40];
    std::snprintf(word, sizeof word, whole ? "%.0f" : "%.17g", x);
    return std::string(word);
  };
  constexpr double kInfinite = std::numeric_limits<double>::infinity();
  std::vector<std::string> words;
  if (const Json& least = parameter["least"]; !least.is_null()) {
    const double x = least;
    words.push_back(text(whole ? x - 1 : std::nextafter(x, -kInfinite)));
  }
  if (const Json& above = parameter["above"]; !above.is_null()) words.push_back(text(above));
  if (const Json& most = parameter["most"]; !most.is_null()) {
    const double x = most;
    words.push_back(text(whole ? x + 1 : std::nextafter(x, kInfinite)));
  }
  return words;
}

/// A number that a command takes.
struct Bounded {
  const Json* command;
  const Json* parameter;
};

/// Each name with its bounds, once: several commands have it from one declaration, and steps of a
/// run have it with a prefix.
std::vector<Bounded> boundedNumbers() {
  std::vector<Bounded> all;
  std::set<std::string> known;
  for (const Json& command : describedCommands()) {
    for (const Json& p : command["parameters"]) {
      if (!isNumber(p)) continue;
      const std::string name = p["name"];
      const std::string declared = name.substr(name.rfind('.') + 1) + p["type"].dump() +
                                   p["least"].dump() + p["above"].dump() + p["most"].dump();
      if (known.insert(declared).second) all.push_back({&command, &p});
    }
  }
  return all;
}

/// They are tried in this many parts, side by side.
constexpr std::size_t kParts = 4;

class Bounds : public ::testing::TestWithParam<std::size_t> {};

TEST_P(Bounds, OfEveryNumberAreHeld) {
  const std::vector<Bounded> all = boundedNumbers();
  std::size_t tried = 0;
  for (std::size_t n = GetParam(); n < all.size(); n += kParts) {
    for (const std::string& word : justOutside(*all[n].parameter)) {
      const std::string name = (*all[n].parameter)["name"];
      const auto result =
          explica(wordsOf(*all[n].command) + std::vector<std::string>{"--" + name + "=" + word});
      EXPECT_EQ(result.exitCode, 1) << name << " " << word << "\n" << result;
      EXPECT_NE(result.err.find(name + ": '" + word + "' is not"), std::string::npos) << result;
      ++tried;
    }
  }
  EXPECT_GT(tried, 20U);
}

INSTANTIATE_TEST_SUITE_P(Commands, Bounds, ::testing::Range(std::size_t{0}, kParts));

TEST(Bounds, AreDeclaredForEveryCount) {
  // Numbers of labels and vertices are held against the file; every seed is as good as another.
  const std::set<std::string> names = {
      "inner",  "tissue", "outer", "insulated", "white-label", "grey-label", "fill",
      "cavity", "wall",   "rv",    "label",     "label-key",   "vertex",     "seed"};
  for (const Json& command : describedCommands()) {
    for (const Json& parameter : command["parameters"]) {
      if (parameter["type"] != "integer") continue;
      const std::string name = parameter["name"];
      if (names.contains(name.substr(name.rfind('.') + 1))) continue;
      EXPECT_FALSE(parameter["most"].is_null()) << command["command"] << " --" << name;
      EXPECT_FALSE(parameter["least"].is_null()) << command["command"] << " --" << name;
    }
  }
}

TEST(EveryCommandThatWrites, IsKilledAndLimitedInATest) {
  std::set<std::string> tried = {"bids", "replay", "descriptors", "study group",
                                 "study hearts"};  // StudyTrust
  for (const QuickRun& run : quickRuns()) {
    tried.insert(run.words[0]);
    tried.insert(run.words[0] + " " + run.words[1]);
  }
  for (const Json& command : describedCommands()) {
    if (!command["writes_folder"].get<bool>()) continue;
    EXPECT_TRUE(tried.contains(command["command"])) << command["command"];
  }
}

}  // namespace
}  // namespace explica::testing
