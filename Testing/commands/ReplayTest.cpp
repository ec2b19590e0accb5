// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
// verify, replay and history.

#include "QuickRuns.h"

#include <gtest/gtest.h>

namespace explica::testing {
namespace {

namespace fs = std::filesystem;

class Replay : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto made =
        explica({"phantom", "shell", "--size", "12", "--aspect", "1,1,2", "--out", folder_ / "a"});
    ASSERT_EQ(made.exitCode, 0) << made;
  }

  TemporaryFolder folder_;
};

TEST_F(Replay, ReproducesEveryOutput) {
  const auto result = explica({"replay", folder_ / "a/provenance.json", "--out", folder_ / "b"});
  EXPECT_EQ(result.exitCode, 0) << result;
  EXPECT_TRUE(contains(result.out, "identical  labels.nii.gz")) << result;
  EXPECT_EQ(stableHashes(folder_ / "a"), stableHashes(folder_ / "b"));
  const auto first = readJson(folder_ / "a/provenance.json");
  auto second = readJson(folder_ / "b/provenance.json");
  EXPECT_EQ(first["id"], second["id"]);
  for (const auto& [key, value] : first.items()) {
    if (key == "execution") continue;
    EXPECT_EQ(value, second[key]) << key;
  }
}

TEST_F(Replay, NamesAnOutputThatDiffers) {
  auto record = readJson(folder_ / "a/provenance.json");
  record["outputs"][0]["sha256"] = std::string(64, '0');
  writeText(folder_ / "a/provenance.json", record.dump());
  const auto result = explica({"replay", folder_ / "a/provenance.json", "--out", folder_ / "b"});
  EXPECT_EQ(result.exitCode, 3) << result;
  EXPECT_TRUE(contains(result.out, "DIFFERENT  harmonic.nii.gz")) << result;
}

TEST_F(Replay, RefusesWhatIsNoRecord) {
  writeText(folder_ / "no.json", "{\"a\": 1}");
  const auto result = explica({"replay", folder_ / "no.json", "--out", folder_ / "b"});
  EXPECT_EQ(result.exitCode, 2) << result;
  EXPECT_TRUE(contains(result.err, "not a provenance record")) << result;
  EXPECT_FALSE(fs::exists(folder_ / "b"));
}

TEST_F(Replay, VerifyFindsAFlippedByte) {
  EXPECT_EQ(explica({"verify", folder_ / "a/provenance.json"}).exitCode, 0);
  for (const char* name : {"labels.nii.gz", "level.nii.gz", "summary.json"}) {
    std::string text = readText(folder_ / "a" + ("/" + std::string(name)));
    const std::string whole = text;
    text[text.size() / 2] = static_cast<char>(text[text.size() / 2] ^ 1);
    writeText(folder_ / "a" + ("/" + std::string(name)), text);
    const auto result = explica({"verify", folder_ / "a/provenance.json"});
    EXPECT_EQ(result.exitCode, 2) << name << result;
    EXPECT_TRUE(contains(result.out, "CHANGED  output " + std::string(name))) << result;
    writeText(folder_ / "a" + ("/" + std::string(name)), whole);
  }
  fs::remove(folder_ / "a/level.nii.gz");
  const auto missing = explica({"verify", folder_ / "a"});
  EXPECT_EQ(missing.exitCode, 2);
  EXPECT_TRUE(contains(missing.out, "MISSING  output level.nii.gz")) << missing;
}

TEST_F(Replay, ProvJsonHasAnActivityAndItsOutputs) {
  const auto result = explica({"verify", folder_ / "a/provenance.json", "--prov-json"});
  ASSERT_EQ(result.exitCode, 0) << result;
  const auto prov = nlohmann::json::parse(result.out);
  EXPECT_EQ(prov["activity"].size(), 1u);
  const auto record = readJson(folder_ / "a/provenance.json");
  const auto outputs = record["outputs"].size();
  EXPECT_GE(outputs, 3u);
  EXPECT_EQ(prov["entity"].size(), outputs);
}

TEST_F(Replay, HistoryTellsTheCommandLine) {
  const auto result = explica({"history", folder_ / "a/labels.nii.gz"});
  ASSERT_EQ(result.exitCode, 0) << result;
  EXPECT_TRUE(contains(result.out, "phantom shell --size 12")) << result;
  EXPECT_TRUE(contains(result.out, " s; done)")) << result;
}

/// What the run chose for its steps, and what the user said although it is the default.
TEST_F(Replay, OfARunLeavesTheChoicesForItsStepsToTheRun) {
  ASSERT_EQ(explica({"phantom", "cortex", "--size", "32", "--spacing", "2", "--out", folder_ / "p"})
                .exitCode,
            0);
  writeSides(folder_);
  std::vector<std::string> words = {"run",
                                    folder_ / "p/t1.nii.gz",
                                    "--atlas",
                                    folder_ / "sides.nii.gz",
                                    "--hemisphere",
                                    "L",
                                    "--template",
                                    "none",
                                    "--steps",
                                    "segment,surface",
                                    "--surface.faces",
                                    "1000"};
  std::string pial;
  for (const std::string out : {"chosen", "said"}) {
    if (out == "said") words = words + std::vector<std::string>{"--surface.fluid", "0"};
    // The phantom's brain is smaller than a person's: doubtful.
    ASSERT_EQ(explica(words + std::vector<std::string>{"--out", folder_ / out}).exitCode, 3);
    const auto result = explica({"replay", folder_ / out, "--out", folder_ / ("again-" + out)});
    EXPECT_EQ(result.exitCode, 0) << result;
    const std::string made = readText(folder_ / (out + "/surface/pial.surf.gii"));
    EXPECT_NE(made, pial) << "the option has no effect";
    pial = made;
  }
}

}  // namespace
}  // namespace explica::testing
