// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Provenance/Options.h"

#include "Explica/Core/Errors.h"

#include <charconv>
#include <cmath>
#include <limits>
#include <system_error>
#include <type_traits>

namespace explica::provenance {
namespace {

template <class T>
struct IsOptional : std::false_type {};
template <class T>
struct IsOptional<std::optional<T>> : std::true_type {};
template <class T>
struct IsVector : std::false_type {};
template <class T>
struct IsVector<std::vector<T>> : std::true_type {};

/// The element type of a plain, optional or list member.
template <class T>
struct Element {
  using Type = T;
};
template <class T>
struct Element<std::optional<T>> {
  using Type = T;
};
template <class T>
struct Element<std::vector<T>> {
  using Type = T;
};

template <class T>
constexpr const char* typeName() {
  if constexpr (std::is_same_v<T, bool>) return "flag";
  if constexpr (std::is_same_v<T, int>) return "integer";
  if constexpr (std::is_same_v<T, double>) return "number";
  if constexpr (std::is_same_v<T, std::string>) return "text";
  if constexpr (std::is_same_v<T, Eigen::Vector2d>) return "point2";
  if constexpr (std::is_same_v<T, Eigen::Vector3d>) return "point3";
}

std::string numberText(double value) {
  char buffer[32];
  const auto end = std::to_chars(buffer, buffer + sizeof buffer, value);
  return std::string(buffer, end.ptr);
}

template <class T>
std::string elementText(const T& value) {
  if constexpr (std::is_same_v<T, bool>) {
    return value ? "true" : "false";
  } else if constexpr (std::is_same_v<T, int>) {
    return std::to_string(value);
  } else if constexpr (std::is_same_v<T, double>) {
    return numberText(value);
  } else if constexpr (std::is_same_v<T, std::string>) {
    return value;
  } else {
    std::string joined;
    for (Eigen::Index i = 0; i < value.size(); ++i) {
      joined += (i ? "," : "") + numberText(value[i]);
    }
    return joined;
  }
}

std::vector<std::string> splitCommas(std::string_view text) {
  std::vector<std::string> parts;
  std::size_t begin = 0;
  while (true) {
    const std::size_t comma = text.find(',', begin);
    parts.emplace_back(text.substr(begin, comma - begin));
    if (comma == std::string_view::npos) return parts;
    begin = comma + 1;
  }
}

struct Parser {
  std::string optionName;
  double least, most;
  std::string range;

  /// What is expected, with the range if there is one: "a whole number, 1 to 1000".
  [[nodiscard]] std::string inRange(const std::string& expected) const {
    return expected + (range.empty() ? "" : ", " + range);
  }

  /// "within 1 to 1000", "at least 1".
  [[nodiscard]] std::string within() const {
    return (range.find(" to ") == std::string::npos ? "" : "within ") + range;
  }

  [[noreturn]] void refuse(std::string_view text, std::string_view expected) const {
    throw UsageError(optionName + ": '" + std::string(text) + "' is not " + std::string(expected));
  }

  double real(std::string_view text, std::string_view expected) const {
    std::string_view digits = text;
    if (!digits.empty() && digits.front() == '+') digits.remove_prefix(1);
    double value = 0;
    const auto end = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    if (digits.empty() || end.ec != std::errc() || end.ptr != digits.data() + digits.size() ||
        std::isnan(value)) {
      refuse(text, expected);
    }
    return value;
  }

