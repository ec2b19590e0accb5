// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
// Every command of README.md works: each line of its `sh` blocks is run, in order, in one folder.
// Lines that name a script of the repository are not run here; the script must exist.

#include "Explica/Testing/Command.h"

#include <gtest/gtest.h>

#include <unistd.h>

#include <sstream>

namespace explica::testing {
namespace {

namespace fs = std::filesystem;

std::vector<std::string> commandsOfReadme() {
  std::istringstream text(readText(fs::path(EXPLICA_SOURCE_DIR) / "README.md"));
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

TEST(Readme, EveryCommandInItRuns) {
  TemporaryFolder folder;
  CommandSetting setting;
  setting.directory = folder.path();
  const fs::path bin = fs::path(EXPLICA_EXECUTABLE).parent_path();
  setting.environment["PATH"] = bin.string() + ":" + std::getenv("PATH");
  const auto commands = commandsOfReadme();
  ASSERT_GE(commands.size(), 4u);
  for (const auto& command : commands) {
    const std::string first = command.substr(0, command.find(' '));
    if (first.find('/') != std::string::npos) {
      if (!fs::exists((fs::path(EXPLICA_SOURCE_DIR) / first).parent_path())) continue;
      EXPECT_EQ(access((fs::path(EXPLICA_SOURCE_DIR) / first).c_str(), X_OK), 0) << command;
      continue;
    }
    const auto result = runProgram({"sh", "-ec", command}, setting);
    EXPECT_EQ(result.exitCode, 0) << command << "\n" << result;
  }
}

}  // namespace
}  // namespace explica::testing
