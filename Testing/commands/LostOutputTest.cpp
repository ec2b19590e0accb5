// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
// Output that does not arrive is an error, limits end a command, and whatever ends it leaves
// neither stage nor lock.

#include "Explica/Testing/Command.h"

#include <gtest/gtest.h>

#include <csignal>

namespace explica::testing {
namespace {

namespace fs = std::filesystem;

class LostOutput : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto made = explica({"phantom", "shell", "--size", "8", "--out", folder_ / "a"});
    ASSERT_EQ(made.exitCode, 0) << made;
  }

  /// Runs lines of bash in the folder; $EXPLICA is the program.
  [[nodiscard]] CommandResult bash(const std::string& lines) const {
    CommandSetting setting;
    setting.directory = folder_.path();
    setting.environment["EXPLICA"] = EXPLICA_EXECUTABLE;
    return runProgram({"bash", "-c", lines}, setting);
  }

  TemporaryFolder folder_;
};

TEST_F(LostOutput, OfStandardOutputIsExitCodeFour) {
  writeText(folder_ / "study.json",
            R"({"hemispheres": ["L"], "input": "a/labels.nii.gz", "subjects": ["01"]})");
  for (const std::string words :
       {"verify a", "verify a --prov-json", "history a", "replay a --out b", "study schema",
        "study list study.json", "--help", "thickness --help-all", "--version",
        "phantom shell --dry-run --out c"}) {
    const auto result = bash("\"$EXPLICA\" " + words + " > /dev/full");
    EXPECT_EQ(result.exitCode, 4) << words << "\n" << result;
    EXPECT_NE(result.err.find("what was printed is lost"), std::string::npos) << result;
  }
}

TEST_F(LostOutput, ToAPipeThatNobodyReadsIsExitCodeFour) {
  // More text than a pipe holds: the program writes until the reader is gone.
  const auto result = bash("{ \"$EXPLICA\" --describe; echo $? > code; } | true; cat code");
  EXPECT_EQ(result.out, "4\n") << result;
}

TEST_F(LostOutput, OfTheLogIsToldBeforeAnyWork) {
  const auto before = folder_.entries();
  const auto result = bash("\"$EXPLICA\" phantom shell --size 8 --log /dev/full --out b");
  EXPECT_EQ(result.exitCode, 4) << result;
  EXPECT_NE(result.err.find("/dev/full: the log cannot be written"), std::string::npos) << result;
  EXPECT_EQ(folder_.entries(), before);
}

TEST_F(LostOutput, OfALogThatNobodyReadsOrThatIsAnotherFileIsTold) {
  const auto pipe = bash("mkfifo pipe; \"$EXPLICA\" phantom shell --size 8 --log pipe --out b");
  EXPECT_EQ(pipe.exitCode, 4) << pipe;
  EXPECT_NE(pipe.err.find("pipe: the log cannot be written"), std::string::npos) << pipe;
  const auto input = bash("\"$EXPLICA\" phantom shell --size 8 --log a/labels.nii.gz --out b");
  EXPECT_EQ(input.exitCode, 1) << input;
  EXPECT_NE(input.err.find("no log of explica"), std::string::npos) << input;
  EXPECT_FALSE(fs::exists(folder_ / "b"));
  EXPECT_EQ(explica({"verify", folder_ / "a"}).exitCode, 0);
  for (const char* out : {"b", "c"}) {  // its own log grows
    EXPECT_EQ(bash("\"$EXPLICA\" phantom shell --size 8 --log own.log --out " + std::string(out))
                  .exitCode,
              0);
  }
}

TEST_F(LostOutput, OfMessagesIsExitCodeFour) {
  EXPECT_EQ(bash("\"$EXPLICA\" phantom shell --size 8 --out b 2> /dev/full").exitCode, 4);
  // Closed from the start is as wished.
  EXPECT_EQ(bash("\"$EXPLICA\" phantom shell --size 8 --out c 2>&-").exitCode, 0);
}

class Ending : public ::testing::TestWithParam<std::pair<const char*, int>> {};

