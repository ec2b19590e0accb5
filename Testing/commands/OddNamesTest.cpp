// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
// Names that hold line breaks, and pipes where a file is expected: every message stays one line,
// and nothing waits for a pipe that nobody writes to.

#include "QuickRuns.h"
#include "SmallStudy.h"

#include <gtest/gtest.h>

#include <sys/stat.h>

#include <algorithm>

namespace explica::testing {
namespace {

namespace fs = std::filesystem;
using Words = std::vector<std::string>;

constexpr const char* kBreak = "a\nerror: all is lost\tb\x1b[2J";  // a name that plays a message

long linesOf(const std::string& text) {
  return std::count(text.begin(), text.end(), '\n');
}

/// Nothing of the name's own making: no line begins with its words, no escape reaches a terminal.
void expectTamed(const CommandResult& result) {
  for (const std::string& text : {result.out, result.err}) {
    EXPECT_EQ(text.find("\nerror: all is lost"), std::string::npos) << result;
    EXPECT_EQ(text.find('\x1b'), std::string::npos) << result;
  }
}

TEST(NamesWithLineBreaks, StayOnTheLineOfTheirMessage) {
  const TemporaryFolder folder;
  const std::string name = folder / kBreak;
  const Words refused[] = {
      {"thickness", name, "--inner", "1", "--tissue", "2", "--out", folder / "out"},
      {"inflate", name + ".off", "--out", folder / "out"},
      {"polygon", name + ".csv", "--viewpoint", "0,9", "--out", folder / "out"},
      {"run", name, "--out", folder / "out"},
      {"phantom", "shell", "--config", name, "--out", folder / "out"},
      {"phantom", kBreak},
      {kBreak},
      {"phantom", "shell", std::string("--") + kBreak},
      {"phantom", "shell", "--size", kBreak},
      {"verify", name},
      {"history", name},
      {"replay", name, "--out", folder / "out"},
      {"report", name},
      {"view", name, "--screenshot", folder / "a.png"},
      {"study", "check", name},
      {"bids", name, folder / "out", "participant"},
  };
  for (const Words& words : refused) {
    const auto result = explica(words);
    EXPECT_TRUE(result.exitCode == 1 || result.exitCode == 2) << result;
    EXPECT_EQ(linesOf(result.err), 1) << result;
    EXPECT_NE(result.err.find("a?error: all is lost?b?[2J"), std::string::npos) << result;
    expectTamed(result);
  }
}

TEST(NamesWithLineBreaks, StayOnTheirLineWhereAllIsWell) {
  const TemporaryFolder folder;
  const std::string sphere = folder / (std::string(kBreak) + ".surf.gii");
  const std::string out = folder / (std::string("out ") + kBreak);
  io::writeSurface(sphere, geometry::makeFoldedSphere(3, 30.0));
  const auto made = explica({"inflate", sphere, "--max-iterations", "2", "--verbose", "--log",
                             folder / "log", "--out", out});
  ASSERT_TRUE(made.exitCode == 0 || made.exitCode == 3) << made;
  expectTamed(made);
  expectTamed({0, readText(folder / "log"), ""});
  const auto verified = explica({"verify", out});
  EXPECT_EQ(verified.exitCode, 0) << verified;
  EXPECT_EQ(linesOf(verified.out),
            static_cast<long>(readJson(out + "/provenance.json")["outputs"].size()) + 1);
  expectTamed(verified);
  const auto told = explica({"history", out});
  EXPECT_EQ(told.exitCode, 0) << told;
  expectTamed(told);
  const auto replayed = explica({"replay", out, "--out", folder / "again"});
  EXPECT_EQ(replayed.exitCode, 0) << replayed;
  expectTamed(replayed);
}

class Pipes : public ::testing::Test {
 protected:
  /// A pipe that nobody will ever write to, in the place of a file that may be there.
  std::string pipeAt(const std::string& name) const {
    const std::string path = folder_ / name;
    fs::remove(path);
    fs::create_directories(fs::path(path).parent_path());
    if (mkfifo(path.c_str(), 0600) != 0) throw std::runtime_error("no pipe at " + path);
    return path;
  }
  /// The command ends by itself and says which of its files is none.
  static void expectRefused(const Words& words, const std::string& pipe) {
    const auto result = explica(words);
    EXPECT_EQ(result.exitCode, 2) << result;
    EXPECT_NE(result.err.find(pipe), std::string::npos) << result;
    EXPECT_TRUE(result.err.find("not a regular file") != std::string::npos ||
                result.err.find("no such file") != std::string::npos)
        << result;
  }

