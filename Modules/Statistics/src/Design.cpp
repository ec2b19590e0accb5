// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Statistics/Design.h"

#include "Explica/Core/Errors.h"

#include <algorithm>
#include <map>
#include <set>

namespace explica::statistics {
namespace {

/// Below this share of its length, what of a column is not in the span of others is round-off.
constexpr double kDependent = 1e-9;

/// Coded columns with their names.
struct Coded {
  std::vector<Eigen::VectorXd> columns;
  std::vector<std::string> names;
};

std::vector<std::string> columnsUsed(const Formula& formula) {
  std::vector<std::string> used;
  for (const Term& term : formula.terms) {
    for (const std::string& column : term) {
      if (std::find(used.begin(), used.end(), column) == used.end()) used.push_back(column);
    }
  }
  return used;
}

void keepCompleteRows(Design& design, const Formula& formula, const Table& table) {
  std::vector<std::size_t> needed;
  for (const std::string& column : columnsUsed(formula)) needed.push_back(table.at(column));
  if (formula.randomIntercept) needed.push_back(table.at(*formula.randomIntercept));
  for (std::size_t r = 0; r < table.rows.size(); ++r) {
    const bool complete = std::none_of(needed.begin(), needed.end(),
                                       [&](std::size_t c) { return isMissing(table.rows[r][c]); });
    (complete ? design.rows : design.dropped).push_back(r);
  }
}

/// The numbers of a column; none if a cell is no number.
std::optional<Eigen::VectorXd> numbersOf(const Table& table, std::size_t column,
                                         const std::vector<std::size_t>& rows) {
  Eigen::VectorXd values(static_cast<Eigen::Index>(rows.size()));
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const auto value = numberIn(table.rows[rows[i]][column]);
    if (!value) return {};
    values[i] = *value;
  }
  return values;
}

[[noreturn]] void refuseOneValue(const std::string& column, const std::string& value,
                                 std::size_t people) {
  throw InvalidInput("column '" + column + "' has one value (" + value + ") in all " +
                     std::to_string(people) + " people; leave it out of the model");
}

/// Factors of the formula, and the coded columns of the table.
class Coder {
 public:
  Coder(const Formula& formula, const Table& table, Design& design)
      : formula_(formula), table_(table), design_(design) {
    for (const std::string& column : columnsUsed(formula)) read(column);
  }

  /// The product of a term's columns, each categorical one coded as the rest of the model needs.
  Coded code(const Term& term) {
    Coded product{{Eigen::VectorXd::Ones(static_cast<Eigen::Index>(design_.rows.size()))}, {""}};
    for (const std::string& column : term) {
      product = times(product, codeOf(column, hasRest(term, column)));
    }
    return product;
  }

 private:
  void read(const std::string& column) {
    const std::size_t place = table_.at(column);
    Factor factor;
    factor.name = column;
    auto numbers = numbersOf(table_, place, design_.rows);
    if (numbers && !formula_.categorical.contains(column)) {
      if ((numbers->array() == (*numbers)[0]).all()) {
        refuseOneValue(column, table_.rows[design_.rows[0]][place], design_.rows.size());
      }
      factor.mean = numbers->mean();
      values_[column] = numbers->array() - factor.mean;
    } else {
      const Levels levels = levelsOf(table_, column, design_.rows);
      if (levels.names.size() < 2) refuseOneValue(column, levels.names[0], design_.rows.size());
      factor.levels = levels.names;
      factor.reference = true;
      levels_[column] = levels;
    }
    design_.factors.push_back(std::move(factor));
  }

  Factor& factorOf(const std::string& column) {
    return *std::find_if(design_.factors.begin(), design_.factors.end(),
                         [&](const Factor& f) { return f.name == column; });
  }

  /// Whether the model spans the term without this column, so that a difference from the first
  /// level is what is left to say.
  bool hasRest(const Term& term, const std::string& column) const {
    Term rest;
    std::copy_if(term.begin(), term.end(), std::back_inserter(rest),
                 [&](const std::string& c) { return c != column; });
    if (!rest.empty()) {
      return std::any_of(formula_.terms.begin(), formula_.terms.end(), [&](const Term& other) {
        return std::is_permutation(rest.begin(), rest.end(), other.begin(), other.end());
      });
    }
    if (formula_.intercept) return true;
    const auto first =
        std::find_if(formula_.terms.begin(), formula_.terms.end(),
                     [&](const Term& t) { return t.size() == 1 && levels_.contains(t.front()); });
    return first == formula_.terms.end() || first->front() != column;
  }

