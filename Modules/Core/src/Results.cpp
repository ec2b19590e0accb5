// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Core/Results.h"
#include "Explica/Core/Text.h"

#include <fnmatch.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace explica {
namespace {

/// What limits are compared with; nothing where the value is a list, unknown or not measured.
std::optional<double> measureOf(const Result::Value& value) {
  if (const auto* flag = std::get_if<bool>(&value)) return *flag ? 1 : 0;
  if (const auto* count = std::get_if<std::int64_t>(&value)) return static_cast<double>(*count);
  if (const auto* text = std::get_if<std::string>(&value)) return static_cast<double>(text->size());
  const auto* number = std::get_if<double>(&value);
  return number && !std::isnan(*number) ? std::optional(*number) : std::nullopt;
}

bool holds(const Limit& limit, double value) {
  return limit.least <= value && value <= limit.most;
}

/// The limit that says the worst of the value: a violated one before those that hold.
const Limit& decisive(const std::vector<Limit>& limits, double value) {
  const auto severity = [&](const Limit& limit) {
    return holds(limit, value) ? Judgement::Good : limit.outside;
  };
  return *std::ranges::max_element(
      limits, [&](const Limit& a, const Limit& b) { return severity(a) < severity(b); });
}

std::string withUnit(const Shown& shown) {
  return shown.text + (shown.unit.empty() ? "" : " ") + shown.unit;
}

/// A value of this result, in words.
std::string inWords(const Result& result, double value) {
  if (std::holds_alternative<bool>(result.value)) return value != 0 ? "yes" : "no";
  if (const auto* text = std::get_if<std::string>(&result.value)) {
    return value == 0 ? "none" : *text;
  }
  return withUnit(shown(value, result.unit));
}

std::string rangeOf(const Result& result, const Limit& limit) {
  if (limit.least == limit.most) return inWords(result, limit.least);
  if (std::isinf(limit.least)) return "at most " + inWords(result, limit.most);
  if (std::isinf(limit.most)) return "at least " + inWords(result, limit.least);
  return shown(limit.least, result.unit).text + " to " + inWords(result, limit.most);
}

std::string withSource(const Result& result, const Limit& limit) {
  const std::string range = rangeOf(result, limit);
  return limit.source.empty() ? range : range + " (" + limit.source + ")";
}

}  // namespace

Result& Result::within(double least, double most, Judgement outside, std::string source) {
  if (!std::isnan(least) && !std::isnan(most)) {
    limits.push_back({least, most, outside, std::move(source)});
  }
  return *this;
}

Result& Result::atMost(double most, Judgement outside, std::string source) {
  return within(-std::numeric_limits<double>::infinity(), most, outside, std::move(source));
}

Result& Result::atLeast(double least, Judgement outside, std::string source) {
  return within(least, std::numeric_limits<double>::infinity(), outside, std::move(source));
}

Result& Result::exactly(double expected, Judgement otherwise, std::string source) {
  return within(expected, expected, otherwise, std::move(source));
}

Result& Result::usual(double least, double most, std::string source) {
  return within(least, most, Judgement::Good, std::move(source));
}

Result& Result::after(std::string startKey) {
  start = std::move(startKey);
  return *this;
}

Result& Result::inHead() {
  isInHead = true;
  return *this;
}

Result& Result::compared() {
  isCompared = true;
  return *this;
}

std::optional<Judgement> Result::judgement() const {
  const auto measure = measureOf(value);
  if (!measure || limits.empty()) return {};
  const Limit& limit = decisive(limits, *measure);
  if (limit.outside == Judgement::Good) return {};
  return holds(limit, *measure) ? Judgement::Good : limit.outside;
}

std::string Result::expectation(const Limit& limit) const {
  return (limit.outside == Judgement::Good ? "usual " : "expected ") + withSource(*this, limit);
}

std::string Result::expected() const {
  const auto measure = measureOf(value);
  return measure && !limits.empty() ? withSource(*this, decisive(limits, *measure)) : "";
}

std::string Result::sentence() const {
  const auto measure = measureOf(value);
  if (!measure) return title + ": not known";
  std::string words = inWords(*this, *measure);
  if (limits.empty()) return title + ": " + words;
  const Limit& limit = decisive(limits, *measure);
  if (*measure < limit.least && words == inWords(*this, limit.least)) words = "just below " + words;
  if (*measure > limit.most && words == inWords(*this, limit.most)) words = "just above " + words;
  return title + ": " + words + "; " + expectation(limit);
}

