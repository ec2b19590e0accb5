// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Statistics/Clusters.h"

#include <algorithm>
#include <cmath>

namespace explica::statistics {
namespace {

Cluster grow(const geometry::IndexLists& neighbours, std::vector<bool>& waiting,
             std::int32_t first) {
  Cluster cluster;
  cluster.vertices = {first};
  waiting[first] = false;
  for (std::size_t i = 0; i < cluster.vertices.size(); ++i) {
    for (const std::int32_t w : neighbours[cluster.vertices[i]]) {
      if (!waiting[w]) continue;
      waiting[w] = false;
      cluster.vertices.push_back(w);
    }
  }
  std::sort(cluster.vertices.begin(), cluster.vertices.end());
  return cluster;
}

void measure(Cluster& cluster, const Eigen::VectorXd& values, double threshold,
             const Eigen::VectorXd& areas, const Eigen::VectorXd& weights) {
  cluster.peak = cluster.vertices.front();
  for (const std::int32_t v : cluster.vertices) {
    if (values[v] > values[cluster.peak]) cluster.peak = v;
    cluster.extent += areas[v];
    cluster.mass += areas[v] * (values[v] - threshold);
    if (weights.size() > 0) cluster.weight += weights[v];
  }
}

}  // namespace

std::vector<Cluster> findClusters(const geometry::IndexLists& neighbours,
                                  const Eigen::VectorXd& values, double threshold,
                                  const Eigen::VectorXd& areas, const Eigen::VectorXd& weights) {
  std::vector<bool> waiting(static_cast<std::size_t>(values.size()));
  for (std::size_t v = 0; v < waiting.size(); ++v) {
    waiting[v] = values[v] >= threshold;
  }
  std::vector<Cluster> clusters;
  for (std::size_t v = 0; v < waiting.size(); ++v) {
    if (!waiting[v]) continue;
    clusters.push_back(grow(neighbours, waiting, static_cast<std::int32_t>(v)));
    measure(clusters.back(), values, threshold, areas, weights);
  }
  std::stable_sort(clusters.begin(), clusters.end(),
                   [](const Cluster& a, const Cluster& b) { return a.extent > b.extent; });
  return clusters;
}

LargestClusterFinder::LargestClusterFinder(const geometry::IndexLists& neighbours,
                                           const std::vector<float>& areas)
    : neighbours_(neighbours), areas_(areas), side_(areas.size()) {}

LargestCluster LargestClusterFinder::find(std::span<const float> values, float threshold) {
  for (std::size_t v = 0; v < values.size(); ++v) {
    side_[v] = static_cast<signed char>((values[v] >= threshold) - (values[v] <= -threshold));
  }
  LargestCluster largest;
  for (std::size_t first = 0; first < values.size(); ++first) {
    if (side_[first] == 0) continue;
    const signed char side = side_[first];
    LargestCluster cluster;
    stack_.assign(1, static_cast<std::int32_t>(first));
    side_[first] = 0;
    while (!stack_.empty()) {
      const auto v = static_cast<std::size_t>(stack_.back());
      stack_.pop_back();
      cluster.extent += areas_[v];
      cluster.mass += areas_[v] * (std::abs(values[v]) - threshold);
      for (const std::int32_t w : neighbours_[v]) {
        if (side_[w] != side) continue;
        side_[w] = 0;
        stack_.push_back(w);
      }
    }
    largest.extent = std::max(largest.extent, cluster.extent);
    largest.mass = std::max(largest.mass, cluster.mass);
  }
  return largest;
}

}  // namespace explica::statistics
