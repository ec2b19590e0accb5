// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Core/Errors.h"
#include "Explica/Provenance/Export.h"
#include "Explica/Provenance/Verify.h"

#include <gtest/gtest.h>

#include <unistd.h>

#include <fstream>

namespace explica::provenance {
namespace {

namespace fs = std::filesystem;

/// Two steps: raw.txt -> step1/a.txt -> step2/b.txt, each with its record.
class RecordChain : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("explica-record-" + std::to_string(getpid()));
    fs::remove_all(folder_);
    fs::create_directories(folder_ / "step1");
    fs::create_directories(folder_ / "step2");
    write("raw.txt", "raw");
    write("step1/a.txt", "made of raw");
    write("step2/b.txt", "made of a");
    writeRecord("first", "raw.txt", "step1", "a.txt");
    writeRecord("second", "step1/a.txt", "step2", "b.txt");
  }
  void TearDown() override { fs::remove_all(folder_); }

  void write(const fs::path& name, const std::string& text) {
    std::ofstream(folder_ / name, std::ios::binary) << text;
  }

  void writeRecord(const std::string& command, const fs::path& input, const fs::path& step,
                   const std::string& output) {
    Record record;
    record.command = command;
    InputFile in;
    in.role = "FILE";
    in.given = folder_ / input;
    in.absolute = in.given;
    in.digest = digestOf(in.given);
    if (const auto found = findRecordOf(in.given, in.digest)) {
      in.parent = Parent{found->record["id"], digestOf(found->path).sha256, found->path};
    }
    record.inputs = {in};
    record.outputs = {{output, digestOf(folder_ / step / output), false}};
    record.termination = Termination::Converged;
    writeJson(folder_ / step / kRecordName, toJson(record));
  }

  fs::path folder_;
};

TEST_F(RecordChain, ObeysItsSchema) {
  const Json record = readJson(folder_ / "step2" / kRecordName);
  EXPECT_TRUE(schemaFaults(record, recordSchema()).empty());
  Json damaged = record;
  damaged["inputs"][0]["sha256"] = "short";
  EXPECT_FALSE(schemaFaults(damaged, recordSchema()).empty());
  damaged = record;
  damaged.erase("command");
  EXPECT_FALSE(schemaFaults(damaged, recordSchema()).empty());
}

TEST_F(RecordChain, ARecordThatChangesIsReadAnew) {
  const fs::path file = folder_ / "step1/a.txt";
  const Digest before = digestOf(file);
  ASSERT_TRUE(findRecordOf(file, before)->sameContent);
  write("step1/a.txt", "other words");
  EXPECT_FALSE(findRecordOf(file, digestOf(file))->sameContent);
  writeRecord("first", "raw.txt", "step1", "a.txt");
  EXPECT_TRUE(findRecordOf(file, digestOf(file))->sameContent);
  fs::remove(folder_ / "step1" / kRecordName);
  EXPECT_FALSE(findRecordOf(file, digestOf(file)));
}

/// What a study has copied to BIDS names is found among its runs, and among those that come later.
TEST_F(RecordChain, ACopyIsFoundInItsRun) {
  const auto runOf = [&](const std::string& label) {
    const fs::path step = fs::path("study/runs/sub-" + label + "_hemi-L/surface");
    fs::create_directories(folder_ / step);
    write(step / "white.surf.gii", "surface of " + label);
    writeRecord("surface", "raw.txt", step, "white.surf.gii");
  };
  const auto copyOf = [&](const std::string& label) {
    const fs::path anat = "study/sub-" + label + "/anat";
    fs::create_directories(folder_ / anat);
    write(anat / ("sub-" + label + "_hemi-L_white.surf.gii"), "surface of " + label);
    const fs::path copy = folder_ / anat / ("sub-" + label + "_hemi-L_white.surf.gii");
    return findRecordOf(copy, digestOf(copy));
  };
  runOf("1");
  ASSERT_TRUE(copyOf("1"));
  EXPECT_NE(copyOf("1")->path.string().find("sub-1_hemi-L/surface"), std::string::npos);
  EXPECT_FALSE(copyOf("2"));
  runOf("2");
  EXPECT_TRUE(copyOf("2"));
}

TEST_F(RecordChain, UntouchedFilesVerify) {
  const Verification v = verifyRecord(folder_ / "step2" / kRecordName, true);
  EXPECT_TRUE(v.allSame());
  EXPECT_EQ(v.records, 2);
}

TEST_F(RecordChain, AFlippedByteIsFoundInInputAndOutput) {
  write("step2/b.txt", "made of A");
  EXPECT_FALSE(verifyRecord(folder_ / "step2" / kRecordName).allSame());
  write("step2/b.txt", "made of a");
  EXPECT_TRUE(verifyRecord(folder_ / "step2" / kRecordName).allSame());
  write("step1/a.txt", "made of Raw");
  EXPECT_FALSE(verifyRecord(folder_ / "step2" / kRecordName).allSame());
}

TEST_F(RecordChain, DeepLooksThroughParents) {
  write("raw.txt", "RAW");
  EXPECT_TRUE(verifyRecord(folder_ / "step2" / kRecordName, false).allSame());
  EXPECT_FALSE(verifyRecord(folder_ / "step2" / kRecordName, true).allSame());
}

