// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Harmonic/LabelBoundary.h"

#include "Explica/Core/Parallel.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

using namespace explica;
using namespace explica::harmonic;

namespace {

using Level = std::function<double(const Eigen::Vector3d&)>;

/// A cube of voxels that are inside where a function is negative.
struct Mask {
  int size = 0;
  Level level;
  std::vector<std::uint8_t> side;

  Mask(int edge, Level function) : size(edge), level(std::move(function)) {
    for (int k = 0; k < size; ++k) {
      for (int j = 0; j < size; ++j) {
        for (int i = 0; i < size; ++i) side.push_back(level({i * 1.0, j * 1.0, k * 1.0}) < 0);
      }
    }
  }

  [[nodiscard]] std::array<int, 3> sizes() const { return {size, size, size}; }

  /// Calls f(p, at, axis) for every link that the mask crosses, `margin` voxels off the cube's
  /// faces.
  void forLinks(int margin,
                const std::function<void(std::int32_t, const Eigen::Vector3d&, int)>& f) const {
    const std::array<std::int32_t, 3> strides = {1, size, size * size};
    for (std::int32_t p = 0; p < size * size * size; ++p) {
      const std::array<int, 3> at = {p % size, p / size % size, p / size / size};
      if (std::min({at[0], at[1], at[2]}) < margin) continue;
      if (std::max({at[0], at[1], at[2]}) >= size - 1 - margin) continue;
      for (int a = 0; a < 3; ++a) {
        if (side[p] != side[p + strides[a]]) {
          f(p, Eigen::Vector3d(at[0], at[1], at[2]), a);
        }
      }
    }
  }

  /// Where the function is zero on a link, by bisection.
  [[nodiscard]] double truth(Eigen::Vector3d at, int axis) const {
    const bool inside = level(at) < 0;
    double low = 0, high = 1;
    const double start = at[axis];
    for (int k = 0; k < 40; ++k) {
      const double middle = 0.5 * (low + high);
      at[axis] = start + middle;
      ((level(at) < 0) == inside ? low : high) = middle;
    }
    return low;
  }
};

struct MaskErrors {
  double mean = 0, greatest = 0;  ///< distance to the true surface, voxels
  double meanAngleDeg = 0;        ///< between the normals
};

MaskErrors maskErrorsOf(const Mask& mask, int margin) {
  const LabelBoundary boundary(mask.side, mask.sizes(), 3);
  MaskErrors errors;
  int count = 0;
  mask.forLinks(margin, [&](std::int32_t p, const Eigen::Vector3d& at, int axis) {
    const double truth = mask.truth(at, axis);
    const Eigen::Vector3d place = at + truth * Eigen::Vector3d::Unit(axis);
    Eigen::Vector3d normal;
    for (int c = 0; c < 3; ++c) {
      const Eigen::Vector3d step = 1e-4 * Eigen::Vector3d::Unit(c);
      normal[c] = mask.level(place + step) - mask.level(place - step);
    }
    normal.normalize();
    const double error = std::abs((boundary.place(p, axis) - truth) * normal[axis]);
    errors.mean += error;
    errors.greatest = std::max(errors.greatest, error);
    const double cosine = normal.dot(boundary.normal(p, axis).cast<double>());
    errors.meanAngleDeg += std::acos(std::clamp(cosine, -1.0, 1.0)) * 180 / M_PI;
    ++count;
  });
  errors.mean /= count;
  errors.meanAngleDeg /= count;
  return errors;
}

Mask ball(double radius) {
  const int size = 2 * static_cast<int>(std::ceil(radius)) + 12;
  const Eigen::Vector3d centre(0.5 * size - 0.4, 0.5 * size + 0.1, 0.5 * size - 0.1);
  return Mask(size, [=](const Eigen::Vector3d& x) { return (x - centre).norm() - radius; });
}

/// Steps of 1 / slope voxels along x, of nearly three times as many along y.
Mask ramp(double slope) {
  return Mask(70, [=](const Eigen::Vector3d& x) {
    return x[2] - 35.2 - slope * (x[0] - 35) - 0.37 * slope * (x[1] - 34);
  });
}

}  // namespace

TEST(LabelBoundary, StraightensStepsUpToSevenVoxelsWide) {
  for (const double slope : {0.15, 0.4}) {
    const MaskErrors errors = maskErrorsOf(ramp(slope), 6);
    EXPECT_LE(errors.mean, 0.02) << slope;
    EXPECT_LE(errors.greatest, 0.06) << slope;
    EXPECT_LE(errors.meanAngleDeg, 0.5) << slope;
  }
}

TEST(LabelBoundary, LiesOnASphereToAFewHundredthsOfAVoxel) {
  for (const double radius : {12.3, 30.7}) {
    const MaskErrors errors = maskErrorsOf(ball(radius), 1);
    EXPECT_LE(errors.mean, 0.04) << radius;
    EXPECT_LE(errors.greatest, 0.33) << radius;
    EXPECT_LE(errors.meanAngleDeg, 1.5) << radius;
  }
}

TEST(LabelBoundary, InsideAndOutsideMayChangePlaces) {
  const Mask mask = ball(9.6);
  std::vector<std::uint8_t> swapped = mask.side;
  for (std::uint8_t& s : swapped) s = 1 - s;
  const LabelBoundary one(mask.side, mask.sizes(), 3), two(swapped, mask.sizes(), 3);
  mask.forLinks(0, [&](std::int32_t p, const Eigen::Vector3d&, int axis) {
    EXPECT_NEAR(one.place(p, axis), two.place(p, axis), 1e-4);
    EXPECT_LE((one.normal(p, axis) + two.normal(p, axis)).norm(), 1e-4);
  });
}

TEST(LabelBoundary, DoesNotDependOnTheNumberOfThreads) {
  const Mask mask = ball(30.7);
  const LabelBoundary many(mask.side, mask.sizes(), 3);
  setThreadCount(1);
  const LabelBoundary one(mask.side, mask.sizes(), 3);
  setThreadCount(0);
  mask.forLinks(0, [&](std::int32_t p, const Eigen::Vector3d&, int axis) {
    EXPECT_EQ(one.place(p, axis), many.place(p, axis));
  });
}
