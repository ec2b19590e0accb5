// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
// Colours as people without one kind of cones see them.
#include "Explica/Report/ColourMap.h"

#include <gtest/gtest.h>

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <vector>

namespace explica::report {
namespace {

struct Sight {
  const char* name;
  Eigen::Matrix3d matrix;  ///< of linear sRGB
};

/// Of normal eyes, and without red, green or blue cones [Machado2009, table 1, severity 1].
std::vector<Sight> sights() {
  std::vector<Sight> all(4);
  all[0] = {"normal", Eigen::Matrix3d::Identity()};
  all[1].name = "protanopia";
  all[1].matrix << 0.152286, 1.052583, -0.204868, 0.114503, 0.786281, 0.099216, -0.003882,
      -0.048116, 1.051998;
  all[2].name = "deuteranopia";
  all[2].matrix << 0.367322, 0.860646, -0.227968, 0.280085, 0.672501, 0.047413, -0.011820, 0.042940,
      0.968881;
  all[3].name = "tritanopia";
  all[3].matrix << 1.255528, -0.076749, -0.178779, -0.078411, 0.930809, 0.147602, 0.004733,
      0.691367, 0.303900;
  return all;
}

/// CIELAB under D65 of what somebody sees of a colour.
Eigen::Vector3d labOf(const Colour& colour, const Sight& sight) {
  Eigen::Matrix3d toXyz;
  toXyz << 0.4124564, 0.3575761, 0.1804375, 0.2126729, 0.7151522, 0.0721750, 0.0193339, 0.1191920,
      0.9503041;
  const Eigen::Vector3d linear(colour[0], colour[1], colour[2]);
  const Eigen::Vector3d white(0.95047, 1, 1.08883);
  const Eigen::Vector3d seen = (sight.matrix * linear).cwiseMax(0).cwiseMin(1);
  Eigen::Vector3d f = (toXyz * seen).cwiseQuotient(white);
  for (double& t : f) t = t > 216.0 / 24389 ? std::cbrt(t) : (24389.0 / 27 * t + 16) / 116;
  return {116 * f[1] - 16, 500 * (f[0] - f[1]), 200 * (f[1] - f[2])};
}

constexpr int kSteps = 64;

std::vector<Eigen::Vector3d> along(ColourMap map, const Sight& sight) {
  std::vector<Eigen::Vector3d> labs;
  for (int n = 0; n <= kSteps; ++n) {
    labs.push_back(labOf(colourAt(map, static_cast<double>(n) / kSteps), sight));
  }
  return labs;
}

TEST(ColourVision, LightnessOrdersTheSequentialMaps) {
  constexpr double kSpan = 55;  // of CIELAB's 100
  for (const Sight& sight : sights()) {
    for (const ColourMap map : {ColourMap::Sequential, ColourMap::Heat, ColourMap::Grey}) {
      const auto labs = along(map, sight);
      for (int n = 1; n <= kSteps; ++n) {
        EXPECT_GT(labs[n][0], labs[n - 1][0]) << sight.name << ", " << nameOf(map) << " at " << n;
      }
      EXPECT_GT(labs.back()[0] - labs.front()[0], kSpan) << sight.name << ", " << nameOf(map);
    }
  }
}

TEST(ColourVision, TheSignsOfADivergingMapAreToldApart) {
  constexpr double kApart = 35;     // of colours at a quarter and three quarters of the map
  constexpr double kFromGrey = 20;  // of each from the middle
  for (const Sight& sight : sights()) {
    const auto labs = along(ColourMap::Diverging, sight);
    const int quarter = kSteps / 4, middle = kSteps / 2;
    EXPECT_GT((labs[quarter] - labs[kSteps - quarter]).norm(), kApart) << sight.name;
    for (int n = 1; n <= middle; ++n) {
      EXPECT_GT(labs[n][0], labs[n - 1][0]) << sight.name << " at " << n;
      EXPECT_GT(labs[kSteps - n][0], labs[kSteps - n + 1][0]) << sight.name << " at " << n;
    }
    EXPECT_GT((labs[quarter] - labs[middle]).norm(), kFromGrey) << sight.name;
    EXPECT_GT((labs[kSteps - quarter] - labs[middle]).norm(), kFromGrey) << sight.name;
  }
}

TEST(ColourVision, ColoursOfLabelsAreToldApart) {
  constexpr double kApart = 15;  // a difference of 2.3 is just noticed
  for (const Sight& sight : sights()) {
    double least = 1000;
    for (Label a = 0; a <= 8; ++a) {
      for (Label b = a + 1; b <= 8; ++b) {
        least = std::min(least,
                         (labOf(colourOfLabel(a), sight) - labOf(colourOfLabel(b), sight)).norm());
      }
    }
    EXPECT_GT(least, kApart) << sight.name;
    RecordProperty(sight.name, std::to_string(least));
  }
}

}  // namespace
}  // namespace explica::report
