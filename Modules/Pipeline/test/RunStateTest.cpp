// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Pipeline/RunState.h"

#include "Explica/Core/Errors.h"

#include <gtest/gtest.h>

#include <fstream>

namespace explica::pipeline {
namespace {

namespace fs = std::filesystem;

class RunState : public ::testing::Test {
 protected:
  [[nodiscard]] const fs::path& file() const { return file_; }
  ~RunState() override { fs::remove(file_); }

 private:
  fs::path file_ = fs::path(::testing::TempDir()) /
                   (std::string("explica-run-state-") +
                    ::testing::UnitTest::GetInstance()->current_test_info()->name() + ".json");
};

TEST_F(RunState, KeepsEveryStateAndMessageInOrder) {
  using report::StepState;
  const std::vector<StepNote> notes = {
      {"segment", "segment", StepState::Done, ""},
      {"surface-L", "surface", StepState::StoppedEarly, "stopped before its goal"},
      {"unfold-L", "unfold", StepState::Failed, "center: \"480 mm\" off\nthe surface"},
      {"report", "report", StepState::Missing, ""}};
  writeRunState(file(), notes);
  const std::vector<StepNote> read = readRunState(file());
  ASSERT_EQ(read.size(), notes.size());
  for (std::size_t n = 0; n < notes.size(); ++n) {
    EXPECT_EQ(read[n].name, notes[n].name);
    EXPECT_EQ(read[n].command, notes[n].command);
    EXPECT_EQ(read[n].state, notes[n].state) << notes[n].name;
    EXPECT_EQ(read[n].message, notes[n].message);
  }
}

TEST_F(RunState, IsEmptyWhereNothingRan) {
  EXPECT_TRUE(readRunState(file()).empty());
}

TEST_F(RunState, TakesAStateThatItDoesNotKnowForMissing) {
  std::ofstream(file()) << R"({"steps": [{"name": "a", "state": "paused"}, {"name": "b"}]})";
  const std::vector<StepNote> read = readRunState(file());
  ASSERT_EQ(read.size(), 2U);
  EXPECT_EQ(read[0].state, report::StepState::Missing);
  EXPECT_EQ(read[1].state, report::StepState::Missing);
  EXPECT_EQ(read[1].command, "");
}

TEST_F(RunState, RefusesWhatIsNoJson) {
  std::ofstream(file()) << "{\"steps\": [";
  EXPECT_THROW(static_cast<void>(readRunState(file())), Error);
}

}  // namespace
}  // namespace explica::pipeline
