// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Provenance/Options.h"

#include "Explica/Core/Errors.h"
#include "Explica/Core/Text.h"

#include <charconv>
#include <cmath>
#include <system_error>

namespace explica::provenance {
namespace {

/// The parts between commas, of which there is one more than commas.
std::vector<std::string> splitCommas(const std::string& text) {
  return cellsOf(text + ",", ',');
}

/// What is expected, with the range if there is one: "a whole number, 1 to 1000".
std::string inRange(const Option& option, const std::string& expected) {
  const std::string range = option.range();
  return expected + (range.empty() ? "" : ", " + range);
}

/// "within 1 to 1000", "at least 1".
std::string within(const Option& option) {
  const std::string range = option.range();
  return (range.find(" to ") == std::string::npos ? "" : "within ") + range;
}

double realIn(const Option& option, const std::string& word, const std::string& expected) {
  std::string_view digits = word;
  if (!digits.empty() && digits.front() == '+') digits.remove_prefix(1);
  double value = 0;
  const char* const end = digits.data() + digits.size();
  const auto read = std::from_chars(digits.data(), end, value);
  if (digits.empty() || read.ec != std::errc() || read.ptr != end || std::isnan(value)) {
    detail::refuse(option, word, expected);
  }
  return value;
}

template <int N>
void readPoint(const Option& option, const std::string& word, Eigen::Matrix<double, N, 1>& value) {
  const std::string expected =
      N == 2 ? "two numbers separated by a comma" : "three numbers separated by commas";
  const auto parts = splitCommas(word);
  if (parts.size() != N) detail::refuse(option, word, expected);
  for (int i = 0; i < N; ++i) value[i] = realIn(option, parts[i], expected);
}

/// A bound as people write it: 100,000,000 for 1e+08.
std::string boundText(double value) {
  constexpr double kLong = 1e5, kMostWritten = 1e12;  // in between, digits in groups of three
  const double size = std::abs(value);
  if (value != std::floor(value) || size < kLong || size > kMostWritten) {
    return detail::wordOf(value);
  }
  std::string digits = std::to_string(static_cast<long long>(value));
  const int first = value < 0 ? 1 : 0;
  for (int at = static_cast<int>(digits.size()) - 3; at > first; at -= 3) digits.insert(at, ",");
  return digits;
}

}  // namespace

namespace detail {

void refuse(const Option& option, std::string_view word, const std::string& expected) {
  throw UsageError(option.name + ": '" + std::string(word) + "' is not " + expected);
}

std::string wordOf(bool value) {
  return value ? "true" : "false";
}
std::string wordOf(int value) {
  return std::to_string(value);
}
std::string wordOf(double value) {
  char buffer[32];
  const auto end = std::to_chars(buffer, buffer + sizeof buffer, value);
  return std::string(buffer, end.ptr);
}
std::string wordOf(const std::string& value) {
  return value;
}
std::string wordOf(const Eigen::Ref<const Eigen::VectorXd>& value) {
  return joined(value, ",", [](double number) { return wordOf(number); });
}

void read(const Option& option, const std::string& word, bool& value) {
  value = word == "true" || word == "1" || word == "yes" || word == "on";
  if (!value && word != "false" && word != "0" && word != "no" && word != "off") {
    refuse(option, word, "true or false");
  }
}
void read(const Option& option, const std::string& word, int& value) {
  const std::string expected = inRange(option, "a whole number");
  const double whole = realIn(option, word, expected);  // 1e6, too
  if (whole != std::floor(whole)) refuse(option, word, expected);
  constexpr double kMost = std::numeric_limits<int>::max();
  if (whole < std::max(option.least, -kMost) || whole > std::min(option.most, kMost)) {
    refuse(option, word,
           option.range().empty() ? "within -2,147,483,647 to 2,147,483,647" : within(option));
  }
  value = static_cast<int>(whole);
}
void read(const Option& option, const std::string& word, double& value) {
  value = realIn(option, word, inRange(option, "a number"));
  if (value < option.least || value > option.most) refuse(option, word, within(option));
}
void read(const Option&, const std::string& word, std::string& value) {
  value = word;
}
void read(const Option& option, const std::string& word, Eigen::Vector2d& value) {
  readPoint(option, word, value);
}
void read(const Option& option, const std::string& word, Eigen::Vector3d& value) {
  readPoint(option, word, value);
}

}  // namespace detail

std::string Option::range() const {
  const std::string from = least == kAboveZero ? "above 0" : "at least " + boundText(least);
  if (std::isinf(most)) return std::isinf(least) ? "" : from;
  const std::string to = boundText(most);
  if (std::isinf(least)) return "at most " + to;
  return least == kAboveZero ? from + ", at most " + to : boundText(least) + " to " + to;
}

std::string Option::text() const {
  return joined(words(), isPoint() ? " " : ",");
}

void Option::setText(const std::vector<std::string>& given) {
  if (given.empty()) throw UsageError(name + ": a value is missing");
  std::vector<std::string> all;
  for (const std::string& word : given) {
    const bool isPartedByCommas = isList && !isPoint() && type != "text";
    for (std::string& part : isPartedByCommas ? splitCommas(word) : std::vector{word}) {
      all.push_back(std::move(part));
    }
  }
  setWords(*this, all);
}

}  // namespace explica::provenance
