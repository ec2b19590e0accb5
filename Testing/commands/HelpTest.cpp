// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
// What a command says of itself: --help is short and its example works, --help-all is whole.

#include "Explica/Testing/Command.h"
#include "FirstHelp.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <sstream>

namespace explica::testing {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

/// Options beside --out that --help may show: "the dozen", and a little.
constexpr std::size_t kMostShown = 14;

const Json& declarations() {
  static const Json all = Json::parse(explica({"--describe"}).out);
  return all;
}

std::vector<std::string> wordsOf(const Json& command) {
  std::istringstream text(command["command"].get<std::string>());
  return {std::istream_iterator<std::string>(text), {}};
}

std::string helpOf(const Json& command, const std::string& option) {
  auto words = wordsOf(command);
  words.push_back(option);
  const CommandResult said = explica(words);
  EXPECT_EQ(said.exitCode, 0) << said;
  return said.out;
}

TEST(Overview, NamesEveryCommandUnderATaskAndPhantomsInOneLine) {
  const std::string text = explica({"--help"}).out;
  EXPECT_EQ(text.find("\nOther\n"), std::string::npos)
      << "name the command in Applications/Common/src/Overview.cpp\n"
      << text;
  std::size_t phantoms = 0;
  for (const Json& command : declarations()) {
    const std::string name = command["command"];
    const bool phantom = name.starts_with("phantom ");
    phantoms += phantom;
    EXPECT_NE(text.find(phantom ? name.substr(8) : "\n  " + name + " "), std::string::npos) << name;
  }
  EXPECT_GT(phantoms, 4U);
  EXPECT_NE(text.find("phantom KIND"), std::string::npos);
}

TEST(EveryCommandHelp, HasARowInTheTableOfWhatIsShownAtFirst) {
  for (const Json& command : declarations()) {
    const app::FirstHelp* row = app::firstHelpOf(command["command"].get<std::string>());
    ASSERT_NE(row, nullptr) << command["command"]
                            << ": add a row to Applications/Common/src/FirstHelp.cpp";
    EXPECT_FALSE(row->last.empty());
    for (const auto name : row->options) {
      const auto& parameters = command["parameters"];
      EXPECT_TRUE(std::any_of(parameters.begin(), parameters.end(),
                              [&](const Json& p) { return p["name"] == std::string(name); }))
          << command["command"] << " has no option " << name << ": Common/src/FirstHelp.cpp";
    }
  }
  for (const app::FirstHelp& row : app::allFirstHelp()) {
    EXPECT_TRUE(
        std::any_of(declarations().begin(), declarations().end(),
                    [&](const Json& c) { return c["command"] == std::string(row.command); }))
        << row.command << " is no command";
  }
}

TEST(EveryCommandHelp, ShowsADozenOptionsAtFirstAndAllWhenAsked) {
  for (const Json& command : declarations()) {
    SCOPED_TRACE(command["command"].get<std::string>());
    const std::string first = helpOf(command, "--help");
    const std::string all = helpOf(command, "--help-all");
    std::size_t shown = 0;
    for (const Json& p : command["parameters"]) {
      if (p["positional"]) continue;
      const std::string line = "\n  --" + p["name"].get<std::string>();
      EXPECT_NE(all.find(line), std::string::npos) << line;
      EXPECT_EQ(first.find(line + " ") != std::string::npos ||
                    first.find(line + "\n") != std::string::npos,
                p["first"].get<bool>())
          << line;
      shown += p["first"].get<bool>() && p["name"] != "out";
    }
    EXPECT_LE(shown, kMostShown);
    EXPECT_LE(std::count(first.begin(), first.end(), '\n'), 60);
    EXPECT_NE(first.find("--help-all"), std::string::npos);
  }
}

TEST(EveryCommandHelp, StepsAreNamedByTheirPrefix) {
  for (const std::string command : {"run", "bids"}) {
    const std::string first = explica({command, "--help"}).out;
    EXPECT_NE(first.find("--unfold.NAME"), std::string::npos);
    EXPECT_NE(first.find("--unfold.radius"), std::string::npos) << "where the patch goes";
    EXPECT_EQ(first.find("--unfold.knot"), std::string::npos);
    EXPECT_NE(explica({command, "--help-all"}).out.find("--unfold.knot"), std::string::npos);
  }
}

TEST(EveryCommandHelp, ExamplesNameItsOptions) {
  for (const Json& command : declarations()) {
    std::set<std::string> names;
    for (const Json& p : command["parameters"]) names.insert("--" + p["name"].get<std::string>());
    for (const Json& example : command["examples"]) {
      std::istringstream line(example["command"].get<std::string>());
      for (std::string word; line >> word;) {
        if (!word.starts_with("--")) continue;
        EXPECT_TRUE(names.contains(word.substr(0, word.find('=')))) << word << " in " << line.str();
      }
    }
  }
}

TEST(EveryCommandHelp, ExampleWorksAsPasted) {
  CommandSetting setting;
  const fs::path bin = fs::path(EXPLICA_EXECUTABLE).parent_path();
  setting.environment["PATH"] = bin.string() + ":" + std::getenv("PATH");
  for (const app::FirstHelp& row : app::allFirstHelp()) {
    const TemporaryFolder folder;
    setting.directory = folder.path();
    const auto result = runProgram({"sh", "-ec", row.example()}, setting);
    EXPECT_TRUE(result.exitCode == 0 || result.exitCode == 3) << row.example() << "\n" << result;
  }
}

}  // namespace
}  // namespace explica::testing
