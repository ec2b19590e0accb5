// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
// A provenance.json may come from a stranger: whatever stands in it, verify and history only look,
// replay writes below --out only, --force removes only its own, and each refusal is a sentence.

#include "Explica/Testing/Command.h"

#include <gtest/gtest.h>

#include <sys/stat.h>

#include <functional>

namespace explica::testing {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

class StrangersRecord : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto made = explica({"phantom", "shell", "--size", "8", "--out", folder_ / "a"});
    ASSERT_EQ(made.exitCode, 0) << made;
    honest_ = readJson(folder_ / "a/provenance.json");
  }

  /// Puts a record beside the honest one's files.
  void put(const Json& record) const { writeText(folder_ / "a/provenance.json", record.dump()); }

  /// A record of `explica surface` on the phantom's labels.
  [[nodiscard]] Json surfaceRecord() const {
    Json record = honest_;
    record["command"] = "surface";
    record["options"] = {{"white-label", {1}}, {"grey-label", {2}}, {"faces", 400}};
    const std::string labels = folder_ / "a/labels.nii.gz";
    for (const Json& output : honest_["outputs"]) {
      if (output["path"] != "labels.nii.gz") continue;
      record["inputs"] = {{{"role", "SEG"},
                           {"name", "labels.nii.gz"},
                           {"size", output["size"]},
                           {"sha256", output["sha256"]}}};
    }
    record["execution"]["inputs"] = {{{"role", "SEG"}, {"given", labels}, {"absolute", labels}}};
    record["execution"]["arguments"] = {{"SEG", labels}};
    return record;
  }

  TemporaryFolder folder_;
  Json honest_;
};

TEST_F(StrangersRecord, IsReplayedBelowOutOnly) {
  put(surfaceRecord());
  const auto good = explica({"replay", folder_ / "a", "--out", folder_ / "good"});
  ASSERT_EQ(good.exitCode, 3) << good;  // other outputs than the phantom's
  ASSERT_TRUE(fs::exists(folder_ / "good/white.surf.gii"));

  const std::string secret = folder_ / "secret.txt", fifo = folder_ / "fifo";
  writeText(secret, "nobody's business");
  ASSERT_EQ(mkfifo(fifo.c_str(), 0600), 0);
  const auto input = [](Json& record, const std::string& path) {
    record["execution"]["inputs"][0] = {{"role", "SEG"}, {"given", path}};
    record["execution"]["arguments"]["SEG"] = path;
  };
  const struct {
    std::function<void(Json&)> change;
    std::string said;
  } rows[] = {
      {[&](Json& r) { r["options"]["freesurfer"] = folder_ / "evil"; }, "lies outside --out"},
      {[&](Json& r) { r["options"]["freesurfer"] = "../evil"; }, "lies outside --out"},
      {[&](Json& r) { r["options"]["freesurfer"] = "x/../../evil"; }, "lies outside --out"},
      {[&](Json& r) { r["options"]["freesurfer"] = "evil\nsame  a"; }, "lies outside --out"},
      {[&](Json& r) { r["execution"]["arguments"]["SEG"] = secret; }, "none of the inputs"},
      {[&](Json& r) { r["execution"]["arguments"]["SEG"] = "/etc/passwd"; }, "none of the inputs"},
      {[&](Json& r) { r["execution"]["arguments"]["atlas"] = secret; }, "none of the inputs"},
      {[&](Json& r) { r["options"]["atlas"] = secret; }, "none of the inputs"},
      {[&](Json& r) { input(r, "/dev/zero"); }, "not a regular file"},
      {[&](Json& r) { input(r, fifo); }, "not a regular file"},
      {[&](Json& r) { input(r, folder_ / "none.nii"); }, "no such file"},
      {[&](Json& r) { r["command"] = "replay"; }, "is not replayed"},
      {[&](Json& r) { r["command"] = "verify"; }, "is not replayed"},
      {[&](Json& r) { r["command"] = "no such"; }, "is not known to this version"},
      {[&](Json& r) { r["options"]["out"] = folder_ / "evil"; }, "does not know"},
      {[&](Json& r) { r["options"]["log"] = folder_ / "evil"; }, "does not know"},
      {[&](Json& r) { r["options"]["config"] = secret; }, "does not know"},
      {[&](Json& r) { r["options"]["faces"] = "many"; }, "'many' is not a whole number"},
      {[&](Json& r) { r["options"]["faces"] = Json::object(); }, "is not"},
      {[&](Json& r) {
         r["command"] = "view";
         r["options"] = {{"screenshot", folder_ / "evil.png"}};
       },
       "is not replayed"},
      {[&](Json& r) {
         r["command"] = "report";
         r["options"] = {{"page", folder_ / "evil.html"}};
         r["execution"]["arguments"] = {{"DIR", folder_ / "a"}};
       },
       "is not replayed"},
      {[&](Json& r) {
         r["command"] = "study participant";
         r["execution"]["arguments"] = {{"STUDY", secret}, {"OUT_DIR", folder_ / "evil"}};
       },
       "is not replayed"},
  };
  const auto before = folder_.entries();
  for (const auto& row : rows) {
    Json record = surfaceRecord();
    row.change(record);
    put(record);
    const auto result = explica({"replay", folder_ / "a", "--out", folder_ / "b"});
    EXPECT_EQ(result.exitCode, 2) << record.dump() << "\n" << result;
    EXPECT_NE(result.err.find(row.said), std::string::npos) << row.said << "\n" << result;
    EXPECT_EQ(folder_.entries(), before) << row.said;
  }
}

