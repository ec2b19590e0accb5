// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Errors.h"

#include <limits>
#include <string>
#include <string_view>
#include <utility>

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
/// Members may be bool, int, double, std::string, Eigen::Vector3d, an enum with enumWords(), and
/// std::optional or std::vector of these.

/// A value of an enum and the word that users write for it.  Beside the enum stands
///
///     constexpr auto enumWords(Method) {
///       return std::to_array<EnumWord<Method>>({{Method::Implicit, "implicit"}, ...});
///     }
template <class Enum>
using EnumWord = std::pair<Enum, std::string_view>;

template <class Enum>
concept NamedEnum = requires {
  enumWords(Enum{});
};

/// The user's word for a value.
template <NamedEnum Enum>
[[nodiscard]] constexpr std::string_view nameOf(Enum value) {
  for (const auto& [candidate, name] : enumWords(Enum{})) {
    if (candidate == value) return name;
  }
  return "unknown";
}

/// All words, joined: "hybrid|eulerian|lagrangian".
template <NamedEnum Enum>
[[nodiscard]] std::string choicesOf(std::string_view separator = "|") {
  std::string joined;
  for (const auto& [value, name] : enumWords(Enum{})) {
    if (!joined.empty()) joined += separator;
    joined += name;
  }
  return joined;
}

/// The value of a user's word.
/// @throws InvalidInput  no value has this name; lists the names
template <NamedEnum Enum>
[[nodiscard]] Enum valueOf(std::string_view word) {
  for (const auto& [value, name] : enumWords(Enum{})) {
    if (name == word) return value;
  }
  throw InvalidInput("'" + std::string(word) + "' is not one of " + choicesOf<Enum>(", "));
}

}  // namespace explica
