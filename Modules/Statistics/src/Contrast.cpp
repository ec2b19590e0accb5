// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Statistics/Contrast.h"

#include "Explica/Core/Errors.h"
#include "Explica/Core/Text.h"

#include <Eigen/QR>

#include <algorithm>
#include <cctype>

namespace explica::statistics {
namespace {

std::string trimmed(std::string_view text) {
  const auto first = text.find_first_not_of(" \t");
  if (first == text.npos) return {};
  return std::string(text.substr(first, text.find_last_not_of(" \t") - first + 1));
}

/// Parts between `separator` outside of brackets.
std::vector<std::string> parts(std::string_view text, char separator) {
  std::vector<std::string> found(1);
  int depth = 0;
  for (const char c : text) {
    if (c == '[') ++depth;
    if (c == ']') --depth;
    if (c == separator && depth == 0)
      found.emplace_back();
    else
      found.back() += c;
  }
  return found;
}

/// A name with its factor, as `- 0.5 * age` has it.
struct Summand {
  double factor = 1;
  std::string name;
};

/// Splits a sum at the signs outside of brackets and of numbers such as 1e-3.
std::vector<Summand> summandsOf(const std::string& row) {
  std::vector<Summand> found;
  std::string word;
  double sign = 1;
  int depth = 0;
  const auto close = [&] {
    Summand next{sign, {}};
    for (const std::string& piece : parts(word, '*')) {
      const std::string text = trimmed(piece);
      if (const auto number = numberIn(text))
        next.factor *= *number;
      else
        next.name += text;
    }
    found.push_back(next);
    word.clear();
  };
  for (std::size_t i = 0; i < row.size(); ++i) {
    if (row[i] == '[') ++depth;
    if (row[i] == ']') --depth;
    const bool exponent = i > 1 && (row[i - 1] == 'e' || row[i - 1] == 'E') &&
                          std::isdigit(static_cast<unsigned char>(row[i - 2])) != 0 &&
                          numberIn(trimmed(word).substr(0, trimmed(word).size() - 1));
    if ((row[i] != '+' && row[i] != '-') || depth > 0 || exponent) {
      word += row[i];
      continue;
    }
    if (!trimmed(word).empty()) {
      close();
      sign = 1;
    }
    if (row[i] == '-') sign = -sign;
  }
  close();
  return found;
}

/// True of a product with the first level of a factor that is coded by differences from it.
bool isReference(const Design& design, const std::string& name) {
  bool found = false;
  for (const std::string& part : parts(name, ':')) {
    bool known = false;
    for (const Factor& f : design.factors) {
      if (part == f.name) known = f.levels.empty();
      for (std::size_t l = 0; l < f.levels.size(); ++l) {
        if (part != f.name + "[" + f.levels[l] + "]") continue;
        known = true;
        found = found || (l == 0 && f.reference);
      }
    }
    if (!known) return false;
  }
  return found;
}

/// p x k, one for each column of the term.
Eigen::MatrixXd weightsOfTerm(const Design& design, std::size_t term) {
  const auto p = static_cast<Eigen::Index>(design.columns.size());
  std::vector<Eigen::Index> columns;
  for (Eigen::Index c = 0; c < p; ++c) {
    if (design.termOf[c] == static_cast<int>(term)) columns.push_back(c);
  }
  return Eigen::MatrixXd::Identity(p, p)(Eigen::all, columns);
}

/// p x k: one column of weights, or one for each column of a term.
Eigen::MatrixXd weightsOf(const Design& design, const std::string& name) {
  const auto p = static_cast<Eigen::Index>(design.columns.size());
  const auto column = std::ranges::find(design.columns, name);
  if (column != design.columns.end()) {
    return Eigen::VectorXd::Unit(p, column - design.columns.begin());
  }
  if (isReference(design, name)) return Eigen::VectorXd::Zero(p);
  for (std::size_t t = 0; t < design.terms.size(); ++t) {
    if (nameOfTerm(design.terms[t]) == name) return weightsOfTerm(design, t);
  }
  throw InvalidInput("contrast: '" + name + "' is no column of the design (" +
                     joined(design.columns) + ")");
}

Eigen::MatrixXd weightsOfRow(const std::string& row, const Design& design) {
  const auto summands = summandsOf(row);
  Eigen::MatrixXd sum;
  for (const Summand& s : summands) {
    if (s.name.empty()) throw InvalidInput("contrast '" + row + "': a number without a column");
    const Eigen::MatrixXd weights = s.factor * weightsOf(design, s.name);
    if (summands.size() > 1 && weights.cols() > 1) {
      throw InvalidInput("contrast '" + row + "': '" + s.name +
                         "' has several columns; name the level, as in " + s.name + "[...]");
    }
    sum = sum.size() == 0 ? weights : Eigen::MatrixXd(sum + weights);
  }
  return sum;
}

void requireTestable(const Contrast& contrast) {
  if (contrast.weights.cols() == 0 ||
      contrast.weights.colPivHouseholderQr().rank() < contrast.weights.cols()) {
    throw InvalidInput("contrast '" + contrast.name +
                       "': its weights are all 0, or one row is a sum of others");
  }
}

}  // namespace

Contrast parseContrast(std::string_view text, const Design& design) {
  Contrast contrast;
  const std::size_t equals = text.find('=');
  contrast.expression = trimmed(equals == text.npos ? text : text.substr(equals + 1));
  contrast.name = equals == text.npos ? contrast.expression : trimmed(text.substr(0, equals));
  contrast.weights.resize(design.matrix.cols(), 0);
  for (const std::string& row : parts(contrast.expression, ';')) {
    const Eigen::MatrixXd weights = weightsOfRow(trimmed(row), design);
    contrast.weights.conservativeResize(Eigen::NoChange, contrast.weights.cols() + weights.cols());
    contrast.weights.rightCols(weights.cols()) = weights;
  }
  requireTestable(contrast);
  return contrast;
}

std::vector<Contrast> contrastsOfTerms(const Design& design) {
  std::vector<Contrast> contrasts;
  for (std::size_t t = 0; t < design.terms.size(); ++t) {
    if (design.terms[t].empty() && design.terms.size() > 1) continue;
    const std::string name = nameOfTerm(design.terms[t]);
    contrasts.push_back({name, name, weightsOfTerm(design, t)});
  }
  return contrasts;
}

}  // namespace explica::statistics
