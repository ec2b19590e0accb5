// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Statistics/Formula.h"
#include "Explica/Statistics/Table.h"

#include <Eigen/Core>

#include <string>
#include <vector>

namespace explica::statistics {

/// A column of the table as the design uses it.
struct Factor {
  std::string name;
  std::vector<std::string> levels;  ///< in the order of their names; empty of a continuous column
  double mean = 0;                  ///< taken off a continuous column
  bool reference = false;           ///< the first level has no column wherever the factor is used
};

/// A design matrix with a name for each column: "intercept", "age", "group[patient]",
/// "group[patient]:age".
struct Design {
  Eigen::MatrixXd matrix;            ///< N x p, of full rank
  std::vector<std::string> columns;  ///< p
  std::vector<Term> terms;           ///< of the formula; the intercept's, empty, is first
  std::vector<int> termOf;           ///< p, which of `terms` a column belongs to
  std::vector<Factor> factors;
  std::vector<int> groups;  ///< N, of the random intercept, numbered from 0; empty without one
  std::vector<std::string> groupNames;
  std::vector<std::size_t> rows;     ///< N, rows of the table that are used
  std::vector<std::size_t> dropped;  ///< rows without a value in a column that is used

  [[nodiscard]] Eigen::Index people() const { return matrix.rows(); }
};

/// The design of a formula for the rows of a table.
///
/// A column with a cell that is no number is categorical, as is one named by C().  Levels are coded
/// as differences from the first (treatment coding) where the rest of their term is in the model,
/// and else by a column each.  Continuous columns have their mean over the rows used taken off, so
/// that effects of a column with an interaction are those at the mean of the other.  Rows that lack
/// a value are dropped and listed.
/// @throws InvalidInput  an unknown column, one with a single level or value, fewer rows than
///                       columns, or a column that others add up to: names the column
[[nodiscard]] Design buildDesign(const Formula& formula, const Table& table);

/// Whether effects of a design's columns can be told from each other.
/// @param x        people x columns
/// @param columns  their names
/// @throws InvalidInput  no more people than columns; or names the first column that those before
///                       it add up to, by Gram-Schmidt from left to right
void requireFullRank(const Eigen::MatrixXd& x, const std::vector<std::string>& columns);

/// Columns of each level of a categorical column, N x levels of 0 and 1.
struct Levels {
  std::vector<std::string> names;
  std::vector<int> of;  ///< N, numbered in the order of the names
};
[[nodiscard]] Levels levelsOf(const Table& table, std::string_view column,
                              const std::vector<std::size_t>& rows);

}  // namespace explica::statistics