std::vector<std::string> Results::head() const {
  std::vector<std::string> lines;
  for (const Result& result : all_) {
    const auto measure = measureOf(result.value);
    if (!result.isInHead || !measure) continue;
    const Result* start = find(result.start);
    const auto before = start ? measureOf(start->value) : std::nullopt;
    lines.push_back(result.title + " " + (before ? inWords(result, *before) + " -> " : "") +
                    inWords(result, *measure));
  }
  return lines;
}

Result& Results::add(Result result) {
  if (find(result.key)) throw std::logic_error("result '" + result.key + "' is described twice");
  return all_.emplace_back(std::move(result));
}

namespace {

template <class T>
Result::Value known(std::optional<T> value) {
  return value ? Result::Value(std::move(*value)) : Result::Value();
}

}  // namespace

Result& Results::number(std::string key, std::string title, std::string unit, std::string meaning,
                        std::optional<double> value) {
  return add({std::move(key), std::move(title), std::move(unit), std::move(meaning), known(value)});
}

Result& Results::share(std::string key, std::string title, std::string meaning,
                       std::optional<double> value) {
  return number(std::move(key), std::move(title), "share", std::move(meaning), value);
}

Result& Results::change(const std::string& key, const std::string& title, const std::string& unit,
                        const std::string& meaning, const Change& change) {
  number(key + "_initial", title + " at the start", unit, "", change.initial);
  return number(key + "_final", title, unit, meaning, change.final).after(key + "_initial");
}

Result& Results::count(std::string key, std::string title, std::string meaning,
                       std::optional<std::int64_t> value) {
  return add({std::move(key), std::move(title), {}, std::move(meaning), known(value)});
}

Result& Results::flag(std::string key, std::string title, std::string meaning,
                      std::optional<bool> value) {
  return add({std::move(key), std::move(title), {}, std::move(meaning), known(value)});
}

Result& Results::text(std::string key, std::string title, std::string meaning,
                      std::optional<std::string> value) {
  return add({std::move(key), std::move(title), {}, std::move(meaning), known(std::move(value))});
}

Result& Results::list(std::string key, std::string title, std::string unit, std::string meaning,
                      std::optional<std::vector<double>> values) {
  return add({std::move(key), std::move(title), std::move(unit), std::move(meaning),
              known(std::move(values))});
}

Result& Results::words(std::string key, std::string title, std::string meaning,
                       std::optional<std::vector<std::string>> values) {
  return add({std::move(key), std::move(title), {}, std::move(meaning), known(std::move(values))});
}

void Results::include(const Results& others) {
  for (const Result& result : others) {
    if (!find(result.key)) add(result);
  }
}

const Result* Results::find(std::string_view key) const {
  const std::string name(key);
  for (const Result& result : all_) {
    if (fnmatch(result.key.c_str(), name.c_str(), 0) == 0) return &result;
  }
  return nullptr;
}

Result& Results::operator[](std::string_view key) {
  for (Result& result : all_) {
    if (result.key == key) return result;
  }
  throw std::logic_error("no result '" + std::string(key) + "' is described");
}

namespace {

/// A cell of a table; empty where there is no one value.
std::string cellOf(const Result::Value& value) {
  if (const auto* text = std::get_if<std::string>(&value)) return *text;
  if (const auto* flag = std::get_if<bool>(&value)) return *flag ? "yes" : "no";
  if (const auto* count = std::get_if<std::int64_t>(&value)) return std::to_string(*count);
  const auto* number = std::get_if<double>(&value);
  return number ? printed("%.6g", *number) : "";
}

}  // namespace

std::string tableText(const std::vector<Results>& rows) {
  std::string text;
  if (rows.empty()) return text;
  text += joined(rows.front(), "\t", [](const Result& result) { return result.key; });
  for (const Results& row : rows) {
    text += "\n" + joined(row, "\t", [](const Result& result) { return cellOf(result.value); });
  }
  return text + "\n";
}

std::string readable(double value) {
  constexpr double kLongest = 1e12;  // what is written out, and not as a power of ten
  if (!std::isfinite(value)) return "not known";
  const bool written = std::abs(value) < kLongest;
  if (written && value == std::round(value)) return printed("%.0f", value);  // a count
  const std::string text = printed("%.3g", value);
  return written && std::abs(value) >= 999.5 ? printed("%.0f", std::stod(text)) : text;
}

Shown shown(double value, std::string_view unit) {
  if (unit == "share") return {readable(100 * value), "%"};
  if (unit == "mm^2") return {readable(value / 100), "cm\u00b2"};
  if (unit == "degrees") return {readable(value), "\u00b0"};
  return {readable(value), std::string(unit)};
}

}  // namespace explica
