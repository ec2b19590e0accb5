// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace explica::pipeline {

/// Columns of numbers with names; what is no number is not-a-number.
struct Table {
  std::vector<std::string> names;
  std::vector<std::vector<double>> columns;

  [[nodiscard]] const std::vector<double>* column(std::string_view name) const;
};

/// Reads a tab-separated table whose first row names its columns; rows that are cut short (a run
/// that was killed) are left out.
/// @throws IOError  absent or without a first row
[[nodiscard]] Table readTable(const std::filesystem::path& file);

}  // namespace explica::pipeline
