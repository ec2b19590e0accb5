// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
// explica glm: what users type and what they get.

#include "Explica/Geometry/Fixtures.h"
#include "Explica/Geometry/MeshMeasures.h"
#include "Explica/IO/SurfaceFile.h"
#include "Explica/IO/VertexDataFile.h"
#include "Explica/Testing/Command.h"
#include "Explica/Testing/Stops.h"
#include "QuickRuns.h"

#include <gtest/gtest.h>

#include <random>
#include <sstream>

namespace explica::testing {
namespace {

const char* const kPeople =
    "participant_id\tage\tgroup\tsex\tcortex\tinsula\n"
    "sub-1\t20\ta\tF\t2.6\t3.1\nsub-2\t30\tb\tF\t2.5\t3.0\nsub-3\t40\ta\tF\t2.5\t3.2\n"
    "sub-4\t50\tb\tF\t2.3\t2.9\nsub-5\t60\ta\tF\t2.2\t3.0\nsub-6\t70\tb\tF\t2.2\t2.8\n";

std::vector<std::string> cellsOf(const std::string& text, std::size_t line, char separator = '\t') {
  std::istringstream lines(text);
  std::string row, cell;
  for (std::size_t n = 0; n <= line; ++n) std::getline(lines, row);
  std::istringstream cells(row);
  std::vector<std::string> found;
  while (std::getline(cells, cell, separator)) found.push_back(cell);
  return found;
}

TEST(Glm, OfATableHasTheSlopeOfEachRegion) {
  TemporaryFolder folder;
  writeText(folder / "people.tsv", kPeople);
  const auto result = explica({"glm", folder / "people.tsv", "--model", "~ age", "--columns",
                               "cortex", "--permutations", "1000", "--out", folder / "out"});
  ASSERT_EQ(result.exitCode, 0) << result;
  const auto row = cellsOf(readText(folder / "out/regions.tsv"), 1);
  // Slope -153 / 17500 per year; residual sum of squares by hand.
  const std::vector<double> age = {20, 30, 40, 50, 60, 70}, y = {2.6, 2.5, 2.5, 2.3, 2.2, 2.2};
  double xy = 0, xx = 0, yy = 0, mean = 0;
  for (const double v : y) mean += v / 6;
  for (std::size_t i = 0; i < 6; ++i) {
    xy += (age[i] - 45) * y[i];
    xx += (age[i] - 45) * (age[i] - 45);
    yy += (y[i] - mean) * (y[i] - mean);
  }
  const double slope = xy / xx, t = slope / std::sqrt((yy - slope * xy) / 4 / xx);
  EXPECT_EQ(row[0], "cortex");
  EXPECT_NEAR(std::stod(row[3]), slope, 1e-6);
  EXPECT_NEAR(std::stod(row[6]), t, 1e-4);
  // Of all 720 orders, those whose slope is as steep.
  EXPECT_EQ(readJson(folder / "out/summary.json")["shuffles"], 720);
  EXPECT_NEAR(std::stod(row[10]) * 720, std::round(std::stod(row[10]) * 720), 1e-2);
}

// A circle with a name for each of thousands would be the largest part of a page.
TEST(Glm, HasACharacterForEachOfManyPeoplesValues) {
  TemporaryFolder folder;
  std::string table = "participant_id,age,cortex\n";
  for (int person = 0; person < 1200; ++person) {
    table += "s" + std::to_string(person) + "," + std::to_string(20 + person % 60) + "," +
             std::to_string(2.5 + 0.01 * (person % 17)) + "\n";
  }
  writeText(folder / "people.csv", table);
  const auto result =
      explica({"glm", folder / "people.csv", "--model", "cortex ~ age", "--out", folder / "out"});
  ASSERT_EQ(result.exitCode, 0) << result;
  const std::string page = readText(folder / "out/report.html");
  const std::string head = "id=\"place-data\">";
  const std::size_t begin = page.find(head) + head.size();
  const auto data =
      nlohmann::json::parse(page.substr(begin, page.find("</script>", begin) - begin));
  EXPECT_EQ(data["people"].size(), 1200U);
  EXPECT_EQ(data["axes"][0]["x"][7], 27);
  ASSERT_EQ(data["named"].size(), 1U);
  EXPECT_EQ(data["named"][0]["title"], "cortex");
  EXPECT_EQ(data["low"], nlohmann::json({2.5}));
  EXPECT_EQ(data["high"], nlohmann::json({2.66}));
  const std::string values = data["values"], digits = data["digits"];
  ASSERT_EQ(values.size(), 1200U);
  EXPECT_EQ(values[0], digits.front());
  EXPECT_EQ(values[16], digits.back());
}

/// How a step of a record ended.
std::string endOf(const nlohmann::json& record, const std::string& name) {
  for (const auto& step : record["steps"]) {
    if (step["name"] == name) return step["termination"];
  }
  return "no such step";
}

/// Stopped anywhere after the models are known, it has them, and says how many shuffles were made.
TEST(Glm, StoppedInItsPermutationsHasTheModels) {
  TemporaryFolder folder;
  writeText(folder / "people.tsv", kPeople);
  const std::vector<std::string> words = {
      "glm", folder / "people.tsv", "--model", "~ age", "--permutations", "1000", "--seed",
      "3",   "--threads",           "1",       "--out", folder / "out"};
  const long checks = checksFor(words);
  const auto whole = cellsOf(readText(folder / "out/regions.tsv"), 1);
  int without = 0;
  for (const long check : momentsOf(checks, 10)) {
    std::filesystem::remove_all(folder / "out");
    const auto stopped = explica(words, stopAtCheck(check));
    ASSERT_TRUE(isInterrupted(stopped)) << stopped;
    if (!std::filesystem::exists(folder / "out")) continue;
    auto row = cellsOf(readText(folder / "out/regions.tsv"), 1);
    const auto summary = readJson(folder / "out/summary.json");
    EXPECT_EQ(summary["termination"], "interrupted");
    EXPECT_LT(summary["shuffles"], 720);
    EXPECT_EQ(endOf(readJson(folder / "out/provenance.json"), "inference"), "interrupted");
    without += summary["shuffles"] == 0 ? 1 : 0;
    EXPECT_EQ(row[10] == "n/a", summary["shuffles"] == 0);
    row[10] = whole[10];  // its family-wise P
    EXPECT_EQ(row, whole) << check;
  }
  EXPECT_GE(without, 5);
}

/// The page's pictures are drawn again by a run that is not stopped; the maps are worth something.
TEST(Glm, StoppedInItsPageHasTheMaps) {
  TemporaryFolder folder;
  writePeoplesMaps(folder);
  const std::vector<std::string> words = {"glm",       folder / "maps.tsv",
                                          "--table",   folder / "people.tsv",
                                          "--model",   "thickness ~ age",
                                          "--surface", folder / "sphere.surf.gii",
                                          "--threads", "1",
                                          "--out",     folder / "out"};
  const long checks = checksFor(words);
  std::filesystem::remove_all(folder / "out");
  const auto stopped = explica(words, stopAtCheck(checks));
  ASSERT_TRUE(isInterrupted(stopped)) << stopped;
  EXPECT_FALSE(std::filesystem::exists(folder / "out/report.html"));
  EXPECT_TRUE(std::filesystem::exists(folder / "out/clusters.tsv"));
  EXPECT_EQ(readJson(folder / "out/summary.json")["termination"], "interrupted");
  EXPECT_EQ(explica({"verify", folder / "out"}).exitCode, 0);
}

struct BadDesign {
  std::string name, model, says;
  std::vector<std::string> more = {};
};

class GlmRefuses : public ::testing::TestWithParam<BadDesign> {};

TEST_P(GlmRefuses, InOneSentence) {
  TemporaryFolder folder;
  writeText(folder / "people.tsv", kPeople);
  std::vector<std::string> words = {"glm",   folder / "people.tsv", "--model", GetParam().model,
                                    "--out", folder / "out"};
  words.insert(words.end(), GetParam().more.begin(), GetParam().more.end());
  const auto result = explica(words);
  EXPECT_EQ(result.exitCode, 2) << result;
  EXPECT_NE(result.err.find(GetParam().says), std::string::npos) << result;
  EXPECT_FALSE(std::filesystem::exists(folder / "out"));
}

INSTANTIATE_TEST_SUITE_P(
    Designs, GlmRefuses,
    ::testing::Values(
        BadDesign{"UnknownColumn", "~ weight", "no column 'weight'"},
        BadDesign{"OneLevel", "~ sex", "column 'sex' has one value (F)"},
        BadDesign{"Rank", "~ age + C(age)", "6 people"},
        BadDesign{"NoSite", "~ age", "no column 'site'", {"--site", "fixed"}},
        BadDesign{"Contrast", "~ group", "'group[c]' is no column", {"--contrast", "group[c]"}},
        BadDesign{"Formula", "~ age +", "name of a column"}),
    [](const auto& row) { return row.param.name; });

TEST(Glm, AnEffectThatIsTheSitesDifferenceIsNotTested) {
  // Patients were scanned at one site, controls at the other: no model tells which of the two it
  // is.
  TemporaryFolder folder;
  std::string people = "participant_id\tgroup\tsite\tage\n", regions = "participant_id\ta\tb\tc\n";
  for (int i = 0; i < 12; ++i) {
    const std::string name = "sub-" + std::to_string(i);
    people += name + (i % 2 == 0 ? "\tpatient\tA\t" : "\tcontrol\tB\t") +
              std::to_string(20 + i * i % 7) + "\n";
    regions += name;
    for (int region = 0; region < 3; ++region) {
      regions += "\t" + std::to_string(2.5 + 0.1 * (i * (region + 3) % 5));
    }
    regions += "\n";
  }
  writeText(folder / "people.tsv", people);
  writeText(folder / "regions.tsv", regions);
  const auto by = [&](const std::string& site) {
    return explica({"glm", folder / "regions.tsv", "--table", folder / "people.tsv", "--model",
                    "thickness ~ group + age", "--contrast", "g=group[patient] - group[control]",
                    "--site", site, "--out", folder / site});
  };
  for (const char* site : {"fixed", "combat"}) {
    const auto refused = by(site);
    EXPECT_EQ(refused.exitCode, 2) << refused;
    EXPECT_NE(refused.err.find("cannot be told from theirs"), std::string::npos) << refused;
  }
  const auto random = by("random");
  EXPECT_NE(random.err.find("contrast 'g' can be tested nowhere"), std::string::npos) << random;
}

TEST(Glm, NamesPeopleOfOneListOnlyAndMapsOfOtherSizes) {
  TemporaryFolder folder;
  const TriangleMesh sphere = geometry::makeIcosphere(1, 30);
  io::writeSurface(folder / "sphere.surf.gii", sphere);
  const Eigen::VectorXd values = Eigen::VectorXd::LinSpaced(sphere.vertexCount(), 2, 3);
  std::string list = "participant_id\tfile\n";
  for (int i = 1; i <= 6; ++i) {
    const std::string name = "sub-" + std::to_string(i);
    io::writeGiftiShape(folder / (name + ".shape.gii"), {{"t", "mm", values * (1 + 0.01 * i * i)}},
                        "CortexLeft");
    list += name + "\t" + name + ".shape.gii\n";
  }
  writeText(folder / "people.tsv", kPeople);
  const auto run = [&](const std::string& maps) {
    writeText(folder / "maps.tsv", maps);
    return explica({"glm", folder / "maps.tsv", "--table", folder / "people.tsv", "--model",
                    "t ~ age", "--surface", folder / "sphere.surf.gii", "--force", "--out",
                    folder / "out"});
  };
  EXPECT_EQ(run(list).exitCode, 0);
  writeText(folder / "numbered.tsv", "number\tparticipant_id\n1\tsub-1\n");
  const auto numbered = explica({"glm", folder / "maps.tsv", "--table", folder / "numbered.tsv",
                                 "--person", "number", "--model", "t ~ number", "--surface",
                                 folder / "sphere.surf.gii", "--out", folder / "numbered"});
  EXPECT_EQ(numbered.exitCode, 2) << numbered;
  EXPECT_NE(numbered.err.find("--person participant_id"), std::string::npos) << numbered;
  EXPECT_NE(run(list + "sub-9\tsub-1.shape.gii\n").err.find("'sub-9'"), std::string::npos);
  EXPECT_NE(run(list + "sub-2\tsub-2.shape.gii\n").err.find("'sub-2' is there twice"),
            std::string::npos);
  EXPECT_NE(run(list.substr(0, list.rfind("sub-6\t"))).err.find("'sub-6'"), std::string::npos);
  // As many vertices of another template are other places.
  std::string mixed = list;
  for (const std::string name : {"sub-1", "sub-3"}) {
    const std::string other =
        name + "_space-" + (name == "sub-1" ? "a" : "b") + "_den-42_t.shape.gii";
    std::filesystem::copy_file(folder / (name + ".shape.gii"), folder / other);
    mixed.replace(mixed.find(name + ".shape.gii"), name.size() + 10, other);
  }
  EXPECT_NE(run(mixed).err.find("of sub-3 is on space-b_den-42, that of sub-1 on space-a_den-42"),
            std::string::npos);
  io::writeGiftiShape(folder / "sub-4.shape.gii", {{"t", "mm", Eigen::VectorXd::Ones(7)}},
                      "CortexLeft");
  const auto wrong = run(list);
  EXPECT_EQ(wrong.exitCode, 2);
  EXPECT_NE(wrong.err.find("sub-4.shape.gii"), std::string::npos) << wrong;
}

// As explica run leaves them: thickness along trajectories, and to the nearest point.
TEST(Glm, TakesOfAFileThatHoldsSeveralMapsTheOneOfTheModel) {
  TemporaryFolder folder;
  writePeoplesMaps(folder);
  const auto run = [&](const std::string& list, const std::string& model, const std::string& out) {
    return explica({"glm", folder / list, "--table", folder / "people.tsv", "--model", model,
                    "--out", folder / out});
  };
  ASSERT_EQ(run("maps.tsv", "thickness ~ age", "one").exitCode, 0);
  for (int person = 0; person < 10; ++person) {
    const std::string file = folder / ("sub-" + std::to_string(person) + ".shape.gii");
    const auto one = io::readVertexMaps(file).front();
    io::writeGiftiShape(file, {{"nearest", "mm", 0.9 * one.values}, one}, "CortexLeft");
  }
  ASSERT_EQ(run("maps.tsv", "thickness ~ age", "two").exitCode, 0);
  EXPECT_EQ(readText(folder / "two/age_effect.shape.gii"),
            readText(folder / "one/age_effect.shape.gii"));
  const auto unclear = run("maps.tsv", "~ age", "out");
  EXPECT_EQ(unclear.exitCode, 2);
  EXPECT_NE(unclear.err.find("2 maps (nearest, thickness); --model"), std::string::npos) << unclear;

  std::string list = readText(folder / "maps.tsv");
  writeText(folder / "named.tsv", list.replace(list.find("file"), 4, "thickness"));
  const auto named = run("named.tsv", "thickness ~ age", "out");
  EXPECT_EQ(named.exitCode, 2);
  EXPECT_NE(named.err.find("the column 'thickness' names files"), std::string::npos) << named;
}

/// Maps of forty people, smooth noise of 0.12 mm; 0.3 mm less within a cap in twenty of them.
TEST(Glm, FindsALesionWhereItIs) {
  TemporaryFolder folder;
  const TriangleMesh sphere = geometry::makeIcosphere(3, 60);
  io::writeSurface(folder / "lh.sphere.surf.gii", sphere);
  const Vector centre = Vector(1, 2, 2).normalized();
  std::mt19937 generator(5);
  std::normal_distribution<double> normal;
  std::string list = "participant_id\tleft\n", people = "participant_id\tgroup\tage\n";
  const Eigen::MatrixXd unit = sphere.positions / 60;
  double lesionArea = 0;
  const Eigen::VectorXd areas = geometry::vertexAreas(sphere);
  for (Eigen::Index v = 0; v < unit.rows(); ++v)
    lesionArea += unit.row(v).dot(centre) > 0.85 ? areas[v] : 0;
  for (int i = 0; i < 40; ++i) {
    Eigen::VectorXd values = Eigen::VectorXd::Constant(unit.rows(), 2.5 + 0.02 * normal(generator));
    for (int wave = 0; wave < 40; ++wave) {
      const Vector direction = Vector(normal(generator), normal(generator), normal(generator)) * 3;
      const double phase = normal(generator) * 10;
      values.array() += 0.027 * ((unit * direction).array() + phase).sin();
    }
    const bool patient = i % 2 == 1;
    for (Eigen::Index v = 0; v < unit.rows(); ++v) {
      if (patient && unit.row(v).dot(centre) > 0.85) values[v] -= 0.3;
    }
    const std::string name = "sub-" + std::to_string(i);
    io::writeGiftiShape(folder / (name + ".shape.gii"), {{"thickness", "mm", values}},
                        "CortexLeft");
    list += name + "\t" + name + ".shape.gii\n";
    people += name + "\t" + (patient ? "patient\t" : "control\t") + std::to_string(20 + i) + "\n";
  }
  writeText(folder / "maps.tsv", list);
  writeText(folder / "participants.tsv", people);
  const auto result = explica({"glm", "--maps", folder / "maps.tsv", "--table",
                               folder / "participants.tsv", "--model", "thickness ~ group + age",
                               "--contrast", "thinner=group[patient] - group[control]", "--surface",
                               folder / "lh.sphere.surf.gii", "--permutations", "500", "--tfce",
                               "--out", folder / "out"});
  ASSERT_EQ(result.exitCode, 0) << result;
  const std::string table = readText(folder / "out/clusters.tsv");
  const auto cluster = cellsOf(table, 1);
  EXPECT_EQ(cluster[0], "thinner");
  EXPECT_EQ(cluster[2], "-");
  const Vector peak(std::stod(cluster[7]), std::stod(cluster[8]), std::stod(cluster[9]));
  EXPECT_GT(peak.normalized().dot(centre), 0.85);
  EXPECT_NEAR(std::stod(cluster[4]), lesionArea, 0.25 * lesionArea);
  EXPECT_NEAR(std::stod(cluster[12]), -0.3, 0.12);
  EXPECT_LE(std::stod(cluster[13]), 0.05);  // of the peak, by permutation
  EXPECT_LE(std::stod(cluster[14]), 0.05);  // of the extent
  EXPECT_LE(std::stod(cluster[16]), 0.05);  // of the peak, by random field theory
  const auto p = io::readVertexMaps(folder / "out/thinner_tfce_p_fwe.shape.gii")[0].values;
  int outside = 0;
  for (Eigen::Index v = 0; v < unit.rows(); ++v)
    outside += p[v] <= 0.05 && unit.row(v).dot(centre) < 0.6;
  EXPECT_EQ(outside, 0);
  EXPECT_GT(readJson(folder / "out/summary.json")["fwhm"], 10);
  EXPECT_EQ(readJson(folder / "out/provenance.json")["inputs"].size(), 43u) << "each file once";
  EXPECT_NE(readText(folder / "out/report.html").find("thinner: clusters"), std::string::npos);
}

}  // namespace
}  // namespace explica::testing
