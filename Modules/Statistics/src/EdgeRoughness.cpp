// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Core/Parallel.h"
#include "Explica/Core/Types.h"
#include "Explica/Statistics/RandomField.h"

#include <algorithm>

namespace explica::statistics {
namespace {

constexpr std::size_t kResidualsAtOnce = 16;  // whose residuals are held

/// Residuals of the people [begin, end), one a column.
Eigen::MatrixXd residualsOf(const Eigen::MatrixXd& design, const Eigen::MatrixXd& coefficients,
                            const PersonReader& reader, std::size_t begin, std::size_t end) {
  Eigen::MatrixXd residuals(coefficients.cols(), static_cast<Eigen::Index>(end - begin));
  parallelFor(end - begin, 1, [&](std::size_t k) {
    const auto column = static_cast<Eigen::Index>(k);
    auto values = residuals.col(column);
    reader(begin + k, {values.data(), static_cast<std::size_t>(values.size())});
    values -= coefficients.transpose() * design.row(begin + k).transpose();
  });
  return residuals;
}

/// products += sum over people of r_a r_b along edges, squares += r^2.
void accumulate(const Eigen::MatrixXd& residuals, const Edges& edges, Eigen::VectorXd& products,
                Eigen::VectorXd& squares) {
  const Eigen::MatrixXd byPlace = residuals.transpose();
  parallelFor(static_cast<std::size_t>(edges.rows()), 4096, [&](std::size_t e) {
    const auto i = static_cast<Eigen::Index>(e);
    products[i] += byPlace.col(edges(i, 0)).dot(byPlace.col(edges(i, 1)));
  });
  squares += byPlace.colwise().squaredNorm().transpose();
}

}  // namespace

Eigen::VectorXd edgeRoughness(const Eigen::MatrixXd& design, const Eigen::MatrixXd& coefficients,
                              const Edges& edges, const PersonReader& reader) {
  const auto people = static_cast<std::size_t>(design.rows());
  Eigen::VectorXd products = Eigen::VectorXd::Zero(edges.rows());
  Eigen::VectorXd squares = Eigen::VectorXd::Zero(coefficients.cols());
  for (std::size_t begin = 0; begin < people; begin += kResidualsAtOnce) {
    const std::size_t end = std::min(people, begin + kResidualsAtOnce);
    accumulate(residualsOf(design, coefficients, reader, begin, end), edges, products, squares);
  }
  Eigen::VectorXd roughness(edges.rows());
  for (Eigen::Index e = 0; e < edges.rows(); ++e) {
    const double length = std::sqrt(squares[edges(e, 0)] * squares[edges(e, 1)]);
    const double value = 2 - 2 * products[e] / length;
    roughness[e] = std::isnan(value) ? kNaN : std::max(value, 0.0);
  }
  return roughness;
}

}  // namespace explica::statistics
