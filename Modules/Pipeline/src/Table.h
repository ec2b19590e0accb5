// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Text.h"

#include <filesystem>
#include <string>
#include <vector>

namespace explica::pipeline {

/// A table of this program.
struct Table {
  std::vector<std::string> names;  ///< of its columns, in order
  std::vector<TableRow> rows;      ///< each with every column

  [[nodiscard]] bool has(const std::string& name) const;
  /// A column's numbers; what is none is not-a-number.
  [[nodiscard]] std::vector<double> numbers(const std::string& name) const;
};

/// @throws IOError  there is no such column
[[nodiscard]] const std::string& cellIn(const TableRow& row, const std::string& column);

/// Reads a tab-separated table whose first row names its columns; rows that are cut short (a run
/// that was killed) are left out.
/// @throws IOError  absent or without a first row
[[nodiscard]] Table readTable(const std::filesystem::path& file);

}  // namespace explica::pipeline
