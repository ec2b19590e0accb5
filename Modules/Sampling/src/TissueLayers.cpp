// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Sampling/TissueLayers.h"

#include "Explica/Core/Errors.h"
#include "Explica/Core/Parallel.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace explica::sampling {
namespace {

constexpr int kPointsAcross = 5;  // of a voxel, along each axis

void requireGrid(const Grid& a, const Grid& b, const char* name) {
  if (!sameGrid(a, b)) {
    throw InvalidInput(std::string(name) + ": its grid is not that of the thickness");
  }
}

/// Offsets of a voxel's points, as shares of its size.
std::array<double, kPointsAcross> offsets() {
  std::array<double, kPointsAcross> at{};
  for (int i = 0; i < kPointsAcross; ++i) at[i] = (i + 0.5) / kPointsAcross - 0.5;
  return at;
}

/// Weighted sums of one layer of one region.
struct LayerSums {
  double weight = 0, sum = 0, squares = 0, columnWeight = 0, columnSum = 0;
  std::size_t count = 0;

  void add(double value, double share, double thickness) {
    weight += share;
    sum += share * value;
    squares += share * value * value;
    columnWeight += share / thickness;
    columnSum += share / thickness * value;
    ++count;
  }
};

}  // namespace

TissueVoxels tissueOf(const Volume<float>& thickness, const Volume<float>& depth,
                      const Volume<Eigen::Vector3f>& innerPoint,
                      const Volume<Eigen::Vector3f>& outerPoint) {
  requireGrid(thickness.grid, depth.grid, "depth");
  requireGrid(thickness.grid, innerPoint.grid, "inner_point");
  requireGrid(thickness.grid, outerPoint.grid, "outer_point");
  TissueVoxels tissue;
  tissue.grid = thickness.grid;
  for (std::size_t v = 0; v < thickness.size(); ++v) {
    const Eigen::Vector3f way = outerPoint[v] - innerPoint[v];
    const bool known = thickness[v] > 0 && std::isfinite(thickness[v]) && way.allFinite() &&
                       way.squaredNorm() > 0 && std::isfinite(depth[v]);
    if (!known) continue;
    tissue.voxels.push_back(v);
    tissue.depth.push_back(depth[v]);
    tissue.thickness.push_back(thickness[v]);
    tissue.along.push_back(way.normalized());
  }
  if (tissue.voxels.empty()) throw InvalidInput("thickness: no voxel has one");
  return tissue;
}

LayerShares layersByDepth(const TissueVoxels& tissue, int layers) {
  if (layers < 1 || layers > 1000) throw InvalidInput("layers: must be from 1 to 1000");
  const std::size_t count = tissue.voxels.size();
  const auto offset = offsets();
  constexpr float kPoints = kPointsAcross * kPointsAcross * kPointsAcross;
  std::vector<std::vector<std::pair<std::int32_t, float>>> parts(count);
  parallelFor(count, [&](std::size_t n) {
    // Depth per step of the whole voxel along each of its axes.
    const Vector slope = (tissue.grid.direction.transpose() * tissue.along[n].cast<double>())
                             .cwiseProduct(tissue.grid.spacing) /
                         tissue.thickness[n];
    std::vector<std::pair<std::int32_t, float>>& part = parts[n];
    for (const double z : offset) {
      for (const double y : offset) {
        for (const double x : offset) {
          const double depth = tissue.depth[n] + slope.dot(Vector(x, y, z));
          const int layer = std::clamp(static_cast<int>(std::floor(depth * layers)), 0, layers - 1);
          auto found =
              std::ranges::find_if(part, [layer](const auto& p) { return p.first == layer; });
          if (found == part.end()) found = part.insert(part.end(), {layer, 0.0F});
          found->second += 1;
        }
      }
    }
  });
  LayerShares shares;
  shares.layers = layers;
  shares.begin.push_back(0);
  for (const auto& part : parts) {
    for (const auto& [layer, share] : part) {
      shares.layerOf.push_back(layer);
      shares.share.push_back(share / kPoints);
    }
    shares.begin.push_back(shares.layerOf.size());
  }
  return shares;
}

LayerShares layersOfVolume(const TissueVoxels& tissue, const Volume<Label>& layers) {
  requireGrid(tissue.grid, layers.grid, "layers");
  LayerShares shares;
  shares.begin.push_back(0);
  for (const std::size_t v : tissue.voxels) {
    const Label layer = layers[v];
    if (layer < 0) throw InvalidInput("layers: a layer must not be negative");
    if (layer > 0) {
      shares.layerOf.push_back(layer - 1);
      shares.share.push_back(1);
      shares.layers = std::max(shares.layers, layer);
    }
    shares.begin.push_back(shares.layerOf.size());
  }
  if (shares.layers == 0) throw InvalidInput("layers: no voxel of the tissue has one");
  return shares;
}

std::vector<LayerRow> layerTable(const TissueVoxels& tissue, const LayerShares& shares,
                                 std::span<const float> values,
                                 std::span<const std::int32_t> regionOf,
                                 const std::vector<std::string>& regionNames) {
  if (values.size() != tissue.voxels.size() || regionOf.size() != values.size()) {
    throw InvalidInput("values: one for each voxel of the tissue is needed");
  }
  const auto layers = static_cast<std::size_t>(shares.layers);
  std::vector<LayerSums> sums(regionNames.size() * layers);
  for (std::size_t n = 0; n < values.size(); ++n) {
    if (regionOf[n] < 0 || !std::isfinite(values[n])) continue;
    for (std::size_t s = shares.begin[n]; s < shares.begin[n + 1]; ++s) {
      sums[regionOf[n] * layers + shares.layerOf[s]].add(values[n], shares.share[s],
                                                         tissue.thickness[n]);
    }
  }
  std::vector<LayerRow> rows;
  for (std::size_t region = 0; region < regionNames.size(); ++region) {
    for (std::size_t layer = 0; layer < layers; ++layer) {
      const LayerSums& s = sums[region * layers + layer];
      LayerRow row{.region = regionNames[region],
                   .layer = static_cast<int>(layer) + 1,
                   .count = s.count,
                   .volume = s.weight * tissue.grid.voxelVolume()};
      if (s.weight > 0) {
        row.mean = s.sum / s.weight;
        row.deviation = std::sqrt(std::max(0.0, s.squares / s.weight - row.mean * row.mean));
        row.columnMean = s.columnSum / s.columnWeight;
      }
      rows.push_back(std::move(row));
    }
  }
  return rows;
}

}  // namespace explica::sampling
