// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Core/Text.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace explica {
namespace {

TEST(Text, IsPrintedAtAnyLength) {
  EXPECT_EQ(printed("%d of %.2f %s", 3, 1.5, "mm"), "3 of 1.50 mm");
  EXPECT_EQ(printed("%s", std::string(5000, 'x').c_str()), std::string(5000, 'x'));
}

TEST(Text, OfATableSaysWhatIsNotKnown) {
  EXPECT_EQ(cellText(1.0 / 3), "0.333333");
  EXPECT_EQ(cellText(2, "%.1f"), "2.0");
  EXPECT_EQ(cellText(std::numeric_limits<double>::quiet_NaN()), "n/a");
}

TEST(Text, IsJoinedWithoutASeparatorAtEitherEnd) {
  EXPECT_EQ(joined(std::vector<std::string>{}), "");
  EXPECT_EQ(joined(std::vector<std::string>{"", "b", ""}), ", b, ");
  EXPECT_EQ(joined(std::vector<int>{1, 2}, " x ", [](int n) { return std::to_string(n); }),
            "1 x 2");
}

TEST(Text, HasTheCellsOfARow) {
  EXPECT_TRUE(cellsOf("").empty());
  EXPECT_EQ(cellsOf("a\t\tb"), (std::vector<std::string>{"a", "", "b"}));
  EXPECT_EQ(cellsOf("a,b,", ','), (std::vector<std::string>{"a", "b"}));
}

TEST(Text, OfATableIsFoundByItsHeadings) {
  const auto rows = tableRows(
      "\xef\xbb\xbf"
      "name\tmm\r\na\t2.5\r\nb\n");
  ASSERT_EQ(rows.size(), 2U);
  EXPECT_EQ(rows[0].at("name"), "a");
  EXPECT_EQ(numberIn(rows[0], "mm"), 2.5);
  EXPECT_TRUE(std::isnan(numberIn(rows[0], "name")));
  EXPECT_TRUE(std::isnan(numberIn(rows[1], "mm")));
  EXPECT_TRUE(tableRows("").empty());
}

TEST(Text, IsNearestByLettersThatDiffer) {
  const std::vector<std::string> known = {"faces", "radius", "frames"};
  EXPECT_EQ(nearestOf("face", known, 3), "faces");
  EXPECT_EQ(nearestOf("fames", known, 3), "faces");
  EXPECT_EQ(nearestOf("radios", known, 3), "radius");
  EXPECT_EQ(nearestOf("sphere", known, 3), "");
}

}  // namespace
}  // namespace explica
