// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
// The one door for JSON and YAML: what is taken, and the sentence for what is not.

#include "Explica/Core/Errors.h"
#include "Explica/Provenance/Document.h"

#include <gtest/gtest.h>

#include <unistd.h>

#include <fstream>

namespace explica::provenance {
namespace {

namespace fs = std::filesystem;

class DocumentFile : public ::testing::Test {
 protected:
  DocumentFile()
      : folder_(fs::temp_directory_path() / ("explica-document-" + std::to_string(getpid()))) {
    fs::create_directories(folder_);
  }
  ~DocumentFile() override { fs::remove_all(folder_); }

  [[nodiscard]] fs::path write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name, std::ios::binary) << text;
    return folder_ / name;
  }
  /// What is said of a text, without the folder.
  [[nodiscard]] std::string complaint(const std::string& name, const std::string& text,
                                      const DocumentLimits& limits = {}) const {
    const fs::path path = write(name, text);
    try {
      static_cast<void>(readDocument(path, limits));
    } catch (const Error& error) {
      const std::string said = error.what();
      EXPECT_EQ(said.rfind(path.string(), 0), 0u) << said;
      return said.substr(std::min(said.size(), folder_.string().size() + 1));
    }
    return "accepted";
  }

  fs::path folder_;
};

std::string nested(int depth, const std::string& open, const std::string& close) {
  std::string text;
  for (int i = 0; i < depth; ++i) text += open;
  text += "1";
  for (int i = 0; i < depth; ++i) text += close;
  return text;
}

/// Lists of nine aliases of the list before: 9^levels values in a few hundred bytes.
std::string billionLaughs(int levels) {
  std::string text = "a0: &a0 [x]\n";
  for (int level = 1; level <= levels; ++level) {
    const std::string name = "a" + std::to_string(level);
    const std::string before = "*a" + std::to_string(level - 1);
    text += name + ": &" + name + " [" + before;
    for (int i = 0; i < 8; ++i) text += ", " + before;
    text += "]\n";
  }
  return text;
}

TEST_F(DocumentFile, FaultsOfJsonAreToldWithLineAndField) {
  const struct {
    std::string text, said;
  } rows[] = {
      {"{\"a\": 1,\n \"b\": {\"c\": 1e999}}",
       "d.json, line 2, b.c: 1e999 is larger than any number of this machine"},
      {"{\"a\": 1,\n \"a\": 2}", "d.json, line 2, a: is given twice; remove one"},
      {"{\"a\": [1, {\"b\": 1, \"b\": 2}]}", "d.json, line 1, a.1.b: is given twice; remove one"},
      {nested(100000, "[", "]"), "is nested more than 64 levels deep"},
      {nested(100000, "{\"a\":", "}"), "a.a.a: is nested more than 64 levels deep"},
      {"{\"a\": \"\xff\"}", "d.json, line 1: is not text in UTF-8; save it so in your editor"},
      {"{\"a\": \"\xed\xa0\x80\"}", "is not text in UTF-8"},
      {"{\"a\": \"\xf4\x90\x80\x80\"}", "is not text in UTF-8"},
      {"{\"a\": \"\xc0\x80\"}", "is not text in UTF-8"},
      {"{}\n\xc3", "d.json, line 2: is not text in UTF-8"},
      {std::string("{\"a\": 1}\0", 9), "is not text in UTF-8"},
      {"{\"a\": }", "d.json, line 1, a: is not JSON"},
      {"{\"a\": 1} {\"b\": 1}", "is not JSON"},
      {"", "d.json, line 1: is not JSON"},
  };
  for (const auto& row : rows) {
    const std::string said = complaint("d.json", row.text);
    EXPECT_NE(said.find(row.said), std::string::npos) << said;
    EXPECT_LT(said.size(), 400u);
  }
}

