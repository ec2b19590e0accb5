// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Statistics/Design.h"

#include <Eigen/Core>

#include <string>
#include <string_view>
#include <vector>

namespace explica::statistics {

/// What is tested: that weights^T b = 0.
struct Contrast {
  std::string name;
  std::string expression;
  Eigen::MatrixXd weights;  ///< p x r, of full rank; r = 1 is tested by t, more by F

  [[nodiscard]] bool isT() const { return weights.cols() == 1; }
};

/// Reads `NAME=EXPRESSION` or `EXPRESSION`: sums of columns of the design with factors, as in
/// `group[patient] - group[control]` or `0.5 * a + 0.5 * b`; several, with semicolons between, are
/// tested together by F, as are all columns of a term such as `group`.  The first level of a
/// factor, which has no column, is 0.
/// @throws InvalidInput  a name that is no column, level or term; weights that are all 0 or depend
///                       on each other
[[nodiscard]] Contrast parseContrast(std::string_view text, const Design& design);

/// One contrast for each term but the intercept; the intercept's where there is no other.
[[nodiscard]] std::vector<Contrast> contrastsOfTerms(const Design& design);

}  // namespace explica::statistics
