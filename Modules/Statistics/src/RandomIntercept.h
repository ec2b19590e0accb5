// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include <vector>

namespace explica::statistics {

/// One place's fit.
struct PlaceFit {
  Eigen::VectorXd coefficients;  ///< p
  Eigen::MatrixXd inverse;       ///< p x p, (X^T V^-1 X)^-1 with V = I + ratio Z Z^T
  double variance = 0;           ///< of the residuals
  double ratio = 0;              ///< variance of the intercepts over that, >= 0
};

/// Generalised least squares at the random intercept's variance of largest restricted likelihood.
/// @param design  n x p of full rank, n > p
/// @param groups  n, from 0
[[nodiscard]] PlaceFit fitRandomIntercept(const Eigen::MatrixXd& design,
                                          const Eigen::VectorXd& values,
                                          const std::vector<int>& groups);

}  // namespace explica::statistics
