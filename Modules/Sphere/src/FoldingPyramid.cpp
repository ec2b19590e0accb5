// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "FoldingPyramid.h"

#include "Explica/Core/Parallel.h"
#include "Explica/Geometry/Fixtures.h"
#include "Explica/Geometry/MeshTopology.h"

#include <cmath>

namespace explica::sphere {
namespace {

/// Of a level before every second vertex of an edge is left out.  With 2 a coarse level still holds
/// folds as narrow as its edges, and sulci are drawn to the wrong neighbour; with 20 too little is
/// left of the coarsest for a rotation to be found.
constexpr int kSmoothings = 8;
constexpr double kOutlier = 3;    // standard deviations: maps of surfaces have heavy tails
constexpr double kLeastSd = 0.3;  // of the mean: what a template is surest of must not rule alone

Eigen::VectorXd smoothed(const Eigen::VectorXd& map, const geometry::IndexLists& around) {
  Eigen::VectorXd result(map.size());
  for (Eigen::Index v = 0; v < map.size(); ++v) {
    double sum = 0;
    const auto neighbours = around[v];
    for (const std::int32_t u : neighbours) sum += map[u];
    result[v] = (map[v] + sum / static_cast<double>(neighbours.size())) / 2;
  }
  return result;
}

/// Mean 0, variance 1, and nothing beyond kOutlier.
Eigen::VectorXd standardised(Eigen::VectorXd map) {
  for (int n = 0; n < 2; ++n) {
    map.array() -= map.mean();
    const double sd = std::sqrt(map.squaredNorm() / static_cast<double>(map.size()));
    if (!(sd > 0)) return map;
    map /= sd;
    if (n == 0) map = map.cwiseMax(-kOutlier).cwiseMin(kOutlier).eval();
  }
  return map;
}

Eigen::VectorXd weightsOf(const Eigen::VectorXd& sd) {
  const Eigen::VectorXd floored = sd.cwiseMax(kLeastSd * sd.mean());
  const Eigen::VectorXd weights = floored.cwiseProduct(floored).cwiseInverse();
  return weights / weights.mean();
}

}  // namespace

Eigen::VectorXd valuesAt(const geometry::SphereLocator& locator, const Eigen::VectorXd& values,
                         const Positions& directions) {
  Eigen::VectorXd result(directions.rows());
  parallelFor(static_cast<std::size_t>(directions.rows()), [&](std::size_t n) {
    const auto v = static_cast<Eigen::Index>(n);
    const auto place = locator.locate(directions.row(v).transpose());
    double sum = 0;
    for (int k = 0; k < 3; ++k)
      sum += place.weights[k] * values[locator.mesh().faces(place.face, k)];
    result[v] = sum;
  });
  return result;
}

std::vector<FoldingLevel> foldingPyramid(const FoldingSphere& folding, int level) {
  std::vector<FoldingLevel> pyramid(static_cast<std::size_t>(level) + 1);
  const geometry::SphereLocator locator(folding.sphere);
  std::array<Eigen::VectorXd, 2> maps, sd;
  for (int n = level; n >= 0; --n) {
    const TriangleMesh grid = geometry::makeIcosphere(n);
    const auto around = geometry::buildTopology(grid.faces, grid.vertexCount()).vertexVertices;
    FoldingLevel& here = pyramid[n];
    for (std::size_t m = 0; m < 2; ++m) {
      const auto& raw = m == 0 ? folding.sulc : folding.curvature;
      const auto& rawSd = m == 0 ? folding.sulcSd : folding.curvatureSd;
      if (n == level) {
        maps[m] = standardised(valuesAt(locator, raw, grid.positions));
        if (rawSd.size() > 0) sd[m] = valuesAt(locator, rawSd, grid.positions);
      } else {
        maps[m].conservativeResize(grid.vertexCount());
        if (sd[m].size() > 0) sd[m].conservativeResize(grid.vertexCount());
      }
      here.maps[m] = n == level ? maps[m] : standardised(maps[m]);
      here.weights[m] =
          sd[m].size() > 0 ? weightsOf(sd[m]) : Eigen::VectorXd::Ones(grid.vertexCount()).eval();
      for (int k = 0; k < kSmoothings; ++k) {
        maps[m] = smoothed(maps[m], around);
        if (sd[m].size() > 0) sd[m] = smoothed(sd[m], around);
      }
    }
    here.grid = std::make_shared<geometry::SphereLocator>(grid);
  }
  return pyramid;
}

}  // namespace explica::sphere
