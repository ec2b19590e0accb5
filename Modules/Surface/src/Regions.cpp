// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Surface/Regions.h"

#include <cmath>
#include <map>

namespace explica::surface {
namespace {

Label nearestVoxel(const Volume<Label>& atlas, const Point& world) {
  const Vector at = atlas.grid.toIndex(world);
  const int i = static_cast<int>(std::lround(at[0]));
  const int j = static_cast<int>(std::lround(at[1]));
  const int k = static_cast<int>(std::lround(at[2]));
  return atlas.grid.contains(i, j, k) ? atlas(i, j, k) : 0;
}

}  // namespace

VertexKeys labelsWithin(const Volume<Label>& atlas, const Positions& white, const Positions& pial,
                        const std::function<bool(Label)>& counts) {
  constexpr double kDepths[] = {0.5, 0.25, 0.75, 0, 1};
  VertexKeys keys = VertexKeys::Zero(white.rows());
  for (Eigen::Index v = 0; v < white.rows(); ++v) {
    for (const double depth : kDepths) {
      const Point at = ((1 - depth) * white.row(v) + depth * pial.row(v)).transpose();
      const Label label = nearestVoxel(atlas, at);
      if (label == 0 || !counts(label)) continue;
      keys[v] = label;
      break;
    }
  }
  return keys;
}

std::vector<RegionMeasure> measureRegions(const VertexKeys& keys, const Eigen::VectorXd& thickness,
                                          const Eigen::VectorXd& areas,
                                          const Eigen::VectorXd& weights) {
  struct Sums {
    RegionMeasure region;
    double weight = 0, first = 0, second = 0;
  };
  std::map<Label, Sums> all;
  for (Eigen::Index v = 0; v < keys.size(); ++v) {
    if (keys[v] == 0) continue;
    Sums& sums = all[keys[v]];
    sums.region.key = keys[v];
    ++sums.region.vertices;
    sums.region.area += areas[v];
    if (!(thickness[v] > 0)) continue;
    sums.weight += weights[v];
    sums.first += weights[v] * thickness[v];
    sums.second += weights[v] * thickness[v] * thickness[v];
  }
  std::vector<RegionMeasure> regions;
  for (auto& [key, sums] : all) {
    const double mean = sums.weight > 0 ? sums.first / sums.weight : kNaN;
    sums.region.thicknessMean = mean;
    sums.region.thicknessDeviation =
        sums.weight > 0 ? std::sqrt(std::max(0.0, sums.second / sums.weight - mean * mean)) : kNaN;
    regions.push_back(sums.region);
  }
  return regions;
}

}  // namespace explica::surface
