// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Describe.h"

#include <Eigen/Core>

#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace explica::provenance {

/// A member whose values have names (an enum, or an optional or list of one), seen as words.
struct ChoiceTarget {
  std::vector<std::string> choices;                            ///< every word, in order
  bool optional = false;                                       ///< may be unset
  bool list = false;                                           ///< holds any number of words
  std::function<std::vector<std::string>()> get;               ///< the words held now
  std::function<void(const std::vector<std::string>& w)> set;  ///< throws InvalidInput
};

/// Where an option's value lives: a typed pointer into the option struct.
using OptionTarget =
    std::variant<bool*, int*, double*, std::string*, Eigen::Vector2d*, Eigen::Vector3d*,
                 std::optional<bool>*, std::optional<int>*, std::optional<double>*,
                 std::optional<std::string>*, std::optional<Eigen::Vector2d>*,
                 std::optional<Eigen::Vector3d>*, std::vector<int>*, std::vector<double>*,
                 std::vector<std::string>*, std::vector<Eigen::Vector2d>*,
                 std::vector<Eigen::Vector3d>*, ChoiceTarget>;

/// One option of a struct, with its type erased: what parser, JSON, help, descriptors and Python
/// share.  It refers to the struct it was listed from, which must outlive it.
struct Option {
  std::string name;
  std::string unit;
  std::string help;
  std::string category;  ///< heading in help and descriptors; set by whoever presents the option
  OptionTarget target;
  double least = -std::numeric_limits<double>::infinity();  ///< smallest number accepted
  double most = std::numeric_limits<double>::infinity();    ///< largest number accepted

  /// "flag", "integer", "number", "text", "choice", "point2" or "point3".
  [[nodiscard]] std::string type() const;
  [[nodiscard]] bool isFlag() const { return type() == "flag"; }
  /// May be unset, and has no value until it is set.
  [[nodiscard]] bool isOptional() const;
  /// Takes any number of values.
  [[nodiscard]] bool isList() const;
  /// Words that a choice may take; empty for other types.
  [[nodiscard]] std::vector<std::string> choices() const;
  /// The range of its numbers in words: "1 to 1000", "at least 1", "above 0"; empty if there is
  /// none.
  [[nodiscard]] std::string range() const;
  /// The value now, as a user would write it: "1,2,3"; empty if unset.
  [[nodiscard]] std::string text() const;
  /// Sets the value from a user's words: one, or several for a list.  Points and lists of numbers
  /// or choices separate by commas; lists of text and of points take one element per word.
  /// @throws UsageError  names the option, the text and what is expected
  void setText(const std::vector<std::string>& words);
};

namespace detail {

template <NamedEnum Enum>
std::vector<std::string> words() {
  std::vector<std::string> all;
  for (const auto& [value, name] : enumWords(Enum{})) all.emplace_back(name);
  return all;
}

template <class T>
struct Target {
  static OptionTarget of(T& value) { return &value; }
};

template <NamedEnum Enum>
struct Target<Enum> {
  static OptionTarget of(Enum& value) {
    return ChoiceTarget{
        words<Enum>(), false, false,
        [&value] { return std::vector<std::string>{std::string(nameOf(value))}; },
        [&value](const std::vector<std::string>& w) { value = valueOf<Enum>(w.at(0)); }};
  }
};

template <NamedEnum Enum>
struct Target<std::optional<Enum>> {
  static OptionTarget of(std::optional<Enum>& value) {
    return ChoiceTarget{words<Enum>(), true, false,
                        [&value] {
                          std::vector<std::string> held;
                          if (value) held.emplace_back(nameOf(*value));
                          return held;
                        },
                        [&value](const std::vector<std::string>& w) {
                          value.reset();
                          if (!w.empty()) value = valueOf<Enum>(w[0]);
                        }};
  }
};

template <NamedEnum Enum>
struct Target<std::vector<Enum>> {
  static OptionTarget of(std::vector<Enum>& value) {
    return ChoiceTarget{words<Enum>(), false, true,
                        [&value] {
                          std::vector<std::string> held;
                          for (const Enum v : value) held.emplace_back(nameOf(v));
                          return held;
                        },
                        [&value](const std::vector<std::string>& w) {
                          value.clear();
                          for (const auto& word : w) value.push_back(valueOf<Enum>(word));
                        }};
  }
};

}  // namespace detail

/// One option from a name and the place of its value.
template <class T>
[[nodiscard]] Option makeOption(const Field& field, T& value) {
  return Option{std::string(field.name),
                std::string(field.unit),
                std::string(field.help),
                {},
                detail::Target<T>::of(value),
                field.least,
                field.most};
}

/// Every option of a struct that has a `describe` function (Core/Describe.h), in its order, names
/// preceded by `prefix`.
template <class Options>
[[nodiscard]] std::vector<Option> listOptions(Options& options, std::string_view prefix = {}) {
  std::vector<Option> all;
  describe(options, [&](const Field& field, auto& value) {
    Option option = makeOption(field, value);
    option.name = std::string(prefix) + option.name;
    all.push_back(std::move(option));
  });
  return all;
}

}  // namespace explica::provenance
