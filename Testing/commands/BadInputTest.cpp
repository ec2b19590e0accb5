// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
// Wrong inputs: one clear sentence that names the file, exit code 2, nothing written.

#include "BadVolumes.h"
#include "QuickRuns.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <tuple>

namespace explica::testing {
namespace {

/// Says what is wrong with how a command refused; empty if nothing is.
std::string faultOfRefusal(const CommandResult& result, const std::string& file,
                           const std::vector<std::string>& message) {
  if (result.exitCode != 2) return "exit code " + std::to_string(result.exitCode) + " instead of 2";
  if (std::count(result.err.begin(), result.err.end(), '\n') != 1) return "not one sentence";
  if (result.err.rfind("error: explica ", 0) != 0) return "does not start with the command";
  if (result.err.find(file) == std::string::npos) return "does not name " + file;
  for (const auto& part : message) {
    if (result.err.find(part) == std::string::npos) return "does not say '" + part + "'";
  }
  return "";
}

// ---- commands that read a 3D volume; {file} is the bad one ----

struct VolumeCommand {
  std::string name;
  std::vector<std::string> words;
};
void PrintTo(const VolumeCommand& command, std::ostream* stream) {
  *stream << command.name;
}

const VolumeCommand kVolumeCommands[] = {
    {"Segment", {"segment", "{file}"}},
};

class BadVolumeInput : public ::testing::TestWithParam<std::tuple<VolumeCommand, BadVolume>> {};

TEST_P(BadVolumeInput, IsRefusedInOneSentence) {
  const auto& [command, volume] = GetParam();
  TemporaryFolder folder;
  const std::string file = folder / volume.file;
  volume.make(file);
  const auto before = folder.entries();
  auto words = command.words;
  std::replace(words.begin(), words.end(), std::string("{file}"), file);
  const auto result = explica(words + std::vector<std::string>{"--out", folder / "out"});
  EXPECT_EQ(faultOfRefusal(result, file, volume.message), "") << result;
  EXPECT_EQ(folder.entries(), before);
}

INSTANTIATE_TEST_SUITE_P(Table, BadVolumeInput,
                         ::testing::Combine(::testing::ValuesIn(kVolumeCommands),
                                            ::testing::ValuesIn(badVolumes())),
                         [](const auto& row) {
                           return std::get<0>(row.param).name + std::get<1>(row.param).name;
                         });

}  // namespace
}  // namespace explica::testing