TEST_P(Ending, ByASecondSignalLeavesNothing) {
  const TemporaryFolder folder;
  CommandSetting setting;
  setting.directory = folder.path();
  setting.environment["EXPLICA"] = EXPLICA_EXECUTABLE;
  const std::string name = GetParam().first;
  // Once the stage is there, one signal asks for an end and another one forces it. The program is
  // halted meanwhile, so that it cannot have ended by the first before the second is sent.
  const auto result = runProgram(
      {"bash", "-c",
       "env --default-signal \"$EXPLICA\" phantom shell --size 240 --out big & p=$!\n"
       "while [ ! -e .big.explica-stage ] && kill -0 $p 2> /dev/null; do sleep 0.01; done\n"
       "kill -s STOP $p; until grep -q '^State:.[TZ]' /proc/$p/status; do sleep 0.01; done\n"
       "kill -s USR1 $p; kill -s " +
           name + " $p; kill -s CONT $p; wait $p; echo $?"},
      setting);
  // Which of two signals at a time comes second is the system's choice.
  const std::string ended = std::to_string(128 + GetParam().second) + "\n";
  EXPECT_TRUE(result.out == ended || result.out == std::to_string(128 + SIGUSR1) + "\n") << result;
  EXPECT_TRUE(folder.entries().empty()) << folder.entries().front();
}

INSTANTIATE_TEST_SUITE_P(Signals, Ending,
                         ::testing::Values(std::pair{"HUP", SIGHUP}, std::pair{"QUIT", SIGQUIT},
                                           std::pair{"TERM", SIGTERM}, std::pair{"INT", SIGINT}),
                         [](const auto& row) { return std::string(row.param.first); });

TEST(Limits, TimeEndsACommandWithWhatWasReached) {
  const TemporaryFolder folder;
  ASSERT_EQ(explica({"phantom", "cortex", "--size", "64", "--out", folder / "c"}).exitCode, 0);
  const auto before = folder.entries();
  const auto result =
      explica({"run", folder / "c/labels.nii.gz", "--max-time", "1e-9", "--out", folder / "r"});
  if (overran(result)) {
    EXPECT_EQ(folder.entries(), before);
    GTEST_SKIP() << "skipped: the machine is too busy to stop within the grace of --max-time";
  }
  EXPECT_EQ(result.exitCode, 3) << result;
  EXPECT_EQ(readJson(folder / "r/summary.json")["termination"], "max-time");
}

TEST(Limits, TimeEndsACommandThatDoesNotHearOfIt) {
  const TemporaryFolder folder;
  CommandSetting setting;
  setting.directory = folder.path();
  setting.environment["EXPLICA"] = EXPLICA_EXECUTABLE;
  // Its messages go to a pipe that is full and that nobody reads: it waits there for ever.
  const auto result = runProgram(
      {"bash", "-c",
       "mkfifo pipe; exec 3<>pipe; dd if=/dev/zero bs=4096 count=16 status=none >&3\n"
       "\"$EXPLICA\" phantom shell --size 8 --verbose --max-time 0.1 --out a 2>&3; echo $?"},
      setting);
  EXPECT_EQ(result.out, "4\n") << result;
  EXPECT_EQ(folder.entries(), std::vector<std::string>{"pipe"});
}

TEST(Limits, TimeEndsACommandThatDoesNotHearOfItWithASentence) {
  const TemporaryFolder folder;
  std::string subjects;
  for (int n = 0; n < 20000; ++n) subjects += (n > 0 ? ",\"" : "\"") + std::to_string(n) + "\"";
  writeText(folder / "study.json",
            R"({"hemispheres": ["L"], "input": "a.nii", "subjects": [)" + subjects + "]}");
  CommandSetting setting;
  setting.directory = folder.path();
  setting.environment["EXPLICA"] = EXPLICA_EXECUTABLE;
  const auto result = runProgram({"bash", "-c",
                                  "mkfifo pipe; exec 3<>pipe\n"
                                  "\"$EXPLICA\" study list study.json --max-time 0.1 >&3; echo $?"},
                                 setting);
  EXPECT_EQ(result.out, "4\n") << result;
  EXPECT_NE(result.err.find("did not come to a stop after --max-time"), std::string::npos)
      << result;
}

TEST(Limits, MemoryEndsACommandWithASentenceAndNothingElse) {
  const TemporaryFolder folder;
  const auto result = explica(
      {"phantom", "shell", "--size", "300", "--max-memory", "300", "--out", folder / "big"});
  EXPECT_EQ(result.exitCode, 4) << result;
  EXPECT_NE(result.err.find("out of memory"), std::string::npos) << result;
  EXPECT_TRUE(folder.entries().empty());
  EXPECT_EQ(
      explica({"phantom", "shell", "--size", "8", "--max-memory", "300", "--out", folder / "small"})
          .exitCode,
      0);
}

}  // namespace
}  // namespace explica::testing
