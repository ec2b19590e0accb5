// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace explica {

/// What printf would print.
[[nodiscard, gnu::format(printf, 1, 2)]] std::string printed(const char* pattern, ...);

/// A number for a table, by a pattern of printf; "n/a" for what is not finite.
[[nodiscard]] std::string cellText(double value, const char* pattern = "%.6g");

/// The text with its ASCII letters in lower case.
[[nodiscard]] std::string lowerCase(std::string text);

/// Words with a separator between them; `word` gives each item's.
template <class Items, class Word = std::identity>
[[nodiscard]] std::string joined(const Items& items, std::string_view separator = ", ",
                                 const Word& word = {}) {
  std::string all;
  bool first = true;
  for (const auto& item : items) {
    if (!first) all += separator;
    first = false;
    all += word(item);
  }
  return all;
}

/// The cells of a table's row; an empty row has none.
[[nodiscard]] std::vector<std::string> cellsOf(std::string_view row, char separator = '\t');

/// A row of a table: cells by the headings of its columns.
using TableRow = std::map<std::string, std::string>;

/// The rows of a table with tabs whose first line names its columns; short rows lack the last.
/// A byte order mark and ends of lines as Windows writes them are no part of cells.
[[nodiscard]] std::vector<TableRow> tableRows(const std::string& table);

/// The number of a cell; not-a-number if there is none.
[[nodiscard]] double numberIn(const TableRow& row, const std::string& heading);

/// The candidate that takes the fewest letters to insert, drop or change, if these are fewer than
/// `below`; empty if there is none.  Of several the first.
[[nodiscard]] std::string nearestOf(std::string_view word,
                                    const std::vector<std::string>& candidates, std::size_t below);

}  // namespace explica
