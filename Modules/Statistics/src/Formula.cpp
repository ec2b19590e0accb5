// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Statistics/Formula.h"

#include "Explica/Core/Errors.h"
#include "Explica/Core/Text.h"

#include <algorithm>
#include <cctype>

namespace explica::statistics {
namespace {

/// Reads a formula from left to right.
class Reader {
 public:
  explicit Reader(std::string_view text) : text_(text) {}

  Formula read() {
    if (text_.find('~') != text_.npos) {
      if (!accept('~')) {
        formula_.response = name();
        expect('~', "after the response");
      }
    }
    summand(false);
    while (!atEnd()) {
      const bool minus = accept('-');
      if (!minus) expect('+', "between terms");
      summand(minus);
    }
    std::stable_sort(formula_.terms.begin(), formula_.terms.end(),
                     [](const Term& a, const Term& b) { return a.size() < b.size(); });
    return formula_;
  }

 private:
  void skipSpace() {
    while (at_ < text_.size() && std::isspace(static_cast<unsigned char>(text_[at_])) != 0) ++at_;
  }
  bool atEnd() {
    skipSpace();
    return at_ == text_.size();
  }
  bool accept(char c) {
    if (atEnd() || text_[at_] != c) return false;
    ++at_;
    return true;
  }
  void expect(char c, const std::string& where) {
    if (!accept(c)) fail(std::string("expected '") + c + "' " + where);
  }
  [[noreturn]] void fail(const std::string& what) const {
    throw InvalidInput("model '" + std::string(text_) + "': " + what + " at '" +
                       std::string(text_.substr(std::min(at_, text_.size()))) + "'");
  }

  std::string name() {
    skipSpace();
    if (accept('`')) {
      const std::size_t end = text_.find('`', at_);
      if (end == text_.npos) fail("a backtick without its partner");
      const std::string word(text_.substr(at_, end - at_));
      at_ = end + 1;
      return word;
    }
    const std::size_t begin = at_;
    while (at_ < text_.size() && (std::isalnum(static_cast<unsigned char>(text_[at_])) != 0 ||
                                  text_[at_] == '_' || text_[at_] == '.')) {
      ++at_;
    }
    if (at_ == begin) fail("expected the name of a column");
    return std::string(text_.substr(begin, at_ - begin));
  }

  /// A column, C(column) or its number in a product.
  std::string column() {
    std::string word = name();
    if (word == "C" && accept('(')) {
      word = name();
      expect(')', "after C(" + word);
      formula_.categorical.insert(word);
    }
    return word;
  }

  void randomIntercept() {
    if (name() != "1") fail("a random effect is written (1 | column)");
    expect('|', "in a random effect");
    if (formula_.randomIntercept) fail("only one random intercept can be fitted");
    formula_.randomIntercept = name();
    expect(')', "after a random effect");
  }

  void summand(bool minus) {
    if (!minus && accept('-')) minus = true;
    if (accept('(')) {
      if (minus) fail("a random effect cannot be taken away");
      return randomIntercept();
    }
    const std::string first = column();
    if (first == "0" || first == "1") {
      formula_.intercept = (first == "1") != minus;
      return;
    }
    if (minus) fail("only the intercept can be taken away, by - 1;");
    product(first);
  }

  /// first:b:c, which binds tighter than a product.
  Term interaction(const std::string& first) {
    Term term = {first};
    while (accept(':')) insert(term, column());
    return term;
  }

  /// a * b * c: each term, and each union of terms.
  void product(const std::string& first) {
    std::vector<Term> found = {interaction(first)};
    while (accept('*')) {
      const Term next = interaction(column());
      const std::size_t before = found.size();
      found.push_back(next);
      for (std::size_t i = 0; i < before; ++i) {
        Term joined = found[i];
        for (const std::string& c : next) insert(joined, c);
        found.push_back(joined);
      }
    }
    for (const Term& term : found) addTerm(term);
  }

  static void insert(Term& term, const std::string& column) {
    if (std::find(term.begin(), term.end(), column) == term.end()) term.push_back(column);
  }

  void addTerm(const Term& term) {
    const auto same = [&](const Term& other) {
      return std::is_permutation(term.begin(), term.end(), other.begin(), other.end());
    };
    if (std::none_of(formula_.terms.begin(), formula_.terms.end(), same)) {
      formula_.terms.push_back(term);
    }
  }

  std::string_view text_;
  std::size_t at_ = 0;
  Formula formula_;
};

}  // namespace

Formula parseFormula(std::string_view text) {
  return Reader(text).read();
}

std::string nameOfTerm(const Term& term) {
  return term.empty() ? "intercept" : joined(term, ":");
}

}  // namespace explica::statistics
