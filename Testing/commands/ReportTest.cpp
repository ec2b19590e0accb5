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
}

}  // namespace
}  // namespace explica::testing
