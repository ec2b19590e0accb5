// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Geometry/Fixtures.h"
#include "Explica/IO/SurfaceFile.h"
#include "Explica/Testing/Command.h"

#include <gtest/gtest.h>

#include <filesystem>

namespace explica::testing {
namespace {

void unfoldSphere(const TemporaryFolder& folder) {
  io::writeGiftiSurface(folder / "a.surf.gii", geometry::makeFoldedSphere(4, 40));
  const auto unfold = explica({"unfold", folder / "a.surf.gii", "--center", "0,0,40", "--radius",
                               "14", "--direction", "0,0.3,1", "--max-iterations", "4", "--frames",
                               "4", "--out", folder / "u"});
  ASSERT_TRUE(unfold.exitCode == 0 || unfold.exitCode == 3) << unfold;
}

TEST(Report, WorksInABrowserWithoutANetwork) {
  if (!std::filesystem::exists("/usr/bin/chromium") ||
      !std::filesystem::exists("/usr/bin/chromedriver")) {
    GTEST_SKIP() << "no chromium";
  }
  TemporaryFolder folder;
  unfoldSphere(folder);
  const auto report = explica({"report", folder / "u"});
  ASSERT_EQ(report.exitCode, 0) << report;
  const auto browser =
      runProgram({"/usr/bin/python3", EXPLICA_SOURCE_DIR "/Testing/commands/report_page.py",
                  folder / "u/report.html"});
  EXPECT_EQ(browser.exitCode, 0) << browser;
}

/// The page without scripts, styles and pictures: what a reader reads.
std::string wordsOf(const std::string& page) {
  std::string words = page;
  for (const auto& [open, close] :
       {std::pair{"<script", "</script>"}, std::pair{"<style", "</style>"},
        std::pair{"<pre>", "</pre>"}, std::pair{"base64,", "'"}}) {
    for (std::size_t at = words.find(open); at != std::string::npos; at = words.find(open, at)) {
      words.erase(at, words.find(close, at) - at + std::string_view(close).size());
    }
  }
  return words;
}

TEST(Report, AnswersInTheOrderOfAReadersQuestions) {
  TemporaryFolder folder;
  unfoldSphere(folder);
  ASSERT_EQ(explica({"report", folder / "u"}).exitCode, 0);
  const std::string words = wordsOf(readText(folder / "u/report.html"));
  std::size_t before = 0;
  for (const char* question :
       {"Is it right?", "What was found", "See for yourself", "How it was made"}) {
    const std::size_t at = words.find(question);
    ASSERT_NE(at, std::string::npos) << question;
    EXPECT_GT(at, before) << question;
    before = at;
  }
  EXPECT_NE(words.find("Average visibility"), std::string::npos);
  for (const char* key : {"area_error", "visibility_final", "energy_", "edge_strain"}) {
    EXPECT_EQ(words.find(key), std::string::npos) << "a raw key: " << key;
  }
}

TEST(Report, SaysThatADetachedPatchIsDrawnApart) {
  TemporaryFolder folder;
  io::writeGiftiSurface(folder / "a.surf.gii", geometry::makeFoldedSphere(4, 40));
  const auto unfold = explica({"unfold", folder / "a.surf.gii", "--center", "0,0,40", "--radius",
                               "14", "--direction", "0,0.3,1", "--surround", "none",
                               "--max-iterations", "4", "--out", folder / "u"});
  ASSERT_TRUE(unfold.exitCode == 0 || unfold.exitCode == 3) << unfold;
  ASSERT_EQ(explica({"report", folder / "u"}).exitCode, 0);
  EXPECT_NE(wordsOf(readText(folder / "u/report.html")).find("drawn apart from the surface"),
            std::string::npos);
}

TEST(Report, ShowsSlicesInEitherConvention) {
  TemporaryFolder folder;
  ASSERT_EQ(explica({"phantom", "shell", "--size", "20", "--out", folder / "p"}).exitCode, 0);
  ASSERT_EQ(explica({"surface", folder / "p/labels.nii.gz", "--white", "1", "--grey", "2",
                     "--faces", "1000", "--out", folder / "s"})
                .exitCode,
            0);
  for (const char* convention : {"neurological", "radiological"}) {
    ASSERT_EQ(
        explica({"report", folder / "s", "--convention", convention, "--slices", "3"}).exitCode, 0);
    const std::string words = wordsOf(readText(folder / "s/report.html"));
    EXPECT_NE(words.find(convention == std::string("neurological") ? "left is on the left"
                                                                   : "left is on the right"),
              std::string::npos);
    std::size_t tiles = 0;
    for (std::size_t at = words.find("class='tile'"); at != std::string::npos;
         at = words.find("class='tile'", at + 1)) {
      ++tiles;
    }
    EXPECT_EQ(tiles, 9u);
  }
  EXPECT_EQ(explica({"report", folder / "s", "--slices", "0"}).exitCode, 2);
}

TEST(Report, LeavesOutWhatItCannotReadAndSaysSo) {
  TemporaryFolder folder;
  unfoldSphere(folder);
  writeText(folder / "u/unfolded.surf.gii", "damaged");
  writeText(folder / "u/visibility.shape.gii", "damaged");
  const auto report = explica({"report", folder / "u"});
  EXPECT_EQ(report.exitCode, 0) << report;
  EXPECT_NE(readText(folder / "u/report.html").find("left out"), std::string::npos);
}

TEST(Report, RefusesAFolderWithoutRecords) {
  TemporaryFolder folder;
  const auto report = explica({"report", folder.path().string()});
  EXPECT_EQ(report.exitCode, 2);
  EXPECT_NE(report.err.find("provenance.json"), std::string::npos) << report;
  // Nor one that merely holds such a folder.
  ASSERT_EQ(explica({"phantom", "shell", "--size", "20", "--out", folder / "p"}).exitCode, 0);
  EXPECT_EQ(explica({"report", folder.path().string()}).exitCode, 2);
  EXPECT_FALSE(std::filesystem::exists(folder / "report.html"));
}

}  // namespace
}  // namespace explica::testing