TEST_F(StrangersRecord, OfBidsWritesIntoOutInsteadOfItsOwnFolder) {
  Json record = surfaceRecord();
  record["command"] = "bids";
  record["options"] = {{"LEVEL", "participant"}};
  record["execution"]["arguments"] = {{"BIDS_DIR", folder_ / "a"}, {"OUT_DIR", folder_ / "evil"}};
  put(record);
  static_cast<void>(explica({"replay", folder_ / "a", "--out", folder_ / "b"}));
  EXPECT_FALSE(fs::exists(folder_ / "evil"));
}

TEST_F(StrangersRecord, CannotSayThatAFilledFolderIsToBeResumed) {
  Json record = honest_;
  record["command"] = "polygon";
  record["options"] = {{"phantom", "polygon19"}, {"resume", true}, {"max-iterations", 1}};
  put(record);
  fs::create_directory(folder_ / "b");
  writeText(folder_ / "b/mine.txt", "mine");
  const auto result = explica({"replay", folder_ / "a", "--out", folder_ / "b"});
  EXPECT_EQ(result.exitCode, 1) << result;
  EXPECT_NE(result.err.find("not empty"), std::string::npos) << result;
}

TEST_F(StrangersRecord, NamesOutputsWithinItsFolderOnly) {
  const std::string outside = folder_ / "outside.txt";
  writeText(outside, "outside");
  Json entry = {{"path", ""}, {"size", 7}, {"sha256", ""}};
  for (const Json& output : honest_["outputs"]) {
    if (output.contains("sha256")) entry["sha256"] = output["sha256"];
  }
  for (const std::string& name :
       {std::string("../outside.txt"), outside, std::string("x/../../outside.txt"), std::string(),
        std::string("labels.nii.gz\nsame     output evil"), std::string("\x1b[2Ja")}) {
    for (const bool varying : {false, true}) {
      Json record = honest_;
      entry["path"] = name;
      (varying ? record["execution"]["varying_outputs"] : record["outputs"]).push_back(entry);
      put(record);
      for (const std::vector<std::string>& words :
           {std::vector<std::string>{"verify", folder_ / "a"},
            std::vector<std::string>{"history", folder_ / "a"},
            std::vector<std::string>{"replay", folder_ / "a", "--out", folder_ / "b"}}) {
        const auto result = explica(words);
        EXPECT_EQ(result.exitCode, 2) << result;
        EXPECT_NE(result.err.find("is no name in its folder"), std::string::npos) << result;
        EXPECT_EQ((result.out + result.err).find('\x1b'), std::string::npos);
      }
    }
  }
  EXPECT_TRUE(fs::exists(outside));
}

