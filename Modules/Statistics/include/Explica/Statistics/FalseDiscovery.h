// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

namespace explica::statistics {

/// The least false discovery rate at which each place would be found [BenjaminiHochberg1995]:
/// q(i) = min over j >= i of m p(j) / j, P-values in ascending order.
/// @param p       V, NaN where nothing was tested, which counts for nothing and stays NaN
[[nodiscard]] Eigen::VectorXd falseDiscoveryRate(const Eigen::VectorXd& p);

}  // namespace explica::statistics
