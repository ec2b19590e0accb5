// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include <random>

namespace explica::statistics::testing {

/// Independent standard normal values.
inline Eigen::MatrixXd normalMatrix(Eigen::Index rows, Eigen::Index columns, unsigned seed) {
  std::mt19937 generator(seed);
  std::normal_distribution<double> normal;
  Eigen::MatrixXd values(rows, columns);
  for (Eigen::Index c = 0; c < columns; ++c) {
    for (Eigen::Index r = 0; r < rows; ++r) values(r, c) = normal(generator);
  }
  return values;
}

}  // namespace explica::statistics::testing
