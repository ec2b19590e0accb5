// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "FoldWays.h"

#include <algorithm>
#include <cmath>
#include <queue>

namespace explica::flattening {

FoldWays::FoldWays(const IntrinsicMesh& mesh, Eigen::VectorXd depth, std::vector<bool> barred)
    : depth_(std::move(depth)),
      barred_(std::move(barred)),
      steps_(static_cast<std::size_t>(mesh.vertexCount)) {
  barred_.resize(steps_.size(), false);
  for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f) {
    for (int k = 0; k < 3; ++k) {
      // A rim edge is seen from one side only; its other direction is added, too.
      const std::int32_t a = mesh.faces(f, k), b = mesh.faces(f, (k + 1) % 3);
      steps_[a].push_back({b, mesh.lengths(f, k)});
      steps_[b].push_back({a, mesh.lengths(f, k)});
    }
  }
}

CutPath FoldWays::to(std::int32_t end, const std::vector<std::int32_t>& starts) const {
  std::vector<double> cost(steps_.size(), kInfinity);
  std::vector<std::int32_t> from(steps_.size(), -1);
  using Entry = std::pair<double, std::int32_t>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> next;
  for (const std::int32_t v : starts) {
    cost[v] = 0;
    next.emplace(0, v);
  }
  while (!next.empty()) {
    const auto [way, v] = next.top();
    next.pop();
    if (way > cost[v]) continue;
    if (v == end) break;
    for (const Step& step : steps_[v]) {
      if (barred_[step.to]) continue;
      const double price = std::exp2(-0.5 * (depth_[v] + depth_[step.to]));
      const double further = way + price * step.length;
      if (!(further < cost[step.to])) continue;
      cost[step.to] = further;
      from[step.to] = v;
      next.emplace(further, step.to);
    }
  }
  CutPath path;
  if (!std::isfinite(cost[end])) return path;
  for (std::int32_t v = end; v >= 0; v = from[v]) path.push_back(v);
  std::ranges::reverse(path);
  return path;
}

double FoldWays::stepLength(std::int32_t a, std::int32_t b) const {
  for (const Step& step : steps_[a]) {
    if (step.to == b) return step.length;
  }
  return kNaN;
}

double FoldWays::lengthOf(const CutPath& path) const {
  double length = 0;
  for (std::size_t n = 1; n < path.size(); ++n) length += stepLength(path[n - 1], path[n]);
  return length;
}

double FoldWays::depthOf(const CutPath& path) const {
  double sum = 0, length = 0;
  for (std::size_t n = 1; n < path.size(); ++n) {
    const double step = stepLength(path[n - 1], path[n]);
    sum += step * 0.5 * (depth_[path[n - 1]] + depth_[path[n]]);
    length += step;
  }
  return length > 0 ? sum / length : 0;
}

std::vector<bool> besideHoles(const Disc& disc, Eigen::Index vertexCount) {
  std::vector<bool> barred(static_cast<std::size_t>(vertexCount), false);
  for (const Loop& hole : disc.holes) {
    for (const std::int32_t v : hole) barred[v] = true;
  }
  for (auto v = disc.mesh.vertexCount(); v < vertexCount; ++v) {
    barred[v] = true;
  }
  return barred;
}

}  // namespace explica::flattening
