// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Statistics/Table.h"

#include "Explica/Core/Errors.h"
#include "Explica/Core/FileText.h"
#include "Explica/Core/Types.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <map>
#include <set>

namespace explica::statistics {
namespace {

std::vector<std::string> cellsOf(std::string_view line, char separator) {
  std::vector<std::string> cells(1);
  bool quoted = false;
  for (std::size_t i = 0; i < line.size(); ++i) {
    if (line[i] == '"') {
      if (quoted && i + 1 < line.size() && line[i + 1] == '"')
        cells.back() += line[i++];
      else
        quoted = !quoted;
    } else if (line[i] == separator && !quoted) {
      cells.emplace_back();
    } else {
      cells.back() += line[i];
    }
  }
  return cells;
}

std::string_view nextLine(std::string_view& text) {
  const std::size_t end = std::min(text.find('\n'), text.size());
  std::string_view line = text.substr(0, end);
  text.remove_prefix(std::min(end + 1, text.size()));
  if (line.ends_with('\r')) line.remove_suffix(1);
  return line;
}

void requireDistinct(const Table& table) {
  std::set<std::string> seen;
  for (const std::string& column : table.columns) {
    if (!seen.insert(column).second) {
      throw InvalidInput("'" + table.name + "': has the column '" + column + "' twice");
    }
  }
}

}  // namespace

std::optional<std::size_t> Table::find(std::string_view column) const {
  const auto place = std::find(columns.begin(), columns.end(), column);
  if (place == columns.end()) return {};
  return static_cast<std::size_t>(place - columns.begin());
}

std::size_t Table::at(std::string_view column) const {
  if (const auto place = find(column)) return *place;
  std::string names;
  for (const std::string& c : columns) {
    if (names.size() > 200) {
      names += ", ...";
      break;
    }
    names += (names.empty() ? "" : ", ") + c;
  }
  throw InvalidInput("'" + name + "': has no column '" + std::string(column) + "' (it has " +
                     names + ")");
}

Table parseTable(std::string_view text, std::string name) {
  Table table;
  table.name = std::move(name);
  if (text.starts_with("\xef\xbb\xbf")) text.remove_prefix(3);
  const std::string_view heading = nextLine(text);
  if (heading.empty()) throw InvalidInput("'" + table.name + "': has no heading");
  const char separator = heading.find('\t') != heading.npos ? '\t' : ',';
  table.columns = cellsOf(heading, separator);
  requireDistinct(table);
  for (std::size_t number = 2; !text.empty(); ++number) {
    const std::string_view line = nextLine(text);
    if (line.empty()) continue;
    auto cells = cellsOf(line, separator);
    if (cells.size() != table.columns.size()) {
      throw InvalidInput("'" + table.name + "': line " + std::to_string(number) + " has " +
                         std::to_string(cells.size()) + " cells where the heading has " +
                         std::to_string(table.columns.size()));
    }
    table.rows.push_back(std::move(cells));
  }
  return table;
}

bool isMissing(std::string_view cell) {
  static constexpr std::array<std::string_view, 8> kWords = {"",    "n/a", "N/A", "NA",
                                                             "NaN", "nan", "na",  "null"};
  return std::find(kWords.begin(), kWords.end(), cell) != kWords.end();
}

std::optional<double> numberIn(std::string_view cell) {
  if (cell.starts_with('+')) cell.remove_prefix(1);
  double value = 0;
  const auto [end, fault] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
  if (fault != std::errc() || end != cell.data() + cell.size() || !std::isfinite(value)) return {};
  return value;
}

Table readTable(const std::string& path) {
  return parseTable(fileText(path), path);
}

bool isNumeric(const Table& table, std::size_t column) {
  return std::all_of(table.rows.begin(), table.rows.end(), [&](const auto& row) {
    return isMissing(row[column]) || numberIn(row[column]);
  });
}

Eigen::MatrixXd numbersIn(const Table& table, const std::vector<std::size_t>& rows,
                          const std::vector<std::size_t>& columns) {
  Eigen::MatrixXd values(rows.size(), columns.size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    for (std::size_t c = 0; c < columns.size(); ++c) {
      const std::string& cell = table.rows[rows[i]][columns[c]];
      const auto number = numberIn(cell);
      if (!number && !isMissing(cell)) {
        throw InvalidInput("'" + table.name + "': '" + cell + "' in column '" +
                           table.columns[columns[c]] + "' is no number");
      }
      values(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(c)) = number.value_or(kNaN);
    }
  }
  return values;
}

namespace {

/// The first column in which a cell is this; empty if none.
std::string columnThatHolds(const Table& table, std::string_view wanted) {
  for (std::size_t c = 0; c < table.columns.size(); ++c) {
    for (const auto& row : table.rows) {
      if (row[c] == wanted) return table.columns[c];
    }
  }
  return {};
}

}  // namespace

JoinedPeople joinPeople(const std::vector<std::string>& people, std::string_view listName,
                        const Table& about, std::string_view key, bool allowMissing) {
  std::multimap<std::string_view, std::size_t> rows;
  for (std::size_t r = 0; r < about.rows.size(); ++r) rows.emplace(about.rows[r][about.at(key)], r);
  JoinedPeople joined;
  joined.table.name = about.name;
  joined.table.columns = about.columns;
  std::set<std::string> seen;
  for (std::size_t i = 0; i < people.size(); ++i) {
    if (!seen.insert(people[i]).second) {
      throw InvalidInput("'" + std::string(listName) + "': '" + people[i] + "' is there twice");
    }
    const auto row = rows.find(people[i]);
    if (rows.count(people[i]) > 1) {
      throw InvalidInput("'" + about.name + "': '" + people[i] + "' has two rows");
    }
    if (row != rows.end()) {
      joined.table.rows.push_back(about.rows[row->second]);
      joined.used.push_back(i);
    } else if (allowMissing) {
      joined.leftOut.push_back(people[i]);
    } else {
      const std::string other = columnThatHolds(about, people[i]);
      throw InvalidInput("'" + people[i] + "' of '" + std::string(listName) + "' has no row in '" +
                         about.name + "', where column '" + std::string(key) + "' names people" +
                         (other.empty() ? " (--person chooses another); add the row, or analyse "
                                          "those in both lists with --subset"
                                        : "; column '" + other + "' has it: --person " + other));
    }
  }
  for (const auto& row : about.rows) {
    const std::string& person = row[about.at(key)];
    if (!seen.insert(person).second) continue;
    if (!allowMissing) {
      throw InvalidInput("'" + person + "' of '" + about.name + "' is not in '" +
                         std::string(listName) +
                         "'; add it, or analyse those in both lists with --subset");
    }
    joined.leftOut.push_back(person);
  }
  return joined;
}

}  // namespace explica::statistics
