// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
// Whole runs, on a small phantom.

#include "Explica/Testing/Command.h"

#include <gtest/gtest.h>

#include <filesystem>

namespace explica::testing {
namespace {

namespace fs = std::filesystem;

/// A run from labels to report that takes seconds.
std::vector<std::string> smallRun(const TemporaryFolder& folder, const std::string& out,
                                  std::vector<std::string> more = {}) {
  std::vector<std::string> words = {"run",
                                    folder / "phantom/labels.nii.gz",
                                    "--out",
                                    folder / out,
                                    "--surface.faces",
                                    "3000",
                                    "--unfold.radius",
                                    "9",
                                    "--unfold.max-iterations",
                                    "2",
                                    "--unfold.frames",
                                    "3"};
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

void makePhantom(const TemporaryFolder& folder) {
  ASSERT_EQ(explica({"phantom", "cortex", "--size", "40", "--depth", "0.1", "--waves", "3", "--out",
                     folder / "phantom"})
                .exitCode,
            0);
}

std::map<std::string, std::string> statesOf(const fs::path& out) {
  std::map<std::string, std::string> states;
  const auto run = readJson(out / "run.json");
  for (const auto& step : run["steps"]) states[step["name"]] = step["state"];
  return states;
}

TEST(Run, GoesFromLabelsToAReport) {
  TemporaryFolder folder;
  makePhantom(folder);
  const auto run = explica(smallRun(folder, "out"));
  EXPECT_TRUE(run.exitCode == 0 || run.exitCode == 3) << run;
  for (const char* file :
       {"thickness/thickness.nii.gz", "surface/white.surf.gii", "surface/pial.surf.gii",
        "unfold/unfolded.surf.gii", "report.html", "summary.json", "provenance.json"}) {
    EXPECT_TRUE(fs::exists(fs::path(folder / "out") / file)) << file;
  }
  for (const char* step : {"thickness", "surface", "unfold"}) {
    EXPECT_TRUE(fs::exists(fs::path(folder / "out") / step / "provenance.json")) << step;
    EXPECT_TRUE(fs::exists(fs::path(folder / "out") / step / "summary.json")) << step;
  }
  EXPECT_EQ(explica({"verify", folder / "out/surface/provenance.json"}).exitCode, 0);
  const std::string page = readText(folder / "out/report.html");
  EXPECT_NE(page.find("id=\"evolution\""), std::string::npos);
}

TEST(Run, ResumesWhatIsStillTrueAndRedoesWhatIsNot) {
  TemporaryFolder folder;
  makePhantom(folder);
  const std::vector<std::string> steps = {"--steps", "thickness,surface"};
  ASSERT_EQ(explica(smallRun(folder, "out", steps)).exitCode, 0);
  const auto before = stableHashes(folder / "out/surface");
  std::vector<std::string> again = steps;
  again.emplace_back("--resume");
  auto run = explica(smallRun(folder, "out", again));
  EXPECT_EQ(run.exitCode, 0) << run;
  EXPECT_NE(run.err.find("thickness: kept"), std::string::npos) << run;
  EXPECT_NE(run.err.find("surface: kept"), std::string::npos) << run;

  writeText(folder / "out/surface/white.surf.gii", "damaged");
  run = explica(smallRun(folder, "out", again));
  EXPECT_EQ(run.exitCode, 0) << run;
  EXPECT_NE(run.err.find("thickness: kept"), std::string::npos) << run;
  EXPECT_EQ(run.err.find("surface: kept"), std::string::npos) << run;
  EXPECT_EQ(stableHashes(folder / "out/surface"), before);

  again.insert(again.end(), {"--thickness.lambda", "0.7"});
  run = explica(smallRun(folder, "out", again));
  EXPECT_EQ(run.err.find("thickness: kept"), std::string::npos) << run;
  EXPECT_NE(run.err.find("surface: kept"), std::string::npos) << run;
}

TEST(Run, AFailedStepIsNamedAndTheOthersStay) {
  TemporaryFolder folder;
  makePhantom(folder);
  const auto run = explica(smallRun(folder, "out", {"--unfold.vertex", "99999999"}));
  EXPECT_EQ(run.exitCode, 2) << run;
  const auto states = statesOf(folder / "out");
  EXPECT_EQ(states.at("surface"), "done");
  EXPECT_EQ(states.at("unfold"), "failed");
  EXPECT_TRUE(fs::exists(folder / "out/surface/pial.surf.gii"));
  const std::string page = readText(folder / "out/report.html");
  EXPECT_NE(page.find("badge bad'>failed"), std::string::npos);
}

TEST(Run, AT1NeedsAnAtlas) {
  TemporaryFolder folder;
  makePhantom(folder);
  const auto run = explica({"run", folder / "phantom/t1.nii.gz", "--out", folder / "out"});
  EXPECT_EQ(run.exitCode, 2);
  EXPECT_NE(run.err.find("--atlas"), std::string::npos) << run;
}

}  // namespace
}  // namespace explica::testing
