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
#include <vector>

namespace explica::provenance {

/// One option of a struct, with its type erased: what parser, JSON, help, descriptors and Python
/// share.  It refers to the struct it was listed from, which must outlive it.
struct Option {
  std::string name;
  std::string unit;
  std::string help;
  double least = -std::numeric_limits<double>::infinity();  ///< smallest number accepted
  double most = std::numeric_limits<double>::infinity();    ///< largest number accepted
  std::string type;         ///< "flag", "integer", "number", "text", "choice", "point2" or "point3"
  bool isOptional = false;  ///< may be unset, and has no value until it is set
  bool isList = false;      ///< takes any number of values
  std::vector<std::string> choices;                 ///< words that a choice may take
  const void* place = nullptr;                      ///< the member of the struct
  std::function<std::vector<std::string>()> words;  ///< its values now; none if unset
  /// Sets the values; none empties a list and unsets an optional.
  std::function<void(const Option& self, const std::vector<std::string>& words)> setWords;
  std::string category = {};  ///< heading in help and descriptors; set by whoever presents it

  [[nodiscard]] bool isFlag() const { return type == "flag"; }
  [[nodiscard]] bool isPoint() const { return type == "point2" || type == "point3"; }
  /// The range of its numbers in words: "1 to 1000", "at least 1", "above 0"; empty if there is
  /// none.
  [[nodiscard]] std::string range() const;
  /// The value now, as a user would write it: "1,2,3"; empty if unset.
  [[nodiscard]] std::string text() const;
  /// Sets the value from a user's words: one, or several for a list.  Points and lists of numbers
  /// or choices separate by commas; lists of text and of points take one element per word.
  /// @throws UsageError  names the option, the text and what is expected
  void setText(const std::vector<std::string>& given);
};

namespace detail {

/// What a member holds, how often.
template <class T>
struct Held {
  using Element = T;
  static constexpr bool isOptional = false, isList = false;
};
template <class T>
struct Held<std::optional<T>> : Held<T> {
  static constexpr bool isOptional = true;
};
template <class T>
struct Held<std::vector<T>> : Held<T> {
  static constexpr bool isList = true;
};

template <class T>
constexpr const char* kTypeName = "choice";
template <>
inline constexpr const char* kTypeName<bool> = "flag";
template <>
inline constexpr const char* kTypeName<int> = "integer";
template <>
inline constexpr const char* kTypeName<double> = "number";
template <>
inline constexpr const char* kTypeName<std::string> = "text";
template <>
inline constexpr const char* kTypeName<Eigen::Vector2d> = "point2";
template <>
inline constexpr const char* kTypeName<Eigen::Vector3d> = "point3";

[[noreturn]] void refuse(const Option& option, std::string_view word, const std::string& expected);

// From a value to the user's word and back.
[[nodiscard]] std::string wordOf(bool value);
[[nodiscard]] std::string wordOf(int value);
[[nodiscard]] std::string wordOf(double value);
[[nodiscard]] std::string wordOf(const std::string& value);
[[nodiscard]] std::string wordOf(const Eigen::Ref<const Eigen::VectorXd>& value);
template <NamedEnum Enum>
[[nodiscard]] std::string wordOf(Enum value) {
  return std::string(nameOf(value));
}
void read(const Option& option, const std::string& word, bool& value);
void read(const Option& option, const std::string& word, int& value);
void read(const Option& option, const std::string& word, double& value);
void read(const Option& option, const std::string& word, std::string& value);
void read(const Option& option, const std::string& word, Eigen::Vector2d& value);
void read(const Option& option, const std::string& word, Eigen::Vector3d& value);
template <NamedEnum Enum>
void read(const Option& option, const std::string& word, Enum& value) {
  for (const auto& [candidate, name] : enumWords(Enum{})) {
    if (name == word) return static_cast<void>(value = candidate);
  }
  refuse(option, word, "one of " + choicesOf<Enum>(", "));
}

}  // namespace detail

/// One option from a name and the place of its value.
template <class T>
[[nodiscard]] Option makeOption(const Field& field, T& value) {
  using Held = detail::Held<T>;
  using Element = typename Held::Element;
  Option option{std::string(field.name),
                std::string(field.unit),
                std::string(field.help),
                field.least,
                field.most,
                detail::kTypeName<Element>,
                Held::isOptional,
                Held::isList,
                {},
                &value,
                {},
                {}};
  if constexpr (NamedEnum<Element>) {
    for (const auto& [choice, name] : enumWords(Element{})) option.choices.emplace_back(name);
  }
  option.words = [&value] {
    std::vector<std::string> words;
    if constexpr (Held::isList) {
      for (const Element& one : value) words.push_back(detail::wordOf(one));
    } else if constexpr (Held::isOptional) {
      if (value) words.push_back(detail::wordOf(*value));
    } else {
      words.push_back(detail::wordOf(value));
    }
    return words;
  };
  option.setWords = [&value](const Option& self, const std::vector<std::string>& words) {
    T all{};
    for (const std::string& word : words) {
      Element one{};
      detail::read(self, word, one);
      if constexpr (Held::isList) {
        all.push_back(std::move(one));
      } else {
        all = std::move(one);
      }
    }
    value = std::move(all);
  };
  return option;
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