  TemporaryFolder folder_;
};

TEST_F(Pipes, AreRefusedAsInputsWithoutWaiting) {
  writeCortexAndMap(folder_);
  const std::string pipe = pipeAt("pipe"), out = folder_ / "out";
  const Words kSample = {"sample", folder_ / "map.nii.gz",    "--white", folder_ / "white.surf.gii",
                         "--pial", folder_ / "pial.surf.gii", "--out",   out};
  expectRefused({"thickness", pipe, "--inner", "1", "--tissue", "2", "--out", out}, pipe);
  expectRefused({"inflate", pipe, "--out", out}, pipe);
  expectRefused({"polygon", pipe, "--viewpoint", "0,9", "--out", out}, pipe);
  expectRefused({"phantom", "shell", "--config", pipe, "--out", out}, pipe);
  expectRefused({"segment", folder_ / "map.nii.gz", "--atlas", folder_ / "map.nii.gz",
                 "--atlas-legend", pipe, "--out", out},
                pipe);
  for (const char* option : {"--points", "--to-volume"}) {
    expectRefused(kSample + Words{option, pipe}, pipe);
  }
  for (const char* command : {"verify", "history"}) expectRefused({command, pipe}, pipe);
  expectRefused({"replay", pipe, "--out", out}, pipe);
  expectRefused({"study", "check", pipe}, pipe);
  EXPECT_EQ(explica({"report", pipe}).exitCode, 2);  // it needs a folder
  expectRefused({"view", pipe, "--screenshot", folder_ / "a.png"}, pipe);
  EXPECT_FALSE(fs::exists(out));
}

TEST_F(Pipes, AreRefusedAsTheMatrixOfAStudy) {
  const std::string pipe = pipeAt("to-common.txt");
  writeText(folder_ / "study.json", R"({"hemispheres": ["L"], "input": "labels.nii.gz",
    "regions": {"a": {"space": "common", "center": [0, 0, 1], "radius": 9, "viewpoint": [0, 0, 9]}},
    "subjects": {"01": {"to-common": "to-common.txt"}}})");
  expectRefused({"study", "check", folder_ / "study.json"}, pipe);
}

TEST_F(Pipes, AreRefusedAsStatesToResumeFrom) {
  writeFoldedSphere(folder_);
  const Words rows[] = {
      {"unfold", folder_ / "sphere.surf.gii", "--center", "0,0,30", "--radius", "12", "--direction",
       "0,0,1", "--max-iterations", "1"},
      {"inflate", folder_ / "sphere.surf.gii", "--max-iterations", "1"},
  };
  for (const Words& words : rows) {
    const Words here = words + Words{"--out", folder_ / "out", "--force"};
    const auto made = explica(here);
    ASSERT_TRUE(made.exitCode == 0 || made.exitCode == 3) << made;
    int pipes = 0;
    for (const std::string& name : folder_.entries()) {
      if (name.starts_with("out/") && name.ends_with(".state")) pipes += !pipeAt(name).empty();
    }
    EXPECT_EQ(pipes, 1) << words[0];
    const auto resumed = explica(words + Words{"--out", folder_ / "out", "--resume"});
    EXPECT_EQ(resumed.exitCode, 2) << resumed;
    EXPECT_NE(resumed.err.find("is not a regular file"), std::string::npos) << resumed;
    fs::remove_all(folder_ / "out");
  }
}

TEST_F(Pipes, AmongTheFilesOfAStudyStopNobody) {
  const SmallStudy study(folder_.path(), {"01", "02"});
  ASSERT_EQ(explica(study.participants(study.out())).exitCode, 0);
  pipeAt("out/runs/sub-02_hemi-L/problem.txt");
  pipeAt("out/runs/sub-01_hemi-L/surface/regions.tsv");
  const auto group = explica(study.group(study.out()));
  EXPECT_TRUE(group.exitCode == 0 || group.exitCode == 2) << group;  // 137: it waited
  const auto page = explica({"report", study.out() + "/runs/sub-01_hemi-L"});
  EXPECT_TRUE(page.exitCode == 0 || page.exitCode == 2) << page;
}

}  // namespace
}  // namespace explica::testing
