// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
// explica polygon and explica embed: stop and resume, coefficients.

#include "Explica/Core/WholeFile.h"
#include "QuickRuns.h"

#include <gtest/gtest.h>

#include <signal.h>

namespace explica::testing {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

TEST(Polygon, ResumedWritesTheBytesOfAnUninterruptedRun) {
  const TemporaryFolder folder;
  const std::vector<std::string> words = {"polygon", "--phantom", "polygon34", "--frames", "5"};
  const auto whole = explica(words + std::vector<std::string>{"--out", folder / "whole"});
  ASSERT_EQ(whole.exitCode, 0) << whole;
  const auto part =
      explica(words + std::vector<std::string>{"--max-iterations", "20", "--out", folder / "part"});
  ASSERT_EQ(part.exitCode, 3) << part;
  EXPECT_NE(stableHashes(folder / "part"), stableHashes(folder / "whole"));
  const auto resumed =
      explica(words + std::vector<std::string>{"--resume", "--out", folder / "part"});
  ASSERT_EQ(resumed.exitCode, 0) << resumed;
  EXPECT_EQ(stableHashes(folder / "part"), stableHashes(folder / "whole"));
  EXPECT_EQ(readJson(folder / "part/summary.json")["iterations"],
            readJson(folder / "whole/summary.json")["iterations"]);
  EXPECT_EQ(explica({"verify", folder / "part"}).exitCode, 0);
}

TEST(Polygon, SignalLeavesAMarkedStateThatResumes) {
  const TemporaryFolder folder;
  // Steps so short that the signal comes long before the goal.
  const std::vector<std::string> words = {"polygon", "--phantom",       "polygon34", "--method",
                                          "thesis",  "--explicit-step", "1e-5",      "--stages",
                                          "2",       "--out",           folder / "a"};
  CommandSetting setting;
  setting.signal = SIGINT;
  setting.signalWhen = "unfolding";
  const auto stopped = explica(words, setting);
  ASSERT_EQ(stopped.exitCode, 3) << stopped;
  EXPECT_EQ(readJson(folder / "a/provenance.json")["termination"], "interrupted");
  const auto summary = readJson(folder / "a/summary.json");
  EXPECT_EQ(summary["stop_reason"], "interrupted");
  EXPECT_EQ(summary["self_intersections_final"], 0);
  const int reached = summary["iterations"];
  EXPECT_EQ(explica({"verify", folder / "a"}).exitCode, 0);

  const auto further = explica(words + std::vector<std::string>{"--resume", "--max-iterations",
                                                                std::to_string(reached + 25)});
  ASSERT_EQ(further.exitCode, 3) << further;
  EXPECT_EQ(readJson(folder / "a/summary.json")["iterations"], reached + 25);
  EXPECT_EQ(readJson(folder / "a/summary.json")["stop_reason"], "max-iterations");
}

TEST(Polygon, WrongStatesAreRefusedInOneSentence) {
  const TemporaryFolder folder;
  const std::vector<std::string> words = {"polygon", "--phantom", "polygon19", "--out",
                                          folder / "a"};
  ASSERT_EQ(explica(words + std::vector<std::string>{"--max-iterations", "3"}).exitCode, 3);
  const auto other = explica(words + std::vector<std::string>{"--resume", "--region", "0:18"});
  EXPECT_EQ(other.exitCode, 2) << other;
  EXPECT_NE(other.err.find("another region"), std::string::npos) << other;
  writeText(folder / "a/polygon.state", "{\"kind\": \"letter\"}");
  const auto damaged = explica(words + std::vector<std::string>{"--resume"});
  EXPECT_EQ(damaged.exitCode, 2) << damaged;
  EXPECT_NE(damaged.err.find("not a complete state"), std::string::npos) << damaged;
  fs::remove(folder / "a/polygon.state");
  EXPECT_EQ(explica(words + std::vector<std::string>{"--resume"}).exitCode, 2);
}

/// A ring with waves.
void writeWavyRing(const std::string& file, Eigen::Index vertices) {
  Positions2 ring(vertices, 2);
  for (Eigen::Index v = 0; v < vertices; ++v) {
    const double t = 2 * kPi * static_cast<double>(v) / static_cast<double>(vertices);
    ring.row(v) << std::cos(t), std::sin(t);
    ring.row(v) *= 50 + 5 * std::sin(40 * t);
  }
  io::writePolygonCsv(file, ring);
}

TEST(Polygon, SaysHowLongWorkTakesThatGrowsWithTheSquare) {
  const TemporaryFolder folder;
  writeWavyRing(folder / "ring.csv", 6000);
  CommandSetting setting;
  setting.signal = SIGTERM;
  setting.signalWhen = "--knot auto or tree";
  const auto told = explica({"polygon", folder / "ring.csv", "--region", "100:2900", "--direction",
                             "0,1", "--knot", "all-pairs", "--out", folder / "out"},
                            setting);
  EXPECT_EQ(told.exitCode, 3) << told;
  EXPECT_NE(told.err.find("pairs of edges, about "), std::string::npos) << told;
  EXPECT_NE(told.err.find("--knot auto or tree sums it in n log n"), std::string::npos) << told;
}

TEST(Polygon, OfFiftyThousandVerticesTakesLessThanTenSecondsOfOneProcessor) {
  const TemporaryFolder folder;
  writeWavyRing(folder / "ring.csv", 50000);
  // Processor time, of which the system ends what takes more: a busy machine is no fault.
  CommandSetting here;
  here.directory = folder.path();
  const auto done = runProgram({"bash", "-c",
                                "ulimit -t 10; exec '" EXPLICA_EXECUTABLE
                                "' polygon ring.csv --region 1000:24000 --direction 0,1 "
                                "--max-iterations 3 --out out"},
                               here);
  EXPECT_EQ(done.exitCode, 3) << done;  // 137 or 152: it took longer
}

TEST(Polygon, LooksFromALine) {
  const TemporaryFolder folder;
  const auto made = explica({"polygon", "--phantom", "polygon19", "--view-line",
                             "-400,4000,500,4000", "--out", folder / "a"});
  ASSERT_EQ(made.exitCode, 0) << made;
  EXPECT_GE(readJson(folder / "a/summary.json")["visibility_final"], 0.995);
  EXPECT_EQ(
      explica({"polygon", "--phantom", "polygon19", "--view-line", "1,2,3", "--out", folder / "b"})
          .exitCode,
      1);
  EXPECT_EQ(explica({"polygon", "--out", folder / "c"}).exitCode, 1) << "neither file nor phantom";
}

TEST(Polygon, LooksFromSeveralPointsWithWeights) {
  const TemporaryFolder folder;
  const std::vector<std::string> words = {"polygon",     "--phantom",     "polygon19",
                                          "--viewpoint", "-400,4000",     "--viewpoint",
                                          "500,4000",    "--view-weights"};
  const auto made = explica(words + std::vector<std::string>{"3,1", "--out", folder / "a"});
  ASSERT_EQ(made.exitCode, 0) << made;
  const auto summary = readJson(folder / "a/summary.json");
  EXPECT_EQ(summary["viewpoint"], Json::parse("[-400, 4000, 500, 4000]"));
  EXPECT_EQ(summary["viewpoint_weights"], Json::parse("[0.75, 0.25]"));
  EXPECT_GE(summary["visibility_final"], 0.995);
  EXPECT_NEAR(summary["real_visibility_final"], summary["visibility_final"], 1e-6);
  EXPECT_EQ(readJson(folder / "a/provenance.json")["options"]["viewpoint"],
            Json::parse("[[-400, 4000], [500, 4000]]"));
  EXPECT_EQ(explica({"replay", folder / "a", "--out", folder / "b"}).exitCode, 0);
  const auto few = explica(words + std::vector<std::string>{"1", "--out", folder / "c"});
  EXPECT_EQ(few.exitCode, 2) << few;
  EXPECT_NE(few.err.find("one positive number a viewpoint"), std::string::npos) << few;
}

TEST(Polygon, TheKnotEnergyAloneKeepsTheThesisPolygonsFromCrossing) {
  const TemporaryFolder folder;
  const auto made = explica({"polygon", "--phantom", "polygon34", "--method", "thesis",
                             "--no-collision", "--out", folder / "a"});
  ASSERT_EQ(made.exitCode, 0) << made;
  const auto summary = readJson(folder / "a/summary.json");
  EXPECT_GE(summary["visibility_final"], 0.995);
  EXPECT_EQ(summary["first_crossing"], -1);
}

TEST(Embed, ReadsItsCoefficientsBackAndAveragesThem) {
  const TemporaryFolder folder;
  writeEllipse(folder / "a.csv", 18, 13);
  writeEllipse(folder / "b.csv", 14, 17);
  for (const std::string name : {"a", "b"}) {
    const auto made =
        explica({"embed", folder / (name + ".csv"), "--center", "0,0,0", "--inner-radius", "8",
                 "--outer-radius", "26", "--out", folder / name});
    ASSERT_EQ(made.exitCode, 0) << made;
    const auto summary = readJson(folder / (name + "/summary.json"));
    EXPECT_LT(summary["distance_max"].get<double>(), 0.5 * summary["voxel"].get<double>());
    EXPECT_GT(summary["boundary_margin"], 0);
  }
  const auto json = readJson(folder / "a/coefficients.json");
  EXPECT_EQ(json["inner"].size(), 2 * json["order"].get<std::size_t>() + 1);
  const auto mean =
      explica({"embed", folder / "a/coefficients.json", folder / "b/coefficients.json", "--average",
               "--out", folder / "mean"});
  ASSERT_EQ(mean.exitCode, 0) << mean;
  const auto averaged = readJson(folder / "mean/coefficients.json");
  EXPECT_NEAR(averaged["inner"][0].get<double>(),
              0.5 * (json["inner"][0].get<double>() +
                     readJson(folder / "b/coefficients.json")["inner"][0].get<double>()),
              1e-14);
}

TEST(Embed, CoefficientsOfAnotherKindOfAnnulusAreRefused) {
  const TemporaryFolder folder;
  writeTextFile(folder / "old.json", R"({"kind": "given annulus", "order": 2})");
  const auto made = explica({"embed", folder / "old.json", "--out", folder / "x"});
  EXPECT_EQ(made.exitCode, 2) << made;
  EXPECT_NE(made.err.find("'given annulus' found"), std::string::npos) << made;
}

}  // namespace
}  // namespace explica::testing
