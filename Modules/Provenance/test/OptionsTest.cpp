// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Core/Errors.h"
#include "Explica/Core/Termination.h"
#include "Explica/Provenance/Json.h"

#include <gtest/gtest.h>

#include <limits>

namespace explica::provenance {
namespace {

struct Sample {
  bool fast = false;
  int count = 3;
  double weight = 0.1;
  double limit = std::numeric_limits<double>::infinity();
  std::string note = "none";
  Eigen::Vector3d viewpoint = {1, 2, 3};
  std::optional<double> radius;
  std::optional<Eigen::Vector3d> centre;
  std::vector<int> labels = {1, 2};
  Termination stop = Termination::Converged;
  std::optional<Termination> other;
  std::vector<Eigen::Vector3d> line;
};

template <class Visitor>
void describe(Sample& s, Visitor&& visit) {
  visit(Field{"fast", "", "a flag"}, s.fast);
  visit(Field{"count", "", "a count"}, s.count);
  visit(Field{"weight", "", "a weight"}, s.weight);
  visit(Field{"limit", "s", "a limit"}, s.limit);
  visit(Field{"note", "", "a text"}, s.note);
  visit(Field{"viewpoint", "mm", "a point"}, s.viewpoint);
  visit(Field{"radius", "mm", "an optional"}, s.radius);
  visit(Field{"centre", "mm", "an optional point"}, s.centre);
  visit(Field{"labels", "", "a list"}, s.labels);
  visit(Field{"stop", "", "a choice"}, s.stop);
  visit(Field{"other", "", "an optional choice"}, s.other);
  visit(Field{"line", "mm", "points"}, s.line);
}

Option optionNamed(std::vector<Option>& options, const std::string& name) {
  for (auto& option : options) {
    if (option.name == name) return option;
  }
  throw std::logic_error(name);
}

Json valuesOf(Sample sample) {
  Json object = Json::object();
  for (const Option& option : listOptions(sample)) object[option.name] = valueOf(option);
  return object;
}

TEST(Options, JsonRoundTripKeepsEveryValue) {
  Sample sample;
  sample.fast = true;
  sample.weight = 1.0 / 3.0;
  sample.centre = Eigen::Vector3d(-1, 0.5, 1e-7);
  sample.labels = {7};
  sample.other = Termination::Stalled;
  sample.line = {{1, 2, 3}, {4, 5, 6}};
  const Json json = valuesOf(sample);
  Sample back;
  const Json parsed = Json::parse(json.dump());
  for (Option& option : listOptions(back)) setValue(option, parsed[option.name]);
  EXPECT_EQ(valuesOf(back), json);
  EXPECT_EQ(back.weight, 1.0 / 3.0);
  EXPECT_TRUE(std::isinf(back.limit));
  EXPECT_EQ(*back.centre, Eigen::Vector3d(-1, 0.5, 1e-7));
}

struct Bounded {
  int count = 3;
  double length = 1;
  std::optional<double> share;
  std::vector<int> numbers;
};

template <class Visitor>
void describe(Bounded& b, Visitor&& visit) {
  visit(Field{"count", "", "a count", 1, 1000}, b.count);
  visit(Field{"length", "mm", "a length", kAboveZero}, b.length);
  visit(Field{"share", "", "a share", 0, 1}, b.share);
  visit(Field{"numbers", "", "a list", 0}, b.numbers);
}

TEST(Options, NumbersOutOfRangeAreRefusedWhereTheyAreSet) {
  Bounded bounded;
  auto options = listOptions(bounded);
  const auto refusal = [&](const std::string& name, const std::string& text) -> std::string {
    try {
      optionNamed(options, name).setText({text});
    } catch (const UsageError& error) {
      return error.what();
    }
    return "accepted";
  };
  EXPECT_EQ(refusal("count", "0"), "count: '0' is not within 1 to 1000");
  EXPECT_EQ(refusal("count", "1001"), "count: '1001' is not within 1 to 1000");
  EXPECT_EQ(refusal("count", "1e12"), "count: '1e12' is not within 1 to 1000");
  EXPECT_EQ(refusal("count", "2.5"), "count: '2.5' is not a whole number, 1 to 1000");
  EXPECT_EQ(refusal("length", "0"), "length: '0' is not above 0");
  EXPECT_EQ(refusal("length", "1e-300"), "accepted");
  EXPECT_EQ(refusal("length", "inf"), "accepted");
  EXPECT_EQ(refusal("share", "1.5"), "share: '1.5' is not within 0 to 1");
  EXPECT_EQ(refusal("numbers", "3,-1"), "numbers: '-1' is not at least 0");
  EXPECT_THROW(setValue(options[0], 2000), UsageError);
  EXPECT_EQ(bounded.count, 3);
  EXPECT_EQ(refusal("count", "1e3"), "accepted");
  EXPECT_EQ(bounded.count, 1000);
  EXPECT_TRUE(bounded.numbers.empty());
}

TEST(Options, TextSetsEachType) {
  Sample sample;
  auto options = listOptions(sample);
  optionNamed(options, "viewpoint").setText({"-10,2,3.5"});
  optionNamed(options, "labels").setText({"4,5", "6"});
  optionNamed(options, "stop").setText({"max-time"});
  optionNamed(options, "radius").setText({"+2.5"});
  optionNamed(options, "line").setText({"0,0,1", "-1,0,0"});
  EXPECT_EQ(sample.viewpoint, Eigen::Vector3d(-10, 2, 3.5));
  EXPECT_EQ(sample.labels, (std::vector<int>{4, 5, 6}));
  EXPECT_EQ(sample.stop, Termination::MaxTime);
  EXPECT_EQ(sample.radius, 2.5);
  EXPECT_EQ(sample.line.size(), 2u);
}

TEST(Options, AListOfPointsTakesOneJsonPointToo) {
  Sample sample;
  auto options = listOptions(sample);
  Option line = optionNamed(options, "line");
  setValue(line, Json::parse("[[0, 0, 1], [-1, 0, 2]]"));
  ASSERT_EQ(sample.line.size(), 2u);
  EXPECT_EQ(sample.line[1], Eigen::Vector3d(-1, 0, 2));
  setValue(line, Json::parse("[4, 5, 6]"));
  ASSERT_EQ(sample.line.size(), 1u);
  EXPECT_EQ(sample.line[0], Eigen::Vector3d(4, 5, 6));
  EXPECT_THROW(setValue(line, Json::parse("[4, 5]")), UsageError);
}

TEST(Options, WrongTextIsRefusedWithNameAndExpectation) {
  Sample sample;
  auto options = listOptions(sample, "unfold.");
  const auto message = [&](const std::string& name, const std::string& text) -> std::string {
    try {
      optionNamed(options, name).setText({text});
    } catch (const UsageError& error) {
      return error.what();
    }
    return "accepted";
  };
  EXPECT_EQ(message("unfold.count", "3.5"), "unfold.count: '3.5' is not a whole number");
  EXPECT_EQ(message("unfold.count", "1e12"),
            "unfold.count: '1e12' is not within -2,147,483,647 to 2,147,483,647");
  EXPECT_EQ(message("unfold.weight", "nan"), "unfold.weight: 'nan' is not a number");
  EXPECT_EQ(message("unfold.weight", "1mm"), "unfold.weight: '1mm' is not a number");
  EXPECT_NE(message("unfold.viewpoint", "1,2").find("three numbers"), std::string::npos);
  EXPECT_NE(message("unfold.stop", "tired").find("max-iterations"), std::string::npos);
  EXPECT_EQ(sample.count, 3);
}

TEST(Options, NestedKeysFlatten) {
  EXPECT_EQ(flattenKeys(Json::parse(R"({"a": {"b": 1, "c": {"d": 2}}, "e": 3})")),
            Json::parse(R"({"a.b": 1, "a.c.d": 2, "e": 3})"));
}

}  // namespace
}  // namespace explica::provenance
