// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Statistics/GroupMaps.h"

#include "Explica/Core/OrderStatistics.h"
#include "Explica/Core/Types.h"
#include "Explica/Statistics/Distributions.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace explica::statistics {
namespace {

// Of the mean; a deviation below is rounding: maps are single precision.
constexpr double kNoDifference = 1e-6;

}  // namespace

GroupMaps::GroupMaps(Eigen::Index places)
    : count_(Eigen::VectorXd::Zero(places)), mean_(count_), squares_(count_) {}

void GroupMaps::add(const Eigen::VectorXd& map) {
  for (Eigen::Index v = 0; v < map.size(); ++v) {
    if (!std::isfinite(map[v])) continue;
    const double from = map[v] - mean_[v];
    mean_[v] += from / ++count_[v];
    squares_[v] += from * (map[v] - mean_[v]);
  }
}

Eigen::VectorXd GroupMaps::mean() const {
  return (count_.array() > 0).select(mean_, kNaN);
}

Eigen::VectorXd GroupMaps::deviation() const {
  const Eigen::ArrayXd variance = squares_.array() / (count_.array() - 1);
  return (count_.array() > 1).select(variance.sqrt().matrix(), kNaN);
}

Eigen::VectorXd GroupMaps::variation() const {
  return deviation().cwiseQuotient(mean());
}

Eigen::VectorXd GroupMaps::distance(const Eigen::VectorXd& map, bool member) const {
  Eigen::VectorXd z = Eigen::VectorXd::Constant(map.size(), kNaN);
  for (Eigen::Index v = 0; v < map.size(); ++v) {
    const double n = member ? count_[v] - 1 : count_[v];
    if (!std::isfinite(map[v]) || n < 3) continue;  // says little
    const double from = map[v] - mean_[v];
    const double apart = member ? from * (n + 1) / n : from;  // from the others' mean
    const double squares = member ? squares_[v] - from * apart : squares_[v];
    const double deviation = std::sqrt(std::max(squares, 0.0) / (n - 1));
    if (!(deviation > kNoDifference * std::abs(mean_[v]))) continue;
    z[v] = apart / (deviation * std::sqrt(1 + 1 / n));
  }
  return z;
}

double typicalDistance(const Eigen::VectorXd& z, Eigen::Index others) {
  std::vector<double> sizes;
  for (const double value : z) {
    if (std::isfinite(value)) sizes.push_back(std::abs(value));
  }
  if (sizes.empty() || others < 2) return kNaN;
  return upperMedian(std::move(sizes)) / tQuantile(0.25, static_cast<double>(others - 1));
}

}  // namespace explica::statistics
