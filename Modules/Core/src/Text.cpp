// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Core/Text.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstdarg>
#include <cstdio>
#include <limits>
#include <numeric>
#include <sstream>
#include <system_error>

namespace explica {

std::string printed(const char* pattern, ...) {
  va_list values, again;
  va_start(values, pattern);
  va_copy(again, values);
  std::string text(static_cast<std::size_t>(std::vsnprintf(nullptr, 0, pattern, values)), '\0');
  std::vsnprintf(text.data(), text.size() + 1, pattern, again);
  va_end(values);
  va_end(again);
  return text;
}

std::string cellText(double value, const char* pattern) {
  return std::isfinite(value) ? printed(pattern, value) : "n/a";
}

std::string lowerCase(std::string text) {
  for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

std::vector<std::string> cellsOf(std::string_view row, char separator) {
  std::vector<std::string> cells;
  for (std::size_t begin = 0; begin < row.size();) {
    const std::size_t end = std::min(row.find(separator, begin), row.size());
    cells.emplace_back(row.substr(begin, end - begin));
    begin = end + 1;
  }
  return cells;
}

std::vector<TableRow> tableRows(const std::string& table) {
  std::istringstream lines(table);
  std::string line;
  const auto next = [&] {
    if (!std::getline(lines, line)) return false;
    if (line.ends_with('\r')) line.pop_back();
    return true;
  };
  next();
  if (line.starts_with("\xef\xbb\xbf")) line.erase(0, 3);
  const std::vector<std::string> headings = cellsOf(line);
  std::vector<TableRow> rows;
  while (next()) {
    const std::vector<std::string> cells = cellsOf(line);
    TableRow& row = rows.emplace_back();
    for (std::size_t n = 0; n < std::min(cells.size(), headings.size()); ++n) {
      row[headings[n]] = cells[n];
    }
  }
  return rows;
}

double numberIn(const TableRow& row, const std::string& heading) {
  const auto cell = row.find(heading);
  double value = 0;
  if (cell == row.end()) return std::numeric_limits<double>::quiet_NaN();
  const char* end = cell->second.data() + cell->second.size();
  const auto read = std::from_chars(cell->second.data(), end, value);
  return read.ec == std::errc() && read.ptr == end ? value
                                                   : std::numeric_limits<double>::quiet_NaN();
}

std::string nearestOf(std::string_view word, const std::vector<std::string>& candidates,
                      std::size_t below) {
  std::string best;
  for (const std::string& candidate : candidates) {
    std::vector<std::size_t> row(candidate.size() + 1);
    std::iota(row.begin(), row.end(), 0);
    for (std::size_t i = 1; i <= word.size(); ++i) {
      std::size_t diagonal = row[0];
      row[0] = i;
      for (std::size_t j = 1; j <= candidate.size(); ++j) {
        const std::size_t substituted = diagonal + (word[i - 1] == candidate[j - 1] ? 0 : 1);
        diagonal = row[j];
        row[j] = std::min({row[j] + 1, row[j - 1] + 1, substituted});
      }
    }
    if (row.back() < below) {
      below = row.back();
      best = candidate;
    }
  }
  return best;
}

}  // namespace explica