TEST_F(DocumentFile, FaultsOfYamlAreToldWithLine) {
  const struct {
    std::string text, said;
  } rows[] = {
      {"a: 1\n---\nb: 2\n", "d.yaml, line 2: a second document begins here"},
      {"a: 1\nb: 1e999\n", "d.yaml, line 2: 1e999 is larger than any number of this machine"},
      {"a: 1\na: 2\n", "d.yaml, line 2: 'a' is given twice, first in line 1; remove one"},
      {", a: 1\n", "a second document begins here, after --- or a stray comma"},
      {"# c\na: [1]\n ]\n", "d.yaml, line 3: is not YAML"},
      {"}", "d.yaml, line 1: is not YAML"},
      {"[" + std::string(4'000'000, ',') + "]", "holds more than 1000000 values"},
      {"a: \xff\n", "d.yaml, line 1: is not text in UTF-8"},
      {"a: &x [*x]", "d.yaml, line 1: is nested too deeply; an alias (*name) may hold itself"},
      {"? [1]\n: 2\n", "has a key that is not a word"},
      {"a: [1, 2", "is not YAML"},
      {nested(100000, "[", "]"), "d.yaml, line 1: is"},
      {nested(100, "[", "]"), "d.yaml, line 1: is nested too deeply"},
      {billionLaughs(12), "where each use of an alias (*name) counts all that it holds"},
  };
  for (const auto& row : rows) {
    const std::string said = complaint("d.yaml", row.text);
    EXPECT_NE(said.find(row.said), std::string::npos) << said;
  }
  EXPECT_LT(billionLaughs(12).size(), 700u);
}

TEST_F(DocumentFile, LimitsHold) {
  DocumentLimits limits;
  limits.bytes = 10;
  EXPECT_EQ(complaint("d.json", "[1,2,3,4,5]", limits),
            "d.json: has 11 bytes; a file of this kind has 10 at most");
  limits = {};
  limits.values = 3;
  EXPECT_EQ(complaint("d.json", "[1,2]", limits), "accepted");
  EXPECT_EQ(complaint("d.json", "[1,2,3]", limits), "d.json, line 1, 2: holds more than 3 values");
  EXPECT_NE(complaint("d.yaml", "[1,2,3]", limits).find("holds more than 3 values"),
            std::string::npos);
}

TEST_F(DocumentFile, WhatIsNoFileIsRefused) {
  EXPECT_THROW(static_cast<void>(readJson(folder_)), IOError);
  EXPECT_THROW(static_cast<void>(readJson("/dev/zero")), IOError);
  EXPECT_THROW(static_cast<void>(readJson(folder_ / "none.json")), IOError);
}

TEST_F(DocumentFile, TellsTheLineOfEachPlace) {
  const std::string json = "{\n \"a\": 1,\n \"b\": {\n  \"c\": [\n 1,\n 2]}}\n";
  const std::string yaml = "\na: 1\nb:\n  c:\n  - 1\n  - 2\n";
  for (const auto& [name, text] : {std::pair{"d.json", json}, std::pair{"d.yaml", yaml}}) {
    const Document document = readDocument(write(name, text));
    EXPECT_EQ(document.values, Json::parse(R"({"a": 1, "b": {"c": [1, 2]}})")) << name;
    EXPECT_EQ(document.lines.at("/a"), 2) << name;
    EXPECT_EQ(document.lines.at("/b"), 3) << name;
    EXPECT_EQ(document.lines.at("/b/c"), 4) << name;
    EXPECT_EQ(document.lines.at("/b/c/1"), 6) << name;
  }
}

TEST_F(DocumentFile, TakesWhatJsonAllows) {
  const std::string text = R"({"": null, "a": [true, -1, 18446744073709551615, 1e-999, 2.5e300],
    "ü": "\u00e4\ud83d\ude00", /* comments */ "o": {}, "l": []})";
  EXPECT_EQ(parseJson(text, "text"), Json::parse(text, nullptr, true, true));
  EXPECT_EQ(parseJson(nested(64, "[", "]"), "text"), Json::parse(nested(64, "[", "]")));
}

TEST_F(DocumentFile, NamesThatAreNotUtf8AreWritten) {
  EXPECT_EQ(textOf(Json{{"a", "x\xffy"}}), "{\"a\":\"x\xef\xbf\xbdy\"}");
}

}  // namespace
}  // namespace explica::provenance