  Coded codeOf(const std::string& column, bool difference) {
    const auto number = values_.find(column);
    if (number != values_.end()) return {{number->second}, {column}};
    const Levels& levels = levels_.at(column);
    if (!difference) factorOf(column).reference = false;
    Coded coded;
    for (std::size_t l = difference ? 1 : 0; l < levels.names.size(); ++l) {
      Eigen::VectorXd indicator(static_cast<Eigen::Index>(levels.of.size()));
      for (std::size_t i = 0; i < levels.of.size(); ++i) {
        indicator[i] = levels.of[i] == static_cast<int>(l) ? 1 : 0;
      }
      coded.columns.push_back(std::move(indicator));
      coded.names.push_back(column + "[" + levels.names[l] + "]");
    }
    return coded;
  }

  static Coded times(const Coded& a, const Coded& b) {
    Coded product;
    for (std::size_t i = 0; i < a.columns.size(); ++i) {
      for (std::size_t j = 0; j < b.columns.size(); ++j) {
        product.columns.push_back(a.columns[i].cwiseProduct(b.columns[j]));
        product.names.push_back(a.names[i] + (a.names[i].empty() ? "" : ":") + b.names[j]);
      }
    }
    return product;
  }

  const Formula& formula_;
  const Table& table_;
  Design& design_;
  std::map<std::string, Eigen::VectorXd> values_;
  std::map<std::string, Levels> levels_;
};

void addColumns(Design& design, const Coded& coded) {
  design.matrix.conservativeResize(
      static_cast<Eigen::Index>(design.rows.size()),
      design.matrix.cols() + static_cast<Eigen::Index>(coded.columns.size()));
  for (std::size_t j = 0; j < coded.columns.size(); ++j) {
    design.matrix.col(design.columns.size()) = coded.columns[j];
    design.columns.push_back(coded.names[j]);
    design.termOf.push_back(static_cast<int>(design.terms.size()) - 1);
  }
}

}  // namespace

void requireFullRank(const Eigen::MatrixXd& x, const std::vector<std::string>& columns) {
  if (x.rows() <= x.cols()) {
    throw InvalidInput("the model has " + std::to_string(x.cols()) + " columns for " +
                       std::to_string(x.rows()) + " people; take columns out or add people");
  }
  Eigen::MatrixXd basis(x.rows(), x.cols());
  for (Eigen::Index c = 0; c < x.cols(); ++c) {
    const double length = x.col(c).norm();
    Eigen::VectorXd rest = x.col(c);
    for (int pass = 0; pass < 2; ++pass) {
      rest -= basis.leftCols(c) * (basis.leftCols(c).transpose() * rest);
    }
    if (!(rest.norm() > kDependent * length)) {
      throw InvalidInput("column '" + columns[c] +
                         "' of the design is a sum of columns before it, so that its effect cannot "
                         "be told from theirs; leave one of them out of the model");
    }
    basis.col(c) = rest.normalized();
  }
}

Levels levelsOf(const Table& table, std::string_view column, const std::vector<std::size_t>& rows) {
  const std::size_t place = table.at(column);
  std::set<std::string> names;
  for (const std::size_t r : rows) names.insert(table.rows[r][place]);
  Levels levels{{names.begin(), names.end()}, {}};
  for (const std::size_t r : rows) {
    const auto found =
        std::lower_bound(levels.names.begin(), levels.names.end(), table.rows[r][place]);
    levels.of.push_back(static_cast<int>(found - levels.names.begin()));
  }
  return levels;
}

Design buildDesign(const Formula& formula, const Table& table) {
  Design design;
  keepCompleteRows(design, formula, table);
  if (design.rows.empty()) {
    throw InvalidInput("'" + table.name + "': nobody has a value in every column of the model");
  }
  Coder coder(formula, table, design);
  if (formula.intercept) {
    design.terms.emplace_back();
    Coded ones = coder.code({});
    ones.names = {"intercept"};
    addColumns(design, ones);
  }
  for (const Term& term : formula.terms) {
    design.terms.push_back(term);
    addColumns(design, coder.code(term));
  }
  requireFullRank(design.matrix, design.columns);
  if (formula.randomIntercept) {
    Levels groups = levelsOf(table, *formula.randomIntercept, design.rows);
    if (groups.names.size() < 2) {
      refuseOneValue(*formula.randomIntercept, groups.names[0], design.rows.size());
    }
    design.groups = std::move(groups.of);
    design.groupNames = std::move(groups.names);
  }
  return design;
}

}  // namespace explica::statistics
