// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
// ExampleData/thesis.sh: the page holds every figure and stands alone, and its numbers are within
// bounds.

#include "Explica/Testing/Command.h"

#include <nlohmann/json.hpp>

#include <gtest/gtest.h>

#include <cstdlib>
#include <map>
#include <string>

namespace explica::testing {
namespace {

struct Bounds {
  double least, most;
};

// A key of thesis.json and where its number must lie.
const std::map<std::string, Bounds> kBounds = {{"appendix_a_dial", {3, 1000}},
                                               {"hybrid_worst", {0.9, 1.6}},
                                               {"fit_cube", {0, 0.5}},
                                               {"fit_pear", {0, 0.5}},
                                               {"series_margin", {0.01, 1}},
                                               {"circles_18_22", {0, 0.02}},
                                               {"circles_15_25", {0, 0.02}},
                                               {"length_kept_arc", {0, 0.8}},
                                               {"length_kept_occlusion", {0, 0.8}},
                                               {"real_19", {-0.06, 0.06}},
                                               {"visibility_initial_19", {0.2, 0.22}},
                                               {"visibility_initial_34", {0.16, 0.18}},
                                               {"variance_initial_19", {0.38, 0.40}},
                                               {"variance_initial_34", {0.68, 0.70}},
                                               {"visibility_final_19", {0.995, 1}},
                                               {"visibility_final_34", {0.995, 1}},
                                               {"length_19", {0, 1e-6}},
                                               {"length_34", {0, 1e-6}},
                                               {"length_explicit_19", {0, 0.01}},
                                               {"length_explicit_34", {0, 0.01}},
                                               {"knot_alone_19", {0, 0}},
                                               {"knot_alone_34", {0, 0}},
                                               {"length_collapse", {150, 300}},
                                               {"first_crossing", {1, 200}},
                                               {"points_4.11", {0.3, 2}},
                                               {"hidden_4.11", {0.5, 1}},
                                               {"away_4.11", {-1, -0.5}},
                                               {"region_seen_19", {21, 21}},
                                               {"region_seen_34", {36, 36}},
                                               {"flux_40", {0.395, 0.41}},
                                               {"real_40", {-0.05, 0.05}},
                                               {"edge_flux", {0, 1e-8}},
                                               {"edge_gain", {1.2, 3}},
                                               {"variance_final_19", {0, 1e-3}},
                                               {"variance_final_34", {0, 1e-3}},
                                               {"edges_collapse", {8, 20}},
                                               {"visibility_collapse", {0.99, 1}},
                                               {"first_crossing_coarse", {1, 30}},
                                               {"tree_nodes", {16, 16}},
                                               {"tree_three", {3, 3}},
                                               {"tree_start", {15, 15}},
                                               {"folds_initial", {0.19, 0.21}},
                                               {"folds_final", {0.99, 1}},
                                               {"folds_crossings", {0, 0}},
                                               {"literal_final", {0.9, 1}},
                                               {"flow_limit_none", {0.9, 1}},
                                               {"flow_limit_fixed", {0.2, 0.6}},
                                               {"tree_gain", {1, 1e6}},
                                               {"our_gain", {2, 1e6}},
                                               {"area_error_unfolded", {0, 0.02}},
                                               {"strain_unfolded", {0, 0.15}},
                                               {"region_5.25", {0.8, 1}},
                                               {"region_5.26", {0.8, 1}},
                                               {"region_5.27", {0.8, 1}},
                                               {"region_crossings_5.25", {0, 0}},
                                               {"region_crossings_5.26", {0, 0}},
                                               {"region_crossings_5.27", {0, 0}},
                                               {"thesis_region_5.25", {0.88, 1}},
                                               {"thesis_region_5.26", {0.88, 1}},
                                               {"thesis_region_5.27", {0.88, 1}},
                                               {"thesis_steps_5.25", {100, 150}},
                                               {"thesis_steps_5.26", {100, 150}},
                                               {"thesis_steps_5.27", {100, 150}},
                                               {"thesis_region_crossings_5.25", {0, 0}},
                                               {"thesis_region_crossings_5.26", {0, 0}},
                                               {"thesis_region_crossings_5.27", {0, 0}}};

TEST(ThesisPage, HoldsEveryFigureStandsAloneAndItsNumbersAreWithinBounds) {
  const TemporaryFolder folder;
  const std::string command = std::string("EXPLICA=") + EXPLICA_EXECUTABLE + " " +
                              EXPLICA_SOURCE_DIR + "/ExampleData/thesis.sh " + (folder / "page");
  ASSERT_EQ(std::system(command.c_str()), 0);
  const auto told = readJson(folder / "page/thesis.json");
  std::map<std::string, double> numbers;
  for (const auto& number : told["numbers"]) numbers[number["key"]] = number["ours"];
  for (const auto& [key, bounds] : kBounds) {
    ASSERT_TRUE(numbers.count(key)) << key;
    EXPECT_GE(numbers[key], bounds.least) << key;
    EXPECT_LE(numbers[key], bounds.most) << key;
  }
  const std::string page = readText(folder / "page/thesis.html");
  const auto expectFigures = [&](int chapter, int first, int last) {
    for (int n = first; n <= last; ++n) {
      const std::string figure = std::to_string(chapter) + "." + std::to_string(n);
      EXPECT_EQ(told["figures"].value(figure, "absent"), "made") << figure;
    }
  };
  expectFigures(3, 1, 7);
  expectFigures(4, 8, 20);
  expectFigures(5, 21, 27);
  for (const char* outside : {"src=\"http", "href=\"http", "<script", "url("}) {
    EXPECT_EQ(page.find(outside), std::string::npos) << outside;
  }
  EXPECT_EQ(page.find(">nan"), std::string::npos);
}

}  // namespace
}  // namespace explica::testing