TEST_F(StrangersRecord, CannotRemoveOrVouchForFilesThroughLinks) {
  // A folder "sub" that is a link to elsewhere, and the hash of a file there.
  fs::create_directory(folder_ / "elsewhere");
  fs::rename(folder_ / "a/labels.nii.gz", folder_ / "elsewhere/labels.nii.gz");
  fs::create_directory_symlink(folder_ / "elsewhere", folder_ / "a/sub");
  Json record = honest_;
  for (Json& output : record["outputs"]) {
    if (output["path"] == "labels.nii.gz") output["path"] = "sub/labels.nii.gz";
  }
  put(record);
  const auto verified = explica({"verify", folder_ / "a"});
  EXPECT_EQ(verified.exitCode, 2) << verified;
  EXPECT_NE(verified.out.find("CHANGED  output sub/labels.nii.gz"), std::string::npos) << verified;
  const auto forced =
      explica({"phantom", "shell", "--size", "8", "--force", "--out", folder_ / "a"});
  EXPECT_EQ(forced.exitCode, 0) << forced;
  EXPECT_TRUE(fs::exists(folder_ / "elsewhere/labels.nii.gz"));
}

TEST_F(StrangersRecord, ThatListsItselfEnds) {
  Json record = honest_;
  record["outputs"].push_back({{"path", "provenance.json"}, {"varies", true}});
  put(record);
  const auto result = explica({"replay", folder_ / "a", "--out", folder_ / "b"});
  EXPECT_NE(result.exitCode, 139) << result;
  EXPECT_EQ(result.err.find("internal error"), std::string::npos) << result;
}

TEST_F(StrangersRecord, NestedWithoutEndIsRefused) {
  std::string deep;
  for (int n = 0; n < 100000; ++n) deep += "{\"a\":";
  writeText(folder_ / "a/provenance.json", deep);
  writeText(folder_ / "deep.json", deep);
  for (const std::vector<std::string>& words :
       {std::vector<std::string>{"verify", folder_ / "a"},
        std::vector<std::string>{"history", folder_ / "a"},
        std::vector<std::string>{"report", folder_ / "a"},
        std::vector<std::string>{"replay", folder_ / "a", "--out", folder_ / "b"},
        std::vector<std::string>{"phantom", "shell", "--config", folder_ / "deep.json", "--out",
                                 folder_ / "c"}}) {
    const auto result = explica(words);
    EXPECT_EQ(result.exitCode, 2) << result;
    EXPECT_NE(result.err.find("is nested more than 64 levels deep"), std::string::npos) << result;
  }
}

/// Every place in a value, the value itself first.
void eachPlace(const Json& value, const Json::json_pointer& place,
               std::vector<Json::json_pointer>& all) {
  all.push_back(place);
  if (!value.is_structured()) return;
  for (const auto& [key, inner] : value.items()) eachPlace(inner, place / key, all);
}

TEST_F(StrangersRecord, WithWrongTypesAnywhereGetsASentence) {
  const std::vector<Json> wrong = {
      nullptr, 7, -1.5, "x", Json::array(), Json::object(), true, "../../../etc/passwd"};
  std::vector<Json::json_pointer> places;
  Json record = surfaceRecord();
  eachPlace(record, Json::json_pointer(), places);
  ASSERT_GT(places.size(), 80u);
  for (std::size_t n = 0; n < places.size(); ++n) {
    Json changed = record;
    changed[places[n]] = wrong[(n + n / 4) % wrong.size()];
    put(changed);
    const std::vector<std::vector<std::string>> commands = {
        {"verify", folder_ / "a", "--deep"},
        {"history", folder_ / "a"},
        {"verify", folder_ / "a", "--prov-json"},
        {"replay", folder_ / "a", "--dry-run", "--out", folder_ / "b"}};
    const auto result = explica(commands[n % commands.size()]);
    EXPECT_LE(result.exitCode, 3) << places[n] << changed[places[n]] << "\n" << result;
    EXPECT_EQ(result.err.find("internal error"), std::string::npos) << places[n] << result;
  }
}

TEST_F(StrangersRecord, WithAWrongSummaryBesideItGetsASentence) {
  for (const std::string text : {"[]", "7", "{\"plausible\": 3}", "{\"flags\": [7]}",
                                 "{\"warnings\": {}}", "{\"frame_visibilities\": [\"x\"]}"}) {
    writeText(folder_ / "a/summary.json", text);
    const auto result = explica({"report", folder_ / "a"});
    EXPECT_LE(result.exitCode, 3) << text << result;
    EXPECT_EQ(result.err.find("internal error"), std::string::npos) << text << result;
  }
}

}  // namespace
}  // namespace explica::testing
