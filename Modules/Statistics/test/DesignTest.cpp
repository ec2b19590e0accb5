// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Core/Errors.h"
#include "Explica/Statistics/Contrast.h"
#include "Explica/Statistics/Design.h"

#include <gtest/gtest.h>

namespace explica::statistics {
namespace {

using Names = std::vector<std::string>;

const char* const kPeople =
    "participant_id\tgroup\tage\tsex\tsite\n"
    "sub-1\tcontrol\t20\tF\t1\n"
    "sub-2\tcontrol\t30\tM\t1\n"
    "sub-3\tpatient\t40\tF\t2\n"
    "sub-4\tpatient\t50\tM\t2\n"
    "sub-5\tpatient\t70\tF\t1\n"
    "sub-6\tcontrol\t60\tM\t2\n"
    "sub-7\tcontrol\tn/a\tM\t2\n"
    "sub-8\tpatient\t30\tM\t1\n";

Design designOf(const std::string& formula) {
  return buildDesign(parseFormula(formula), parseTable(kPeople, "participants.tsv"));
}

std::string refusal(const std::function<void()>& call) {
  try {
    call();
  } catch (const InvalidInput& e) {
    return e.what();
  }
  return "";
}

TEST(Formula, ProductsAreMainEffectsAndInteractions) {
  const Formula f = parseFormula("thickness ~ group * age + sex:age + (1 | person) - 1");
  EXPECT_EQ(f.response, "thickness");
  EXPECT_FALSE(f.intercept);
  EXPECT_EQ(f.randomIntercept, "person");
  ASSERT_EQ(f.terms.size(), 4U);
  EXPECT_EQ(f.terms[0], Names{"group"});
  EXPECT_EQ(f.terms[1], Names{"age"});
  EXPECT_EQ(f.terms[2], (Names{"group", "age"}));
  EXPECT_EQ(f.terms[3], (Names{"sex", "age"}));
}

TEST(Formula, InteractionsBindTighterThanProducts) {
  const Formula f = parseFormula("a * b:c");
  ASSERT_EQ(f.terms.size(), 3U);
  EXPECT_EQ(f.terms[1], (Names{"b", "c"}));
  EXPECT_EQ(f.terms[2], (Names{"a", "b", "c"}));
}

TEST(Formula, TheOrderOfAnInteractionDoesNotMatter) {
  EXPECT_EQ(parseFormula("a:b + b:a").terms.size(), 1U);
}

TEST(Formula, WhatCannotBeReadIsNamed) {
  EXPECT_NE(refusal([] { (void)parseFormula("y ~ age +"); }).find("name of a column"),
            std::string::npos);
  EXPECT_NE(refusal([] { (void)parseFormula("y ~ age sex"); }).find("at 'sex'"), std::string::npos);
  EXPECT_NE(refusal([] { (void)parseFormula("~ (1 | a) + (1 | b)"); }).find("one random"),
            std::string::npos);
}

TEST(Design, CodesDifferencesFromTheFirstLevelAndCentresNumbers) {
  const Design d = designOf("~ group * age");
  EXPECT_EQ(d.columns, (Names{"intercept", "group[patient]", "age", "group[patient]:age"}));
  ASSERT_EQ(d.people(), 7);  // sub-7 has no age
  EXPECT_EQ(d.dropped, std::vector<std::size_t>{6});
  const double mean = 300.0 / 7;
  EXPECT_NEAR(d.matrix(2, 2), 40 - mean, 1e-12);
  EXPECT_NEAR(d.matrix(2, 3), 40 - mean, 1e-12);
  EXPECT_EQ(d.matrix(0, 3), 0);
}

TEST(Design, WithoutAnInterceptTheFirstFactorHasAllLevels) {
  EXPECT_EQ(designOf("~ 0 + group + sex").columns,
            (Names{"group[control]", "group[patient]", "sex[M]"}));
  // Without age itself, each group has a slope of its own.
  EXPECT_EQ(designOf("~ group + group:age").columns,
            (Names{"intercept", "group[patient]", "group[control]:age", "group[patient]:age"}));
}

TEST(Design, NumbersMadeCategoricalAreLevels) {
  EXPECT_EQ(designOf("~ C(site)").columns, (Names{"intercept", "site[2]"}));
}

TEST(Design, WhatCannotBeEstimatedIsNamed) {
  EXPECT_NE(refusal([] { designOf("~ weight"); }).find("no column 'weight'"), std::string::npos);
  EXPECT_NE(refusal([] {
              (void)buildDesign(parseFormula("~ sex"), parseTable("sex\nF\nF\nF\n", "p.tsv"));
            }).find("column 'sex' has one value (F) in all 3 people"),
            std::string::npos);
  EXPECT_NE(refusal([] {
              (void)buildDesign(parseFormula("~ a + b"),
                                parseTable("a\tb\n1\t2\n2\t4\n4\t8\n9\t18\n", "p.tsv"));
            }).find("column 'b' of the design is a sum of columns before it"),
            std::string::npos);
  EXPECT_NE(refusal([] { designOf("~ group * sex * age"); }).find("8 columns for 7 people"),
            std::string::npos);
}

TEST(Contrast, NamesColumnsTermsAndFirstLevels) {
  const Design d = designOf("~ group * age + sex");
  const Contrast difference = parseContrast("younger=group[patient] - group[control]", d);
  EXPECT_EQ(difference.name, "younger");
  EXPECT_EQ(difference.weights, Eigen::VectorXd::Unit(5, 1));
  const Contrast slope = parseContrast("age + 0.5*group[patient]:age", d);
  Eigen::VectorXd weights(5);
  weights << 0, 0, 1, 0, 0.5;
  EXPECT_EQ(d.columns[4], "group[patient]:age");
  EXPECT_EQ(slope.weights, weights);
  EXPECT_EQ(parseContrast("-1e-3*age", d).weights(2, 0), -1e-3);
  EXPECT_EQ(parseContrast("age; sex[M]", d).weights.cols(), 2);
  EXPECT_EQ(contrastsOfTerms(d).size(), 4U);
}

TEST(Contrast, WhatIsNoColumnIsNamed) {
  const Design d = designOf("~ group + age");
  EXPECT_NE(refusal([&] {
              (void)parseContrast("group[patients]", d);
            }).find("'group[patients]' is no column"),
            std::string::npos);
  EXPECT_NE(refusal([&] { (void)parseContrast("age; 2*age", d); }).find("a sum of others"),
            std::string::npos);
}

TEST(People, InOneListOnlyOrTwiceAreNamed) {
  const Table about = parseTable("participant_id,age\nsub-1,20\nsub-2,30\n", "participants.csv");
  EXPECT_NE(refusal([&] {
              (void)joinPeople({"sub-1", "sub-3"}, "maps.tsv", about, "participant_id", false);
            }).find("'sub-3' of 'maps.tsv' has no row"),
            std::string::npos);
  EXPECT_NE(refusal([&] {
              (void)joinPeople({"sub-1"}, "maps.tsv", about, "age", false);
            }).find("column 'participant_id' has it: --person participant_id"),
            std::string::npos);
  EXPECT_NE(refusal([&] {
              (void)joinPeople({"sub-1"}, "maps.tsv", about, "participant_id", false);
            }).find("'sub-2' of 'participants.csv' is not in 'maps.tsv'"),
            std::string::npos);
  EXPECT_NE(refusal([&] {
              (void)joinPeople({"sub-1", "sub-1"}, "maps.tsv", about, "participant_id", false);
            }).find("'sub-1' is there twice"),
            std::string::npos);
  const JoinedPeople joined =
      joinPeople({"sub-3", "sub-2"}, "maps.tsv", about, "participant_id", true);
  EXPECT_EQ(joined.used, std::vector<std::size_t>{1});
  EXPECT_EQ(joined.leftOut, (Names{"sub-3", "sub-1"}));
  // Two rows of one name matter where that person is asked for.
  const Table twice = parseTable("id,age\nnone,20\nnone,30\nsub-1,40\n", "twice.csv");
  EXPECT_EQ(joinPeople({"sub-1"}, "maps.tsv", twice, "id", true).used.size(), 1u);
  EXPECT_NE(refusal([&] {
              (void)joinPeople({"none"}, "maps.tsv", twice, "id", true);
            }).find("'none' has two rows"),
            std::string::npos);
}

TEST(Table, ReadsQuotesAndRefusesRaggedRows) {
  const Table t = parseTable("a,b\r\n\"x, \"\"y\"\"\",2\r\n", "t.csv");
  EXPECT_EQ(t.rows[0][0], "x, \"y\"");
  EXPECT_NE(refusal([] { (void)parseTable("a\tb\n1\n", "t.tsv"); }).find("line 2 has 1 cells"),
            std::string::npos);
  EXPECT_NE(refusal([] { (void)parseTable("a\ta\n", "t.tsv"); }).find("'a' twice"),
            std::string::npos);
}

}  // namespace
}  // namespace explica::statistics
