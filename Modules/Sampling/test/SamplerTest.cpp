// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Sampling/Sampler.h"

#include "Explica/Core/Errors.h"
#include "Explica/Core/Parallel.h"
#include "Explica/Geometry/Fixtures.h"
#include "Explica/Sampling/Depth.h"
#include "Explica/Testing/Grids.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace explica::sampling {
namespace {

using testing::scannerGrids;
using testing::volumeOf;

Positions ball() {
  return geometry::makeIcosphere(3, 18.0, Point(3, -4, 5)).positions;
}

TEST(Sampler, GivesCoordinatesBackOnAnyGrid) {
  double worst = 0;
  for (const Grid& grid : scannerGrids()) {
    for (const Interpolation way : {Interpolation::Linear, Interpolation::Cubic}) {
      for (int axis = 0; axis < 3; ++axis) {
        const Volume<float> volume = volumeOf(grid, [&](const Point& x) { return x[axis]; });
        const std::vector<float> got = sampleVolume(volume, ball(), way);
        for (Eigen::Index p = 0; p < ball().rows(); ++p) {
          ASSERT_NEAR(got[p], ball()(p, axis), 3e-5);  // float32 at 25 mm, sums of 64
          worst = std::max(worst, std::abs(got[p] - ball()(p, axis)));
        }
      }
    }
  }
  RecordProperty("worst_mm", std::to_string(worst));
}

TEST(Sampler, TakesTheVoxelInWhichAPointLies) {
  const Grid grid = scannerGrids()[1];
  const Volume<float> volume = volumeOf(grid, [](const Point& x) { return x[0] + 3 * x[1]; });
  const Positions points = ball();
  const std::vector<float> got = sampleVolume(volume, points, Interpolation::Nearest);
  for (Eigen::Index p = 0; p < points.rows(); ++p) {
    const Vector index = grid.toIndex(points.row(p).transpose());
    EXPECT_EQ(got[p], volume(std::lround(index[0]), std::lround(index[1]), std::lround(index[2])));
  }
}

TEST(Sampler, CubicIsExactForQuadraticFunctionsAndOfThirdOrder) {
  Grid grid = scannerGrids()[1];
  const auto quadratic = [](const Point& x) {
    return 0.1 * x[0] * x[1] - 0.05 * x[2] * x[2] + x[0];
  };
  const Positions points = ball();
  const std::vector<float> got =
      sampleVolume(volumeOf(grid, quadratic), points, Interpolation::Cubic);
  for (Eigen::Index p = 0; p < points.rows(); ++p) {
    EXPECT_NEAR(got[p], quadratic(points.row(p).transpose()), 5e-5);
  }
  const auto wave = [](const Point& x) { return std::sin(0.15 * x[0]) * std::cos(0.12 * x[1]); };
  const auto error = [&](Interpolation way, double scale) {
    Grid fine = grid;
    fine.spacing /= scale;
    for (int& n : fine.size) n = static_cast<int>(n * scale);
    const std::vector<float> values = sampleVolume(volumeOf(fine, wave), points, way);
    double worst = 0;
    for (Eigen::Index p = 0; p < points.rows(); ++p) {
      worst = std::max(worst, std::abs(values[p] - wave(points.row(p).transpose())));
    }
    return worst;
  };
  const double linear =
      std::log2(error(Interpolation::Linear, 1) / error(Interpolation::Linear, 4)) / 2;
  const double cubic =
      std::log2(error(Interpolation::Cubic, 1) / error(Interpolation::Cubic, 4)) / 2;
  EXPECT_NEAR(linear, 2, 0.3);
  EXPECT_GT(cubic, 2.6);
  EXPECT_LT(cubic, 4.4);
}

/// Prolate spheroids with foci at +-c on the x axis: u is harmonic between xi = 1.2 and xi = 1.5.
struct Spheroids {
  double c = 15, inner = 1.2, outer = 1.5;
  [[nodiscard]] double xi(const Point& x) const {
    return ((x - Vector(c, 0, 0)).norm() + (x + Vector(c, 0, 0)).norm()) / (2 * c);
  }
  [[nodiscard]] double u(const Point& x) const {
    const auto level = [](double s) { return std::log((s - 1) / (s + 1)); };
    return (level(xi(x)) - level(inner)) / (level(outer) - level(inner));
  }
  /// Vertices on the same hyperbola of both spheroids correspond.
  [[nodiscard]] TriangleMesh surface(double at) const {
    TriangleMesh mesh = geometry::makeIcosphere(4, 1.0);
    for (Eigen::Index v = 0; v < mesh.vertexCount(); ++v) {
      const double across = c * std::sqrt(at * at - 1);
      mesh.positions.row(v) =
          mesh.positions.row(v).cwiseProduct(Eigen::RowVector3d(c * at, across, across)).eval();
    }
    return mesh;
  }
};

TEST(Sampler, FunctionOfUBetweenSpheroidsAtSevenDepths) {
  const Spheroids spheroids;
  Grid grid;
  grid.spacing = {0.6, 0.5, 0.55};
  grid.size = {90, 80, 74};
  grid.origin = -0.5 * grid.spacing.cwiseProduct(Vector(89, 79, 73));
  // A laminar profile: values around 2 with a peak in the middle.
  const auto profile = [](double u) { return 2 + std::sin(kPi * u) + 0.3 * u; };
  const Volume<float> volume =
      volumeOf(grid, [&](const Point& x) { return profile(std::max(-0.5, spheroids.u(x))); });
  const TriangleMesh white = spheroids.surface(spheroids.inner),
                     pial = spheroids.surface(spheroids.outer);
  double worst = 0;
  for (const DepthKind kind : {DepthKind::Depth, DepthKind::Volume}) {
    for (const double depth : depthsFromText("7")) {
      const Positions points = positionsAtDepth(white, pial, depth, kind);
      const std::vector<float> got = sampleVolume(volume, points, Interpolation::Cubic);
      for (Eigen::Index p = 0; p < points.rows(); ++p) {
        const double exact = profile(spheroids.u(points.row(p).transpose()));
        ASSERT_NEAR(got[p], exact, 0.01 * exact) << depth;
        worst = std::max(worst, std::abs(got[p] - exact) / exact);
      }
    }
  }
  RecordProperty("worst_share", std::to_string(worst));
}

TEST(Sampler, DoesNotKnowWhatLiesOutsideOrIsNaN) {
  Grid grid;
  grid.size = {4, 3, 2};
  Volume<float> volume(grid, 7.0F);
  volume(2, 1, 0) = std::numeric_limits<float>::quiet_NaN();
  Positions points(8, 3);
  points << 0, 0, 0,  // a corner voxel's centre
      -0.4, 0, 0,     // in the outermost half voxel
      -0.6, 0, 0,     // outside
      3, 2, 1,        // the last centre
      2, 1, 0,        // the unknown voxel
      1.4, 1, 0,      // nearer to its neighbour
      1.6, 1, 0,      // nearer to the unknown one
      kNaN, 0, 0;
  const bool known[] = {true, true, false, true, false, true, false, false};
  for (const auto& [way, name] : enumWords(Interpolation{})) {
    const std::vector<float> got = sampleVolume(volume, points, way);
    for (int p = 0; p < 8; ++p) {
      EXPECT_EQ(!std::isnan(got[p]), known[p]) << name << " point " << p;
      EXPECT_FLOAT_EQ(known[p] ? got[p] : 7.0F, 7.0F) << name << " point " << p;
    }
  }
}

TEST(Sampler, LeavesOutWhatTheMaskExcludes) {
  Grid grid;
  grid.size = {6, 1, 1};
  Volume<float> volume(grid);
  for (int i = 0; i < 6; ++i) volume[i] = static_cast<float>(10 * i);
  Volume<std::uint8_t> mask(grid, 1);
  mask[3] = 0;
  Positions points(3, 3);
  points << 2.25, 0, 0, 2.75, 0, 0, 4.5, 0, 0;
  const std::vector<float> got = sampleVolume(volume, points, Interpolation::Linear, &mask);
  EXPECT_FLOAT_EQ(got[0], 20);  // voxel 2 alone
  EXPECT_TRUE(std::isnan(got[1]));
  EXPECT_FLOAT_EQ(got[2], 45);
  Volume<std::uint8_t> other(Grid{});
  EXPECT_THROW(sampleVolume(volume, points, Interpolation::Linear, &other), InvalidInput);
}

TEST(Sampler, TakesAnyNumberOfFramesAtOnceWithAnyNumberOfThreads) {
  const Grid grid = scannerGrids()[2];
  std::mt19937 random(3);
  std::normal_distribution<float> normal;
  constexpr int kFrames = 2 * Sampler::kFramesAtOnce + 5;
  std::vector<float> frames(kFrames * grid.voxelCount());
  for (float& value : frames) value = normal(random);
  for (int n = 0; n < 2000; ++n) {
    frames[random() % frames.size()] = std::numeric_limits<float>::quiet_NaN();
  }
  Positions points = ball();
  points.row(0).setConstant(1000);
  for (const auto& [way, name] : enumWords(Interpolation{})) {
    const Sampler sampler(grid, points, way);
    std::vector<std::vector<float>> byThreads;
    for (const int threads : {1, 2, 4}) {
      setThreadCount(threads);
      byThreads.push_back(sampler.sample(frames));
    }
    setThreadCount(0);
    const auto bytes = [](const std::vector<float>& v) {
      return std::string(reinterpret_cast<const char*>(v.data()), v.size() * sizeof(float));
    };
    EXPECT_EQ(bytes(byThreads[0]), bytes(byThreads[1]));
    EXPECT_EQ(bytes(byThreads[0]), bytes(byThreads[2]));
    for (int f = 0; f < kFrames; ++f) {  // each frame as if it were alone
      const auto begin = frames.begin() + static_cast<std::ptrdiff_t>(f * grid.voxelCount());
      Volume<float> one(grid);
      one.data.assign(begin, begin + static_cast<std::ptrdiff_t>(grid.voxelCount()));
      const std::vector<float> alone = sampler.sample(one.data);
      for (std::size_t p = 0; p < alone.size(); ++p) {
        const float many = byThreads[0][f * alone.size() + p];
        ASSERT_EQ(std::isnan(many), std::isnan(alone[p])) << name;
        ASSERT_NEAR(std::isnan(many) ? 0 : many, std::isnan(many) ? 0 : alone[p], 1e-5) << name;
      }
    }
  }
}

TEST(Sampler, LabelsGoToTheMajority) {
  Grid grid;
  grid.size = {2, 2, 2};
  Volume<Label> labels(grid, 5);
  labels(1, 0, 0) = 9;
  labels(1, 1, 0) = 9;
  labels(1, 1, 1) = 4;
  Positions points(4, 3);
  points << 0.5, 0.5, 0.4,  // 5: a half and half of the upper rest
      0.9, 0.5, 0.1,        // 9
      0.9, 0.9, 0.9,        // 4
      3, 3, 3;
  const std::vector<Label> got =
      Sampler(grid, points, Interpolation::Linear).sampleLabels(labels.data);
  EXPECT_EQ(got, (std::vector<Label>{5, 9, 4, kNoLabel}));
}

}  // namespace
}  // namespace explica::sampling
