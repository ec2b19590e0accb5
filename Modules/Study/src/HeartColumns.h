// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Study/HeartStudy.h"

#include <map>
#include <string>
#include <vector>

namespace explica::study {

/// A column of a heart's numbers.
struct HeartColumn {
  const char* key;
  const char* unit;
  const char* meaning;
};

/// What participants.tsv says of anybody, by name.
[[nodiscard]] std::vector<std::string> aboutColumns(const std::vector<HeartRow>& rows);

/// "n/a" where there is none.
[[nodiscard]] std::string valueIn(const std::map<std::string, std::string>& values,
                                  const std::string& key);

}  // namespace explica::study
