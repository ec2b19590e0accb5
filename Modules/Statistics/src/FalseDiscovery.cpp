// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Statistics/FalseDiscovery.h"

#include "Explica/Core/Types.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace explica::statistics {

Eigen::VectorXd falseDiscoveryRate(const Eigen::VectorXd& p) {
  std::vector<Eigen::Index> order;
  for (Eigen::Index v = 0; v < p.size(); ++v) {
    if (!std::isnan(p[v])) order.push_back(v);
  }
  std::stable_sort(order.begin(), order.end(),
                   [&](Eigen::Index a, Eigen::Index b) { return p[a] < p[b]; });
  const auto count = static_cast<double>(order.size());
  Eigen::VectorXd q = Eigen::VectorXd::Constant(p.size(), kNaN);
  double least = 1;
  for (std::size_t i = order.size(); i-- > 0;) {
    least = std::min(least, p[order[i]] * count / (i + 1.0));
    q[order[i]] = least;
  }
  return q;
}

}  // namespace explica::statistics
