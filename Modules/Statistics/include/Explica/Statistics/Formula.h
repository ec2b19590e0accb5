// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace explica::statistics {

/// The columns whose product a term is, in the order of the formula; none of the intercept.
using Term = std::vector<std::string>;

/// What a formula says, before any data: `thickness ~ group * age + C(scanner) + (1 | person)`.
struct Formula {
  std::string response;  ///< left of ~; empty if nothing stands there
  bool intercept = true;
  std::vector<Term> terms;                     ///< main effects before interactions, each once
  std::set<std::string> categorical;           ///< named by C(...)
  std::optional<std::string> randomIntercept;  ///< the column c of (1 | c)
};

/// Reads a formula in the notation of [WilkinsonRogers1973] as R has it: `+` adds a term, `:`
/// multiplies columns, `a * b` is `a + b + a:b`, `0` or `- 1` leaves the intercept out, `C(a)`
/// takes numbers for names of levels, `(1 | a)` is a random intercept for each level of a.  Names
/// with other characters than letters, digits, `_` and `.` stand between backticks.
/// @throws InvalidInput  names the place that cannot be read
[[nodiscard]] Formula parseFormula(std::string_view text);

/// "group:age"; "intercept" of no columns.
[[nodiscard]] std::string nameOfTerm(const Term& term);

}  // namespace explica::statistics
