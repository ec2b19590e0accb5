// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Table.h"

#include "Explica/Core/Errors.h"
#include "Explica/Core/FileText.h"
#include "Explica/Core/Text.h"
#include "Explica/Core/Types.h"

#include <sstream>

namespace explica::pipeline {
const std::vector<double>* Table::column(std::string_view name) const {
  for (std::size_t c = 0; c < names.size(); ++c) {
    if (names[c] == name) return &columns[c];
  }
  return nullptr;
}

const std::vector<std::string>* Table::text(std::string_view name) const {
  for (std::size_t c = 0; c < names.size(); ++c) {
    if (names[c] == name) return &texts[c];
  }
  return nullptr;
}

Table readTable(const std::filesystem::path& file) {
  std::istringstream stream(fileText(file));
  std::string line;
  if (!std::getline(stream, line)) throw IOError(file.string() + ": no table can be read from it");
  Table table;
  table.names = cellsOf(line);
  table.columns.resize(table.names.size());
  table.texts.resize(table.names.size());
  while (std::getline(stream, line)) {
    const std::vector<std::string> row = cellsOf(line);
    if (row.size() != table.names.size()) continue;
    for (std::size_t c = 0; c < row.size(); ++c) {
      std::istringstream digits(row[c]);
      digits.imbue(std::locale::classic());
      double value = kNaN;
      if (!(digits >> value)) value = kNaN;
      table.columns[c].push_back(value);
      table.texts[c].push_back(row[c]);
    }
  }
  return table;
}

}  // namespace explica::pipeline
