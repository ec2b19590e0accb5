// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
// `explica unfold` on one person's pial surface at full resolution: its goal, and what must hold at
// any size.  Nothing here depends on the clock.

#include "QuickRuns.h"
#include "RealSurfaces.h"

#include "Explica/Geometry/SelfIntersection.h"

#include <algorithm>
#include <csignal>
#include <map>
#include <sstream>

namespace explica::testing {
namespace {

class UnfoldAtFullResolution : public RealSurfaces {
 protected:
  static std::vector<std::string> patch(const std::string& surround = "none") {
    return unfoldAbout(individual(), Vector(-1, 0.2, 0.2), 20, surround);
  }
};

TEST_F(UnfoldAtFullResolution, ReachesItsGoalWithItsNearContacts) {
  const TemporaryFolder folder;
  const auto result = explica(
      patch() + std::vector<std::string>{"--target-visibility", "0.97", "--out", folder / "out"});
  ASSERT_EQ(result.exitCode, 0) << result;
  const auto summary = readJson(folder / "out/summary.json");
  EXPECT_NEAR(summary["visibility_initial"], 0.337, 0.001);
  EXPECT_GE(summary["visibility_final"], 0.97);
  EXPECT_LE(summary["area_error_mean"], 0.005);
  EXPECT_LE(summary["edge_strain_mean"], 0.08);
  EXPECT_EQ(summary["self_intersections_final"], 0);
  // The start intersects elsewhere, and is reported.
  EXPECT_FALSE(summary["warnings"].empty());
  EXPECT_EQ(summary["self_intersections_initial"], 103);  // as an independent exact checker finds
  EXPECT_EQ(summary["self_intersections_initial_region"], 0);
  const std::string places = readText(folder / "out/intersections.tsv");
  EXPECT_EQ(std::count(places.begin(), places.end(), '\n'), 1 + 103);
}

TEST_F(UnfoldAtFullResolution, IsRepairedWhereItIntersects) {
  const TemporaryFolder folder;
  const auto result =
      explica(patch("fixed") + std::vector<std::string>{"--max-iterations", "2", "--repair",
                                                        "--out", folder / "out"});
  ASSERT_EQ(result.exitCode, 3) << result;
  const auto summary = readJson(folder / "out/summary.json");
  EXPECT_EQ(summary["self_intersections_initial"], 103);
  EXPECT_EQ(summary["self_intersections_repaired"], 103);
  EXPECT_EQ(summary["self_intersections_final"], 0);
  EXPECT_LE(summary["repair_move_max"], 1.0);  // mm; edges are 0.9 mm long
  EXPECT_LE(summary["repair_move_mean"], 0.1);
  EXPECT_LE(summary["repair_vertices_moved"], 2000);
}

TEST_F(UnfoldAtFullResolution, ThreadsDoNotChangeAnyByte) {
  const TemporaryFolder folder;
  const auto words = patch() + std::vector<std::string>{"--max-iterations", "6", "--frames", "3"};
  std::map<std::string, std::string> first;
  for (const std::string threads : {"1", "3"}) {
    const auto result =
        explica(words + std::vector<std::string>{"--threads", threads, "--out", folder / threads});
    ASSERT_EQ(result.exitCode, 3) << result;
    const auto hashes = stableHashes(folder / threads);
    EXPECT_EQ(hashes.count("unfolded.surf.gii"), 1u);
    EXPECT_EQ(hashes.count("frames/frame-0002.surf.gii"), 1u);
    if (first.empty()) first = hashes;
    EXPECT_EQ(hashes, first) << threads;
  }
}

/// Lines of evolution.tsv without its times, which are its last five columns.
std::vector<std::string> evolutionWithoutTimes(const std::string& path) {
  std::istringstream table(readText(path));
  std::vector<std::string> rows;
  for (std::string line; std::getline(table, line);) {
    for (int column = 0; column < 5; ++column) line.erase(line.rfind('\t'));
    rows.push_back(line);
  }
  return rows;
}

TEST_F(UnfoldAtFullResolution, InterruptedItResumesToTheBytesOfAnUninterruptedRun) {
  const TemporaryFolder folder;
  // A goal out of reach: whenever the signal comes, there is work left.
  const auto words =
      patch() + std::vector<std::string>{"--target-visibility", "1", "--frames", "3", "--verbose"};
  CommandSetting setting;
  setting.signal = SIGTERM;
  setting.signalWhen = "iteration 3";
  const auto stopped = explica(words + std::vector<std::string>{"--out", folder / "part"}, setting);
  ASSERT_EQ(stopped.exitCode, 3) << stopped;
  const auto part = readJson(folder / "part/summary.json");
  EXPECT_EQ(part["termination"], "interrupted");
  EXPECT_EQ(part["stop_reason"], "interrupted");
  EXPECT_EQ(part["self_intersections_final"], 0);
  EXPECT_EQ(readJson(folder / "part/provenance.json")["termination"], "interrupted");
  const int reached = part["iterations"];
  ASSERT_GE(reached, 3);
  EXPECT_EQ(static_cast<int>(evolutionWithoutTimes(folder / "part/evolution.tsv").size()),
            1 + 1 + reached);

  const auto limit = std::vector<std::string>{"--max-iterations", std::to_string(reached + 3)};
  const auto resumed =
      explica(words + limit + std::vector<std::string>{"--resume", "--out", folder / "part"});
  const auto whole = explica(words + limit + std::vector<std::string>{"--out", folder / "whole"});
  ASSERT_EQ(resumed.exitCode, 3) << resumed;
  ASSERT_EQ(whole.exitCode, 3) << whole;
  EXPECT_EQ(stableHashes(folder / "part"), stableHashes(folder / "whole"));
  EXPECT_EQ(evolutionWithoutTimes(folder / "part/evolution.tsv"),
            evolutionWithoutTimes(folder / "whole/evolution.tsv"));
}

}  // namespace
}  // namespace explica::testing
