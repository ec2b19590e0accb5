// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
// Regional thickness of real people: ../shared/data/groups.
#include "Explica/Core/FileText.h"
#include "Explica/Statistics/PlaceModel.h"

#include <gtest/gtest.h>

#include <map>

namespace explica::statistics {
namespace {

std::filesystem::path groups() {
  return std::filesystem::path(EXPLICA_REAL_DATA) / "groups";
}

#define NEEDS_GROUPS() \
  if (!std::filesystem::exists(groups())) GTEST_SKIP() << "skipped: no real data"

Table tableOf(const std::string& name) {
  return parseTable(fileText(groups() / name), name);
}

Eigen::MatrixXd valuesOf(const Table& table, const std::vector<std::size_t>& columns) {
  Eigen::MatrixXd values(static_cast<Eigen::Index>(table.rows.size()),
                         static_cast<Eigen::Index>(columns.size()));
  for (std::size_t r = 0; r < table.rows.size(); ++r) {
    for (std::size_t c = 0; c < columns.size(); ++c) {
      values(static_cast<Eigen::Index>(r), static_cast<Eigen::Index>(c)) =
          numberIn(table.rows[r][columns[c]]).value();
    }
  }
  return values;
}

TEST(RealPeople, AbideThinsWithAge) {
  NEEDS_GROUPS();
  const Table thickness = tableOf("abide_lh.aparc_table_thickness.tsv");
  const Table about = tableOf("abide_phenotypes.csv");
  std::map<long, std::size_t> rows;
  for (std::size_t r = 0; r < about.rows.size(); ++r) {
    rows[std::stol(about.rows[r][about.at("SUB_ID")])] = r;
  }
  Table joined{"abide", {"age", "site", "mean"}, {}};
  for (const auto& person : thickness.rows) {
    const auto row = rows.find(std::stol(person[0].substr(person[0].rfind('_') + 1)));
    if (row == rows.end()) continue;
    const auto& cells = about.rows[row->second];
    joined.rows.push_back({cells[about.at("AGE_AT_SCAN")], cells[about.at("SITE_ID")],
                           person[thickness.at("lh_MeanThickness_thickness")]});
  }
  ASSERT_EQ(joined.rows.size(), 1035U);
  const Design design = buildDesign(parseFormula("mean ~ age + site"), joined);
  ModelMaps maps(design.matrix.cols(), 1, 1);
  fitPlaces(design, {parseContrast("age", design)}, valuesOf(joined, {2}), 0, maps);
  EXPECT_NEAR(10 * maps.contrasts[0].effect[0], -0.145, 0.0005);
  EXPECT_NEAR(maps.contrasts[0].statistic[0], -20.25510, 1e-5);  // as numpy has it
}

TEST(RealPeople, AdolescentsThinInMostRegions) {
  NEEDS_GROUPS();
  const Table table = tableOf("nspn_500aparc_thickness.csv");
  std::vector<std::size_t> regions;
  for (std::size_t c = 0; c < table.columns.size(); ++c) {
    const std::string& name = table.columns[c];
    if (name.ends_with("_thickness") && name.find("_part") != name.npos) regions.push_back(c);
  }
  const Design design = buildDesign(parseFormula("age_scan"), table);
  ModelMaps maps(2, static_cast<Eigen::Index>(regions.size()), 1);
  fitPlaces(design, {parseContrast("age_scan", design)}, valuesOf(table, regions), 0, maps);
  const Eigen::VectorXd& t = maps.contrasts[0].statistic;
  EXPECT_EQ(design.people(), 297);
  EXPECT_EQ((t.array() < -3).count(), 232) << regions.size() << " regions";
  EXPECT_EQ((t.array() > 3).count(), 0);
  EXPECT_NEAR(maps.contrasts[0].effect.mean(), -0.016, 0.0005);
}

}  // namespace
}  // namespace explica::statistics
