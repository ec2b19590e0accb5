// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Study/StudyPage.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>

namespace explica::study {
namespace {

/// `count` participants, both sides, with numbers that differ a little.
std::vector<StudyRow> manyRows(int count) {
  std::vector<StudyRow> rows;
  for (int n = 0; n < count; ++n) {
    for (const char* side : {"L", "R"}) {
      StudyRow row;
      row.participant = "sub-" + std::to_string(n);
      row.hemisphere = side;
      row.state = n % 100 == 7 ? "failed (surface): sub-" + std::to_string(n) +
                                     "/T1.nii.gz: the file is truncated; copy or make it again"
                               : "done";
      row.values["participant.sex"] = n / 2 % 2 == 0 ? "F" : "M";
      row.values["participant.age"] = std::to_string(20 + n % 60);
      row.report = "runs/" + row.participant + "/report.html";
      row.thumbnail = "runs/" + row.participant + "/thumbnail.png";
      for (const char* column :
           {"surface.thickness_mean", "surface.area_white", "surface.area_pial",
            "unfold.visibility_final", "unfold.edge_strain_mean"}) {
        const double far = n % 250 == 3 ? 1.5 : 1;  // some are outliers
        row.values[column] = std::to_string(far * (2.5 + 0.001 * ((n * 37) % 101)));
      }
      for (int r = 0; r < 68; ++r) {
        row.values["region.area" + std::to_string(r)] =
            std::to_string(2 + 0.01 * r + 0.002 * ((n * 13) % 53));
      }
      rows.push_back(std::move(row));
    }
  }
  return rows;
}

nlohmann::json dataOf(const std::string& page) {
  const std::string head = "id=\"data\">";
  const std::size_t begin = page.find(head) + head.size();
  return nlohmann::json::parse(page.substr(begin, page.find("</script>", begin) - begin));
}

TEST(StudyPage, AThousandPeopleFitTwentyMegabytes) {
  const std::string page = indexPage(manyRows(1000), "Thousand");
  EXPECT_LT(page.size(), 20u << 20);
  EXPECT_EQ(dataOf(page)["rows"].size(), 2000u);
}

TEST(StudyPage, AThousandPeopleWorkInABrowser) {
  namespace fs = std::filesystem;
  if (!fs::exists("/usr/bin/chromium") || !fs::exists("/usr/bin/chromedriver")) {
    GTEST_SKIP() << "no chromium";
  }
  const fs::path folder = fs::path(testing::TempDir()) / "explica-thousand-people";
  const fs::path page = folder / "index.html";
  fs::create_directories(folder);
  std::vector<StudyRow> rows = manyRows(1000);
  for (StudyRow& row : rows) row.thumbnail = "thumbnail.svg";
  rows[11].values["surface.thickness_mean"] = "2500";  // far off
  std::ofstream(folder / "thumbnail.svg")
      << "<svg xmlns='http://www.w3.org/2000/svg' width='104' height='80'/>";
  std::ofstream(page) << indexPage(rows, "Thousand");
  const std::string command =
      "/usr/bin/python3 " EXPLICA_SOURCE_DIR "/Testing/commands/study_page.py " + page.string();
  EXPECT_EQ(std::system(command.c_str()), 0) << command;
  fs::remove_all(folder);
}

TEST(StudyPage, NamesColumnsInWordsWithUnits) {
  for (const auto& column : dataOf(indexPage(manyRows(3), "Words"))["columns"]) {
    EXPECT_EQ(column["words"].get<std::string>().find('_'), std::string::npos) << column;
  }
  std::vector<StudyRow> rows = manyRows(3);
  for (const char* key :
       {"surface.volume_white", "surface.faces", "thickness.traced_fraction", "unfold.iterations",
        "unfold.stop_reason", "register.folding_correlation_after"}) {
    rows[0].values[key] = "1";
  }
  const auto columns = dataOf(indexPage(rows, "Words"))["columns"];
  for (const auto& column : columns) {
    EXPECT_EQ(column["words"].get<std::string>().find(':'), std::string::npos) << column;
  }
  const auto area = std::find_if(columns.begin(), columns.end(),
                                 [](const auto& c) { return c["words"] == "White area"; });
  ASSERT_NE(area, columns.end());
  EXPECT_EQ((*area)["unit"], "mm\u00b2");
  EXPECT_EQ((*area)["kind"], "first");
}

TEST(StudyPage, KeepsTheWholeSentenceOfAFailure) {
  const auto rows = dataOf(indexPage(manyRows(10), "Failures"))["rows"];
  const std::string state = rows[14]["cells"][2];
  EXPECT_NE(state.find("copy or make it again"), std::string::npos);
  EXPECT_EQ(rows[14]["thumbnail"], "runs/sub-7/thumbnail.png");
}

TEST(StudyPage, AsksForNothingFromElsewhere) {
  const std::string page = indexPage(manyRows(2), "Alone");
  for (const char* fetching : {"src=\"http", "src='http", "@import", "url(", "<script src"}) {
    EXPECT_EQ(page.find(fetching), std::string::npos) << fetching;
  }
}

}  // namespace
}  // namespace explica::study
