// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace explica::statistics {

/// A table of words as it stands in a file: participants.tsv, a table of regions.
struct Table {
  std::string name;  ///< of the file, for messages
  std::vector<std::string> columns;
  std::vector<std::vector<std::string>> rows;  ///< each as long as `columns`

  [[nodiscard]] std::optional<std::size_t> find(std::string_view column) const;
  /// @throws InvalidInput  no such column: names those that there are
  [[nodiscard]] std::size_t at(std::string_view column) const;
};

/// Reads tab-separated text, or comma-separated where the heading has no tab; cells may be quoted.
/// @param name  of the file, for messages
/// @throws InvalidInput  no heading, a column named twice, or a row of another length
[[nodiscard]] Table parseTable(std::string_view text, std::string name);

/// The table in a file.
/// @throws InvalidInput  as parseTable; IOError  the file cannot be read
[[nodiscard]] Table readTable(const std::string& path);

/// True of what BIDS and others write for a value that is not known: "", "n/a", "NA", "NaN".
[[nodiscard]] bool isMissing(std::string_view cell);

/// The number in a cell; none if it is missing or no finite number.
[[nodiscard]] std::optional<double> numberIn(std::string_view cell);

/// True if a column holds nothing but numbers and missing values.
[[nodiscard]] bool isNumeric(const Table& table, std::size_t column);

/// Numbers of the table, a row for each of `rows`; NaN where one is missing.
/// @throws InvalidInput  a word: names it and its column
[[nodiscard]] Eigen::MatrixXd numbersIn(const Table& table, const std::vector<std::size_t>& rows,
                                        const std::vector<std::size_t>& columns);

/// One row a person of `about`, in the order of `people`, with the names checked in both lists.
struct JoinedPeople {
  Table table;                       ///< rows of `about`
  std::vector<std::size_t> used;     ///< which of `people` each row is
  std::vector<std::string> leftOut;  ///< in one list only; empty unless allowed
};

/// Finds each person's row by the column `key`.
/// @param allowMissing  people of one list only are left out instead of refused
/// @throws InvalidInput  a person twice in a list, or in one list only: names the person
[[nodiscard]] JoinedPeople joinPeople(const std::vector<std::string>& people,
                                      std::string_view listName, const Table& about,
                                      std::string_view key, bool allowMissing);

}  // namespace explica::statistics