  void element(std::string_view text, bool& value) const {
    if (text == "true" || text == "1" || text == "yes" || text == "on") {
      value = true;
    } else if (text == "false" || text == "0" || text == "no" || text == "off") {
      value = false;
    } else {
      refuse(text, "true or false");
    }
  }
  void element(std::string_view text, int& value) const {
    const double whole = real(text, inRange("a whole number"));  // 1e6, too
    if (whole != std::floor(whole)) refuse(text, inRange("a whole number"));
    constexpr double kMost = std::numeric_limits<int>::max();
    if (whole < std::max(least, -kMost) || whole > std::min(most, kMost)) {
      refuse(text, range.empty() ? "within -2,147,483,647 to 2,147,483,647" : within());
    }
    value = static_cast<int>(whole);
  }
  void element(std::string_view text, double& value) const {
    value = real(text, inRange("a number"));
    if (value < least || value > most) refuse(text, within());
  }
  void element(std::string_view text, std::string& value) const { value = text; }
  template <int N>
  void element(std::string_view text, Eigen::Matrix<double, N, 1>& value) const {
    constexpr const char* kExpected =
        N == 2 ? "two numbers separated by a comma" : "three numbers separated by commas";
    const auto parts = splitCommas(text);
    if (parts.size() != N) refuse(text, kExpected);
    for (int i = 0; i < N; ++i) value[i] = real(parts[i], kExpected);
  }
};

}  // namespace

std::string Option::type() const {
  return std::visit(
      [](const auto& where) -> std::string {
        using Where = std::decay_t<decltype(where)>;
        if constexpr (std::is_same_v<Where, ChoiceTarget>) {
          return "choice";
        } else {
          return typeName<typename Element<std::remove_pointer_t<Where>>::Type>();
        }
      },
      target);
}

bool Option::isOptional() const {
  return std::visit(
      [](const auto& where) {
        using Where = std::decay_t<decltype(where)>;
        if constexpr (std::is_same_v<Where, ChoiceTarget>) {
          return where.optional;
        } else {
          return IsOptional<std::remove_pointer_t<Where>>::value;
        }
      },
      target);
}

bool Option::isList() const {
  return std::visit(
      [](const auto& where) {
        using Where = std::decay_t<decltype(where)>;
        if constexpr (std::is_same_v<Where, ChoiceTarget>) {
          return where.list;
        } else {
          return IsVector<std::remove_pointer_t<Where>>::value;
        }
      },
      target);
}

std::vector<std::string> Option::choices() const {
  const auto* choice = std::get_if<ChoiceTarget>(&target);
  return choice ? choice->choices : std::vector<std::string>{};
}

namespace {

/// A bound as people write it: 100,000,000 for 1e+08.
std::string boundText(double value) {
  constexpr double kLong = 1e5, kMostWritten = 1e12;  // in between, digits in groups of three
  const double size = std::abs(value);
  if (value != std::floor(value) || size < kLong || size > kMostWritten) return numberText(value);
  std::string digits = std::to_string(static_cast<long long>(value));
  const int first = value < 0 ? 1 : 0;
  for (int at = static_cast<int>(digits.size()) - 3; at > first; at -= 3) digits.insert(at, ",");
  return digits;
}

}  // namespace

std::string Option::range() const {
  const std::string from = least == kAboveZero ? "above 0" : "at least " + boundText(least);
  if (std::isinf(most)) return std::isinf(least) ? "" : from;
  const std::string to = boundText(most);
  if (std::isinf(least)) return "at most " + to;
  return least == kAboveZero ? from + ", at most " + to : boundText(least) + " to " + to;
}

std::string Option::text() const {
  return std::visit(
      [](const auto& where) -> std::string {
        using Where = std::decay_t<decltype(where)>;
        std::string joined;
        const auto append = [&joined](const std::string& part, const char* separator) {
          if (!joined.empty()) joined += separator;
          joined += part;
        };
        if constexpr (std::is_same_v<Where, ChoiceTarget>) {
          for (const auto& word : where.get()) append(word, ",");
        } else {
          using T = std::remove_pointer_t<Where>;
          if constexpr (IsOptional<T>::value) {
            if (*where) append(elementText(**where), ",");
          } else if constexpr (std::is_same_v<T, std::vector<Eigen::Vector2d>> ||
                               std::is_same_v<T, std::vector<Eigen::Vector3d>>) {
            for (const auto& element : *where) append(elementText(element), " ");
          } else if constexpr (IsVector<T>::value) {
            for (const auto& element : *where) append(elementText(element), ",");
          } else {
            append(elementText(*where), ",");
          }
        }
        return joined;
      },
      target);
}

void Option::setText(const std::vector<std::string>& words) {
  const Parser parse{name, least, most, range()};
  if (words.empty()) throw UsageError(name + ": a value is missing");
  std::visit(
      [&](auto& where) {
        using Where = std::decay_t<decltype(where)>;
        if constexpr (std::is_same_v<Where, ChoiceTarget>) {
          std::vector<std::string> all;
          for (const auto& word : words) {
            if (where.list) {
              for (auto& part : splitCommas(word)) all.push_back(std::move(part));
            } else {
              all = {word};
            }
          }
          try {
            where.set(all);
          } catch (const InvalidInput& error) {
            throw UsageError(name + ": " + error.what());
          }
        } else {
          using T = std::remove_pointer_t<Where>;
          if constexpr (IsVector<T>::value) {
            using E = typename Element<T>::Type;
            T all;
            for (const auto& word : words) {
              if constexpr (std::is_same_v<E, int> || std::is_same_v<E, double>) {
                for (const auto& part : splitCommas(word)) {
                  E value{};
                  parse.element(part, value);
                  all.push_back(value);
                }
              } else {
                E value;
                parse.element(word, value);
                all.push_back(value);
              }
            }
            *where = std::move(all);
          } else {
            typename Element<T>::Type value{};
            parse.element(words.back(), value);
            *where = std::move(value);
          }
        }
      },
      target);
}

}  // namespace explica::provenance
