// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
// Every command of README.md and of the page on studies works: each line of their `sh` blocks is
// run, in order, in one folder a page.  Lines that name a script of the repository are not run
// here; the script must exist.

#include "Explica/Testing/Command.h"

#include <gtest/gtest.h>

#include <unistd.h>

#include <sstream>

namespace explica::testing {
namespace {

namespace fs = std::filesystem;

std::vector<std::string> commandsOf(const std::string& page) {
  std::istringstream text(readText(fs::path(EXPLICA_SOURCE_DIR) / page));
  std::vector<std::string> commands;
  bool inBlock = false;
  std::string continued;
  for (std::string line; std::getline(text, line);) {
    if (line.rfind("```", 0) == 0) {
      inBlock = line == "```sh";
      continue;
    }
    if (!inBlock || line.empty() || line[0] == '#') continue;
    if (line.back() == '\\') {
      continued += line.substr(0, line.size() - 1);
      continue;
    }
    commands.push_back(continued + line);
    continued.clear();
  }
  return commands;
}

class Readme : public ::testing::TestWithParam<const char*> {};

TEST_P(Readme, EveryCommandInItRuns) {
  TemporaryFolder folder;
  CommandSetting setting;
  setting.directory = folder.path();
  const fs::path bin = fs::path(EXPLICA_EXECUTABLE).parent_path();
  setting.environment["PATH"] = bin.string() + ":" + std::getenv("PATH");
  setting.environment["EXPLICA_SOURCE"] = EXPLICA_SOURCE_DIR;
  setting.environment["HOME"] = folder.path().string();
  const bool noEngine = !fs::exists("/usr/bin/snakemake");
  const auto commands = commandsOf(GetParam());
  ASSERT_GE(commands.size(), 4u);
  for (const auto& command : commands) {
    const std::string first = command.substr(0, command.find(' '));
    if (first == "snakemake" && noEngine) continue;
    if (first.find('/') != std::string::npos) {
      if (!fs::exists((fs::path(EXPLICA_SOURCE_DIR) / first).parent_path())) continue;
      EXPECT_EQ(access((fs::path(EXPLICA_SOURCE_DIR) / first).c_str(), X_OK), 0) << command;
      continue;
    }
    const auto result = runProgram({"sh", "-ec", command}, setting);
    EXPECT_EQ(result.exitCode, 0) << command << "\n" << result;
  }
}

INSTANTIATE_TEST_SUITE_P(Pages, Readme,
                         ::testing::Values("README.md", "ExampleData/study/README.md"),
                         [](const auto& row) {
                           return row.index == 0 ? std::string("Project") : std::string("Study");
                         });

}  // namespace
}  // namespace explica::testing
