// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Table.h"

#include "Explica/Core/Errors.h"
#include "Explica/Core/FileText.h"

#include <algorithm>

namespace explica::pipeline {

bool Table::has(const std::string& name) const {
  return std::ranges::find(names, name) != names.end();
}

std::vector<double> Table::numbers(const std::string& name) const {
  std::vector<double> column;
  for (const TableRow& row : rows) column.push_back(numberIn(row, name));
  return column;
}

const std::string& cellIn(const TableRow& row, const std::string& column) {
  const auto cell = row.find(column);
  if (cell == row.end()) throw IOError("a table has no column " + column);
  return cell->second;
}

Table readTable(const std::filesystem::path& file) {
  const std::string text = fileText(file);
  Table table{cellsOf(text.substr(0, text.find('\n'))), tableRows(text)};
  if (table.names.empty()) throw IOError(file.string() + ": no table can be read from it");
  std::erase_if(table.rows, [&](const TableRow& row) { return row.size() < table.names.size(); });
  return table;
}

}  // namespace explica::pipeline
