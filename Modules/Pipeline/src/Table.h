// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace explica::pipeline {

/// Columns with names, as numbers (what is no number is not-a-number) and as they stand.
struct Table {
  std::vector<std::string> names;
  std::vector<std::vector<double>> columns;
  std::vector<std::vector<std::string>> texts;

  [[nodiscard]] const std::vector<double>* column(std::string_view name) const;
  [[nodiscard]] const std::vector<std::string>* text(std::string_view name) const;
  [[nodiscard]] std::size_t rows() const { return columns.empty() ? 0 : columns.front().size(); }
};

/// Reads a tab-separated table whose first row names its columns; rows that are cut short (a run
/// that was killed) are left out.
/// @throws IOError  absent or without a first row
[[nodiscard]] Table readTable(const std::filesystem::path& file);

}  // namespace explica::pipeline
