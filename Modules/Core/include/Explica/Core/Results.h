// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Describe.h"

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace explica {

/// What a value says to a reader, once it is compared with its limits.
enum class Judgement {
  Good,
  Look,  ///< worth a look: the verdict of the summary is "look"
  Doubt  ///< not to be believed as it is: the verdict is "doubtful", the exit code 3
};
constexpr auto enumWords(Judgement) {
  using enum Judgement;
  return std::to_array<EnumWord<Judgement>>({{Good, "good"}, {Look, "look"}, {Doubt, "doubt"}});
}

/// A range in which a value is expected, its ends included.  A flag counts as 0 or 1, a text as
/// its length.
struct Limit {
  double least = -std::numeric_limits<double>::infinity();
  double most = std::numeric_limits<double>::infinity();
  Judgement outside = Judgement::Look;  ///< of a value outside; Good: the range does not judge
  std::string source;                   ///< a paper, or the reason in a few words
};

class Results;

/// One result of a stage: its name, its meaning and its value.
struct Result {
  /// std::monostate: not measured in this run, and left out.  NaN: measured, but not known.
  using Value = std::variant<std::monostate, bool, std::int64_t, double, std::string,
                             std::vector<double>, std::vector<std::string>, std::vector<Results>>;

  std::string key;      ///< in summary.json: "thickness_mean"; '*' stands for any characters
  std::string title;    ///< "Mean thickness", without unit
  std::string unit;     ///< "mm", "mm^2", "s"; "share": 0 to 1, shown in per cent; empty: none
  std::string meaning;  ///< one sentence
  Value value;
  std::vector<Limit> limits = {};
  std::string start = {};   ///< key of the same quantity at the start, shown in front of it
  bool isInHead = false;    ///< shown at a run's end and the head of reports, first in study tables
  bool isCompared = false;  ///< should be alike in all people: outliers of a study are marked

  Result& within(double least, double most, Judgement outside, std::string source);
  Result& atMost(double most, Judgement outside, std::string source);
  Result& atLeast(double least, Judgement outside, std::string source);
  Result& exactly(double value, Judgement otherwise, std::string source);
  /// A range that most people have and that judges nobody; after the limits that judge.
  Result& usual(double least, double most, std::string source);
  Result& after(std::string startKey);
  Result& inHead();
  Result& compared();

  /// The worst that any limit says of the value; nothing where none judges or it is not known.
  [[nodiscard]] std::optional<Judgement> judgement() const;
  /// "expected 1 to 5 mm (Fischl 2000)"
  [[nodiscard]] std::string expectation(const Limit& limit) const;
  /// "1 to 5 mm (Fischl 2000)": the limit that judges; empty where the value is not known.
  [[nodiscard]] std::string expected() const;
  /// "Mean thickness: 5.4 mm; expected 1 to 5 mm (Fischl 2000)"
  [[nodiscard]] std::string sentence() const;
};

/// A quantity before and after.
struct Change {
  std::optional<double> initial, final;
};

/// The results of a stage, listed once, for summary.json, verdict, reports, study tables,
/// reference pages and Python.
///
/// Next to a stage's result struct, in its namespace, stands
///
///     inline void describe(Results& t, const RepairSummary& r) {
///       t.count("pairs_after", "Intersecting pairs of faces", "Found by an exact test.", r.after)
///           .exactly(0, Judgement::Doubt, "a surface does not cross itself");
///     }
///
/// It lists the same keys whatever the values are, so that a default-constructed struct describes
/// the stage without a run.
class Results {
 public:
  Result& number(std::string key, std::string title, std::string unit, std::string meaning,
                 std::optional<double> value);
  /// A number from 0 to 1, shown in per cent.
  Result& share(std::string key, std::string title, std::string meaning,
                std::optional<double> value);
  /// A number before and after: KEY_initial and KEY_final.
  /// @return the one after, which shows the other in front of it
  Result& change(const std::string& key, const std::string& title, const std::string& unit,
                 const std::string& meaning, const Change& change);
  Result& count(std::string key, std::string title, std::string meaning,
                std::optional<std::int64_t> value);
  Result& flag(std::string key, std::string title, std::string meaning, std::optional<bool> value);
  Result& text(std::string key, std::string title, std::string meaning,
               std::optional<std::string> value);
  template <NamedEnum Enum>
  Result& text(std::string key, std::string title, std::string meaning, Enum value) {
    return text(std::move(key), std::move(title), std::move(meaning), std::string(nameOf(value)));
  }
  Result& list(std::string key, std::string title, std::string unit, std::string meaning,
               std::optional<std::vector<double>> values);
  Result& words(std::string key, std::string title, std::string meaning,
                std::optional<std::vector<std::string>> values);
  /// The results of each part, of a type with a `describe` of its own.
  template <class Part>
  Result& each(std::string key, std::string title, std::string meaning,
               const std::vector<Part>& parts) {
    std::vector<Results> described(parts.size());
    for (std::size_t n = 0; n < parts.size(); ++n) describe(described[n], parts[n]);
    return add({std::move(key), std::move(title), {}, std::move(meaning), std::move(described)});
  }

  /// A result that is listed already, to set limits that only this stage has.
  /// @throws std::logic_error  none has this key
  Result& operator[](std::string_view key);
  /// Takes in those of another stage whose keys are not listed yet.
  void include(const Results& others);
  [[nodiscard]] auto begin() const { return all_.begin(); }
  [[nodiscard]] auto end() const { return all_.end(); }
  /// "Average visibility 0.45 -> 0.98" of each known result of the head.
  [[nodiscard]] std::vector<std::string> head() const;
  /// The result of that key, or the one whose pattern it matches, or nullptr.
  [[nodiscard]] const Result* find(std::string_view key) const;

 private:
  Result& add(Result result);

  std::vector<Result> all_;
};

/// A tab-separated table: a row of keys, then the values of each part, which have the same keys.
[[nodiscard]] std::string tableText(const std::vector<Results>& rows);
template <class Part>
[[nodiscard]] std::string tableOf(const std::vector<Part>& parts) {
  std::vector<Results> rows(parts.size());
  for (std::size_t n = 0; n < parts.size(); ++n) describe(rows[n], parts[n]);
  return tableText(rows);
}

/// A number as people read it: three significant digits, whole numbers in full.
[[nodiscard]] std::string readable(double value);

/// A value and its unit as people read them: shares in per cent, areas in square centimetres.
struct Shown {
  std::string text, unit;
};
[[nodiscard]] Shown shown(double value, std::string_view unit);

}  // namespace explica
