// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Sampling/TissueLayers.h"

#include "Explica/Core/Errors.h"
#include "Explica/Testing/Grids.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace explica::sampling {
namespace {

/// A shell between spheres of 11 and 17 mm about the middle of a grid, measured exactly.
struct Shell {
  explicit Shell(const Grid& grid)
      : thickness(grid), depth(grid), inner(grid, Eigen::Vector3f::Zero()), outer(inner) {
    const Point centre(3, -4, 5);
    for (std::size_t v = 0; v < thickness.size(); ++v) {
      const auto [i, j, k] = grid.subscripts(v);
      const Vector x = grid.toWorld(Vector(i, j, k)) - centre;
      const double r = x.norm();
      if (r < 11 || r > 17) continue;
      thickness[v] = 6;
      depth[v] = static_cast<float>((r - 11) / 6);
      inner[v] = (centre + 11 / r * x).cast<float>();
      outer[v] = (centre + 17 / r * x).cast<float>();
    }
  }
  [[nodiscard]] TissueVoxels tissue() const { return tissueOf(thickness, depth, inner, outer); }
  Volume<float> thickness, depth;
  Volume<Eigen::Vector3f> inner, outer;
};

std::vector<LayerRow> tableOf(const TissueVoxels& tissue, const LayerShares& shares,
                              const std::vector<float>& values) {
  return layerTable(tissue, shares, values, std::vector<std::int32_t>(values.size(), 0), {"all"});
}

TEST(TissueLayers, KeepTheIntegralOfTheTissue) {
  std::mt19937 random(5);
  std::normal_distribution<float> normal(1, 3);
  double worst = 0;
  for (const Grid& grid : testing::scannerGrids()) {
    const TissueVoxels tissue = Shell(grid).tissue();
    std::vector<float> values(tissue.voxels.size());
    double integral = 0;
    for (std::size_t n = 0; n < values.size(); ++n) {
      values[n] = n % 17 == 0 ? std::numeric_limits<float>::quiet_NaN() : normal(random);
      if (std::isfinite(values[n])) integral += values[n] * grid.voxelVolume();
    }
    for (const int layers : {1, 3, 20}) {
      double sum = 0;
      for (const LayerRow& row : tableOf(tissue, layersByDepth(tissue, layers), values)) {
        sum += row.mean * row.volume;
      }
      EXPECT_NEAR(sum, integral, 1e-5 * std::abs(integral));
      worst = std::max(worst, std::abs(sum / integral - 1));
    }
  }
  RecordProperty("worst_share_e9", std::to_string(1e9 * worst));
}

TEST(TissueLayers, AreThinnerThanVoxels) {
  // Layers of 0.6 mm in voxels of 0.9 to 2.1 mm: their volumes are those of thin shells.  Whole
  // voxels by their centres would be off by the share that the voxel's edge cuts off.
  for (const Grid& grid : testing::scannerGrids()) {
    const TissueVoxels tissue = Shell(grid).tissue();
    const std::vector<LayerRow> rows =
        tableOf(tissue, layersByDepth(tissue, 10), std::vector<float>(tissue.voxels.size(), 1));
    for (const LayerRow& row : rows) {
      const auto ball = [](double r) { return 4.0 / 3 * kPi * r * r * r; };
      const double low = 11 + 0.6 * (row.layer - 1), volume = ball(low + 0.6) - ball(low);
      const bool end =
          row.layer <= 2 || row.layer >= 9;  // voxels are in the tissue by their centres
      EXPECT_NEAR(row.volume, volume, (end ? 0.35 : 0.05) * volume) << row.layer;
    }
  }
}

TEST(TissueLayers, MeanOfAFunctionOfDepth) {
  const TissueVoxels tissue = Shell(testing::scannerGrids()[0]).tissue();
  const std::vector<LayerRow> rows = tableOf(tissue, layersByDepth(tissue, 4), tissue.depth);
  ASSERT_EQ(rows.size(), 4U);
  for (const LayerRow& row : rows) EXPECT_NEAR(row.mean, (row.layer - 0.5) / 4, 0.04);
}

TEST(TissueLayers, ColumnsCountAlikeWhateverTheirThickness) {
  Grid grid;
  grid.size = {30, 1, 1};
  Volume<float> thickness(grid), depth(grid);
  Volume<Eigen::Vector3f> inner(grid, Eigen::Vector3f::Zero()), outer(inner);
  // A column of 20 voxels with value 1 and one of 10 with value 4.
  std::vector<float> values;
  for (int i = 0; i < 30; ++i) {
    const bool thick = i < 20;
    thickness[i] = thick ? 20 : 10;
    depth[i] = thick ? (i + 0.5F) / 20 : (i - 20 + 0.5F) / 10;
    inner[i] = Eigen::Vector3f(thick ? 0 : 20, 0, 0);
    outer[i] = Eigen::Vector3f(thick ? 20 : 30, 0, 0);
    values.push_back(thick ? 1 : 4);
  }
  const TissueVoxels tissue = tissueOf(thickness, depth, inner, outer);
  for (const LayerRow& row : tableOf(tissue, layersByDepth(tissue, 2), values)) {
    EXPECT_NEAR(row.mean, 2, 1e-6);
    EXPECT_NEAR(row.columnMean, 2.5, 1e-6);
    EXPECT_EQ(row.volume, 15);
  }
}

TEST(TissueLayers, OfAVolumeAreWholeVoxels) {
  const Shell shell(testing::scannerGrids()[1]);
  const TissueVoxels tissue = shell.tissue();
  Volume<Label> layers(shell.depth.grid);
  for (std::size_t v = 0; v < layers.size(); ++v) layers[v] = shell.depth[v] > 0.5F ? 2 : 1;
  const std::vector<LayerRow> rows = tableOf(tissue, layersOfVolume(tissue, layers), tissue.depth);
  ASSERT_EQ(rows.size(), 2U);
  EXPECT_EQ(rows[0].count + rows[1].count, tissue.voxels.size());
  EXPECT_THROW(static_cast<void>(layersOfVolume(tissue, Volume<Label>(layers.grid))), InvalidInput);
  EXPECT_THROW(static_cast<void>(layersByDepth(tissue, 0)), InvalidInput);
}

}  // namespace
}  // namespace explica::sampling
