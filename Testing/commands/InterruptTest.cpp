// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
// A signal ends an iterative command at a consistent state: outputs written and marked.

#include "QuickRuns.h"

#include <gtest/gtest.h>

#include <signal.h>

namespace explica::testing {
namespace {

class Interrupt : public ::testing::TestWithParam<int> {};

TEST_P(Interrupt, WritesAndMarksWhatWasReachedAndResumes) {
  TemporaryFolder folder;
  io::writeSurface(folder / "sphere.surf.gii", geometry::makeFoldedSphere(6, 30.0));
  const std::vector<std::string> words = {"unfold",      folder / "sphere.surf.gii",
                                          "--center",    "0,0,30",
                                          "--radius",    "25",
                                          "--direction", "0,0,1",
                                          "--out",       folder / "a",
                                          "--verbose"};
  CommandSetting setting;
  setting.signal = GetParam();
  setting.signalWhen = "iteration 2";
  const auto stopped = explica(words, setting);
  ASSERT_EQ(stopped.exitCode, 3) << stopped;
  EXPECT_NE(stopped.err.find("interrupted"), std::string::npos) << stopped;
  const auto record = readJson(folder / "a/provenance.json");
  EXPECT_EQ(record["termination"], "interrupted");
  EXPECT_EQ(record["exit_code"], 3);
  EXPECT_EQ(readJson(folder / "a/summary.json")["termination"], "interrupted");
  EXPECT_EQ(readJson(folder / "a/summary.json")["self_intersections_final"], 0);
  EXPECT_EQ(explica({"verify", folder / "a"}).exitCode, 0);

  const auto resumed =
      explica(words + std::vector<std::string>{"--resume", "--max-iterations", "2"});
  EXPECT_TRUE(resumed.exitCode == 0 || resumed.exitCode == 3) << resumed;
  EXPECT_NE(readJson(folder / "a/summary.json")["termination"], "interrupted");
  EXPECT_EQ(explica({"verify", folder / "a"}).exitCode, 0);
}

TEST(Interrupts, InflationGoesOnToTheBytesOfARunThatNeverStopped) {
  TemporaryFolder folder;
  io::writeSurface(folder / "sphere.surf.gii", geometry::makeFoldedSphere(5, 30.0, 0.5, 9));
  const std::vector<std::string> words = {"inflate", folder / "sphere.surf.gii", "--out",
                                          folder / "a", "--verbose"};
  CommandSetting setting;
  setting.signal = SIGINT;
  setting.signalWhen = "iteration 2";
  const auto stopped = explica(words, setting);
  ASSERT_EQ(stopped.exitCode, 3) << stopped;
  EXPECT_EQ(readJson(folder / "a/provenance.json")["termination"], "interrupted");
  const auto summary = readJson(folder / "a/summary.json");
  EXPECT_EQ(summary["stop_reason"], "interrupted");
  EXPECT_EQ(summary["self_intersections_final"], 0);
  EXPECT_EQ(explica({"verify", folder / "a"}).exitCode, 0);
  const auto resumed = explica(words + std::vector<std::string>{"--resume"});
  EXPECT_EQ(resumed.exitCode, 0) << resumed;
  const auto whole = explica({"inflate", folder / "sphere.surf.gii", "--out", folder / "b"});
  EXPECT_EQ(whole.exitCode, 0) << whole;
  EXPECT_EQ(readText(folder / "a/inflated.surf.gii"), readText(folder / "b/inflated.surf.gii"));
}

TEST(Interrupts, AFlatMapGoesOnToTheBytesOfARunThatNeverStopped) {
  TemporaryFolder folder;
  io::writeSurface(folder / "sphere.surf.gii", geometry::makeFoldedSphere(5, 30.0));
  const std::vector<std::string> words = {
      "flatten",  folder / "sphere.surf.gii", "--cuts", "auto", "--grid", "2", "--frames", "3",
      "--verbose"};
  const auto whole = explica(words + std::vector<std::string>{"--out", folder / "whole"});
  ASSERT_EQ(whole.exitCode, 0) << whole;
  for (const std::string moment : {"cut 1", "iteration 2 on 10"}) {
    const std::vector<std::string> here = {"--out", folder / "a", "--force"};
    CommandSetting setting;
    setting.signal = SIGUSR1;
    setting.signalWhen = moment;
    const auto stopped = explica(words + here, setting);
    ASSERT_EQ(stopped.exitCode, 3) << stopped;
    EXPECT_NE(stopped.err.find("interrupted"), std::string::npos) << stopped;
    const auto summary = readJson(folder / "a/summary.json");
    EXPECT_EQ(summary["termination"], "interrupted");
    EXPECT_EQ(summary.value("turned_over", 0), 0);
    EXPECT_EQ(summary.value("rim_crossings", 0), 0);
    EXPECT_EQ(explica({"verify", folder / "a"}).exitCode, 0);
    const auto resumed =
        explica(words + std::vector<std::string>{"--out", folder / "a", "--resume"});
    EXPECT_EQ(resumed.exitCode, 0) << resumed;
    for (const char* file : {"patch_flat.surf.gii", "flat.surf.gii", "cuts.tsv",
                             "frames/frame-0001.surf.gii", "lh.patch.flat"}) {
      EXPECT_EQ(readText(folder / ("a/" + std::string(file))),
                readText(folder / ("whole/" + std::string(file))))
          << moment << " " << file;
    }
    EXPECT_EQ(explica({"verify", folder / "a"}).exitCode, 0);
  }
}

TEST(Interrupts, AComparisonHoldsTheSurfacesThatItHasMeasured) {
  TemporaryFolder folder;
  std::vector<std::string> words = {"compare"};
  for (const std::string name : {"before", "first", "second", "third"}) {
    io::writeSurface(folder / (name + ".surf.gii"), geometry::makeFoldedSphere(5, 30.0));
    words.push_back(folder / (name + ".surf.gii"));
  }
  CommandSetting setting;
  setting.signal = SIGINT;
  setting.signalWhen = "second.surf.gii: ";
  const auto stopped =
      explica(words + std::vector<std::string>{"--out", folder / "a", "--verbose"}, setting);
  ASSERT_EQ(stopped.exitCode, 3) << stopped;
  const auto summary = readJson(folder / "a/summary.json");
  EXPECT_EQ(summary["termination"], "interrupted");
  ASSERT_GE(summary["surfaces"].size(), 1U);
  EXPECT_LT(summary["surfaces"].size(), 3U);
  EXPECT_EQ(summary["surfaces"][0]["surface"], "first.surf.gii");
  EXPECT_EQ(summary["area_error_mean"], 0);
  EXPECT_EQ(explica({"verify", folder / "a"}).exitCode, 0);
}

/// A pipe that nobody reads any more is no request to end.
TEST(Interrupts, EverySignalThatAsksForAnEndIsHeard) {
  TemporaryFolder folder;
  writeFoldedSphere(folder);
  for (const int number : {SIGTERM, SIGHUP, SIGQUIT}) {
    CommandSetting setting;
    setting.signal = number;
    setting.signalWhen = "iteration 1";
    const auto stopped =
        explica({"inflate", folder / "sphere.surf.gii", "--max-iterations", "2000", "--target-seen",
                 "1", "--verbose", "--out", folder / "a", "--force"},
                setting);
    EXPECT_EQ(stopped.exitCode, 3) << number << stopped;
    EXPECT_EQ(readJson(folder / "a/summary.json")["termination"], "interrupted");
  }
}

INSTANTIATE_TEST_SUITE_P(Signals, Interrupt, ::testing::Values(SIGINT, SIGUSR1),
                         [](const auto& row) { return "Signal" + std::to_string(row.param); });

}  // namespace
}  // namespace explica::testing
