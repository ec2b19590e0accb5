// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Errors.h"

#include <limits>
#include <string>
#include <string_view>

namespace explica {

/// As a Field's `least`: any number above 0, but not 0 itself.
inline constexpr double kAboveZero = std::numeric_limits<double>::denorm_min();

/// One option's name and meaning.  Its type and default come from the option struct itself.
struct Field {
  std::string_view name;       ///< as on the command line and in JSON: "target-visibility"
  std::string_view unit = {};  ///< "mm", "s", "degrees"; empty if none
  std::string_view help = {};  ///< one sentence
  double least = -std::numeric_limits<double>::infinity();  ///< of a number, or each of a list
  double most = std::numeric_limits<double>::infinity();    ///< checked where users set values
};

/// How an option struct is listed once, for parser, JSON, help, descriptors and Python.
///
/// Next to the struct, in its namespace, stands
///
///     template <class Visitor>
///     void describe(InterpolantOptions& options, Visitor&& visit) {
///       visit(Field{"max-iterations", "", "conjugate-gradient iterations at most", 1, 1e6},
///             options.maxIterations);
///     }
///
/// Members may be bool, int, double, std::string, Eigen::Vector3d, an enum with EnumNames, and
/// std::optional or std::vector of these.

/// Names of an enum's values, as users write them; specialise with `static constexpr std::array
/// table` of std::pair{value, "name"}.
template <class Enum>
struct EnumNames;

template <class Enum>
concept NamedEnum = requires {
  EnumNames<Enum>::table;
};

/// The user's word for a value.
template <NamedEnum Enum>
[[nodiscard]] constexpr std::string_view nameOf(Enum value) {
  for (const auto& [candidate, name] : EnumNames<Enum>::table) {
    if (candidate == value) return name;
  }
  return "unknown";
}

/// All words, joined: "hybrid|eulerian|lagrangian".
template <NamedEnum Enum>
[[nodiscard]] std::string choicesOf(std::string_view separator = "|") {
  std::string joined;
  for (const auto& [value, name] : EnumNames<Enum>::table) {
    if (!joined.empty()) joined += separator;
    joined += name;
  }
  return joined;
}

/// The value of a user's word.
/// @throws InvalidInput  no value has this name; lists the names
template <NamedEnum Enum>
[[nodiscard]] Enum valueOf(std::string_view word) {
  for (const auto& [value, name] : EnumNames<Enum>::table) {
    if (name == word) return value;
  }
  throw InvalidInput("'" + std::string(word) + "' is not one of " + choicesOf<Enum>(", "));
}

}  // namespace explica
