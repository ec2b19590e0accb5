// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Core/Results.h"

#include "Explica/Core/Types.h"

#include <gtest/gtest.h>

#include <cmath>

namespace explica {
namespace {

struct Part {
  std::string name = "a";
  double length = 2.5;
};

void describe(Results& t, const Part& p) {
  t.text("name", "Name", "", p.name);
  t.number("length", "Length", "mm", "Of the edge.", p.length);
}

Result& error(Results& t, double value) {
  return t.share("error", "Mean error", "Of all.", value)
      .atMost(0.02, Judgement::Look, "read to a few per cent")
      .atMost(0.10, Judgement::Doubt, "seen by eye");
}

TEST(Results, TheWorstLimitDecides) {
  Results good, look, doubt;
  EXPECT_EQ(error(good, 0.02).judgement(), Judgement::Good);
  EXPECT_EQ(error(look, 0.03).judgement(), Judgement::Look);
  EXPECT_EQ(error(doubt, 0.2).judgement(), Judgement::Doubt);
  EXPECT_EQ(look["error"].sentence(),
            "Mean error: 3 %; expected at most 2 % (read to a few per cent)");
  EXPECT_EQ(doubt["error"].sentence(), "Mean error: 20 %; expected at most 10 % (seen by eye)");
  EXPECT_EQ(doubt["error"].expected(), "at most 10 % (seen by eye)");
}

TEST(Results, WhatIsNotKnownIsNotJudged) {
  Results t;
  EXPECT_FALSE(error(t, std::nan("")).judgement());
  EXPECT_FALSE(
      t.count("pairs", "Pairs", "", std::nullopt).exactly(0, Judgement::Doubt, "").judgement());
  EXPECT_FALSE(t.number("free", "Free", "", "", 3).judgement()) << "it has no limit";
  EXPECT_EQ(t["free"].expected(), "");
  EXPECT_FALSE(t.number("unbound", "Unbound", "", "", 3)
                   .atMost(std::nan(""), Judgement::Doubt, "")
                   .judgement());
}

TEST(Results, AUsualRangeIsStatedAndJudgesNobody) {
  Results t;
  const Result& mean =
      t.number("t", "Mean thickness", "mm", "", 3.4).usual(2.3, 3.1, "1,035 people");
  EXPECT_FALSE(mean.judgement());
  EXPECT_EQ(mean.sentence(), "Mean thickness: 3.4 mm; usual 2.3 to 3.1 mm (1,035 people)");
  EXPECT_EQ(mean.expected(), "2.3 to 3.1 mm (1,035 people)");
  t["t"].limits.insert(t["t"].limits.begin(), {0, 3, Judgement::Look, ""});
  EXPECT_EQ(t["t"].judgement(), Judgement::Look) << "another limit still judges";
}

TEST(Results, FlagsAndTextsHaveLimits) {
  Results t;
  EXPECT_EQ(t.flag("closed", "Closed", "", false).exactly(1, Judgement::Look, "").sentence(),
            "Closed: no; expected yes");
  EXPECT_EQ(t.text("flag", "Flag", "", "held").exactly(0, Judgement::Doubt, "").sentence(),
            "Flag: held; expected none");
  EXPECT_EQ(t["flag"].judgement(), Judgement::Doubt);
  EXPECT_EQ(t.number("t", "Mean thickness", "mm", "", 5.4)
                .within(1, 5, Judgement::Look, "Fischl 2000")
                .sentence(),
            "Mean thickness: 5.4 mm; expected 1 to 5 mm (Fischl 2000)");
}

TEST(Results, AMissThatRoundsToItsLimitIsToldFromIt) {
  Results t;
  EXPECT_EQ(
      t.number("v", "Visibility", "", "", 0.97969).atLeast(0.98, Judgement::Doubt, "").sentence(),
      "Visibility: just below 0.98; expected at least 0.98");
  EXPECT_EQ(t.share("s", "Strain", "", 0.090004).atMost(0.09, Judgement::Doubt, "").sentence(),
            "Strain: just above 9 %; expected at most 9 %");
  EXPECT_EQ(
      t.number("w", "Visibility", "", "", 0.98).atLeast(0.98, Judgement::Doubt, "").sentence(),
      "Visibility: 0.98; expected at least 0.98");
}

TEST(Results, AKeyIsDescribedOnceAndMayBeAPattern) {
  Results t;
  t.share("known_*", "Known", "", std::nullopt);
  EXPECT_NE(t.find("known_t1"), nullptr);
  EXPECT_EQ(t.find("unknown"), nullptr);
  EXPECT_THROW(t.count("known_t1", "Known", "", 1), std::logic_error);
  EXPECT_THROW(t["absent"], std::logic_error);
}

TEST(Results, TheHeadIsWhatIsKnownOfIt) {
  Results t;
  t.number("length", "Length", "mm", "", 2.5);
  t.number("width", "Width", "mm", "", kNaN).inHead();
  t.change("seen", "Seen", "share", "", {0.5, 0.987}).inHead();
  t.count("cuts", "Cuts", "", 3).inHead();
  EXPECT_EQ(t.head(), (std::vector<std::string>{"Seen 50 % -> 98.7 %", "Cuts 3"}));
}

TEST(Results, PartsMakeATable) {
  EXPECT_EQ(tableOf(std::vector{Part{}, Part{"b", 1.0 / 3}}),
            "name\tlength\na\t2.5\nb\t0.333333\n");
  Results t;
  const auto& parts =
      std::get<std::vector<Results>>(t.each("parts", "Parts", "", std::vector<Part>(3)).value);
  EXPECT_EQ(parts.size(), 3U);
}

TEST(Results, NumbersAndUnitsAreReadable) {
  EXPECT_EQ(readable(1234.4), "1230");
  EXPECT_EQ(readable(20000), "20000");
  EXPECT_EQ(readable(std::nan("")), "not known");
  EXPECT_EQ(shown(250, "mm^2").text, "2.5");
  EXPECT_EQ(shown(250, "mm^2").unit, "cm\u00b2");
}

}  // namespace
}  // namespace explica