TEST_F(RecordChain, MovedFolderStillVerifies) {
  const fs::path moved = folder_.string() + "-moved";
  fs::remove_all(moved);
  fs::create_directories(moved);
  fs::copy_file(folder_ / "step1/a.txt", moved / "a.txt");
  fs::copy(folder_ / "step2", moved, fs::copy_options::recursive);
  fs::remove(folder_ / "step1/a.txt");
  EXPECT_TRUE(verifyRecord(moved / kRecordName).allSame());
  fs::remove_all(moved);
}

TEST_F(RecordChain, HistoryNamesEveryStep) {
  const std::string text = historyOf(folder_ / "step2/b.txt");
  EXPECT_NE(text.find("explica second"), std::string::npos);
  EXPECT_NE(text.find("explica first"), std::string::npos);
  EXPECT_LT(text.find("explica second"), text.find("explica first"));
  EXPECT_NE(text.find("raw.txt"), std::string::npos);
  EXPECT_THROW((void)historyOf(folder_ / "raw.txt"), InvalidInput);
}

TEST_F(RecordChain, EqualWorkHasEqualIdWhereverItRan) {
  Record a;
  a.command = "thickness";
  a.options = {{"layers", 3}};
  a.inputs = {{"SEG", "x/seg.nii.gz", "/x/seg.nii.gz", Digest{3, std::string(64, 'a')}, {}}};
  Record b = a;
  b.inputs[0].given = "elsewhere/other.nii.gz";
  b.threads = 7;
  b.seconds = 12;
  EXPECT_EQ(a.id(), b.id());
  b.options["layers"] = 4;
  EXPECT_NE(a.id(), b.id());
}

TEST_F(RecordChain, PrivateRecordHoldsNoHostUserOrFolder) {
  Record record;
  record.command = "x";
  record.withNames = false;
  record.directory = "/home/somebody";
  const Json execution = toJson(record)["execution"];
  EXPECT_FALSE(execution["machine"].contains("host"));
  EXPECT_FALSE(execution["machine"].contains("user"));
  EXPECT_FALSE(execution.contains("directory"));
}

TEST_F(RecordChain, ProvJsonLinksInputActivityOutput) {
  const fs::path last = folder_ / "step2" / kRecordName;
  const Json prov = toProvJson({{last, readRecord(last)}});
  EXPECT_EQ(prov["entity"].size(), 2u);
  EXPECT_EQ(prov["used"].size(), 1u);
  EXPECT_EQ(prov["wasGeneratedBy"].size(), 2u);  // the output, and the input by its own record
}

TEST_F(RecordChain, ExportsGoBackToTheFirstInput) {
  const auto records = recordsBehind(folder_ / "step2" / kRecordName);
  ASSERT_EQ(records.size(), 2u);
  const Json prov = toProvJson(records);
  EXPECT_EQ(prov["entity"].size(), 3u);  // raw, a, b
  EXPECT_EQ(prov["activity"].size(), 2u);
  EXPECT_EQ(prov["used"].size(), 2u);
  EXPECT_EQ(prov["wasGeneratedBy"].size(), 2u);
  EXPECT_EQ(recordsBelow(folder_).size(), 2u);
}

TEST(Printable, TakesTheTeethOutOfWhatATerminalWouldObey) {
  EXPECT_EQ(printable("a\x1b[2Jb\x7f\rc"), "a?[2Jb??c");
  EXPECT_EQ(printable("\xc2\x9b"
                      "2J, \xe2\x80\xaegpj.exe, \xe2\x81\xa6x"),
            "?2J, ?gpj.exe, ?x");
  EXPECT_EQ(printable("a\nerror: b\tc"), "a?error: b?c");
  const std::string usual = "Größe 3 µm – 日本 two";
  EXPECT_EQ(printable(usual), usual);
  EXPECT_EQ(printable("\xc2"), "\xc2");  // cut short: nothing behind it is read
}

TEST(Privacy, FoldersAreTakenOutOfSentences) {
  EXPECT_EQ(textWithoutFolders("/home/jane/a.nii.gz: label 2 absent (found 0, 1)"),
            "a.nii.gz: label 2 absent (found 0, 1)");
  EXPECT_EQ(textWithoutFolders("'/home/jane doe/my data/a.nii': truncated"), "'a.nii': truncated");
  EXPECT_EQ(textWithoutFolders("--log=/home/jane/log.txt"), "--log=log.txt");
  EXPECT_EQ(textWithoutFolders("see ../jane/x/b.json."), "see b.json.");
  EXPECT_EQ(textWithoutFolders(R"({"SEG":"/home/jane/a.mgz","lambda":2})"),
            R"({"SEG":"a.mgz","lambda":2})");
  EXPECT_EQ(textWithoutFolders("n/a 1/mm 3 of 4"), "n/a 1/mm 3 of 4");
  EXPECT_EQ(textWithoutFolders("study/sub-01/a.nii is missing"), "a.nii is missing");
}

TEST(Digest, EqualsKnownSha256) {
  EXPECT_EQ(sha256Of("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
}

TEST(Digest, NamesFileAndCause) {
  try {
    (void)digestOf("/nonexistent/file");
    FAIL();
  } catch (const IOError& error) {
    EXPECT_STREQ(error.what(), "/nonexistent/file: no such file");
  }
}

}  // namespace
}  // namespace explica::provenance
