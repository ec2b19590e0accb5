// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Correspondence/FieldFigure.h"

#include "Explica/Core/Errors.h"
#include "Explica/Harmonic/Phantoms.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>

using namespace explica;
using namespace explica::correspondence;

namespace {

std::size_t countOf(const std::string& text, const std::string& part) {
  std::size_t count = 0;
  for (auto at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++count;
  return count;
}

/// Places of the circles of a colour and radius.
std::vector<Eigen::Vector2d> circles(const std::string& svg, const std::string& radius,
                                     const std::string& colour) {
  std::vector<Eigen::Vector2d> found;
  for (auto at = svg.find("<circle"); at != std::string::npos; at = svg.find("<circle", at + 1)) {
    const std::string one = svg.substr(at, svg.find("/>", at) - at);
    if (one.find("r=\"" + radius + "\"") == std::string::npos ||
        one.find(colour) == std::string::npos) {
      continue;
    }
    found.emplace_back(std::atof(one.c_str() + one.find("cx=\"") + 4),
                       std::atof(one.c_str() + one.find("cy=\"") + 4));
  }
  return found;
}

TEST(FieldFigure, TrajectoriesOfConcentricCirclesEndOnThem) {
  // Concentric circles of 10 and 20 mm.
  const auto exact = harmonic::exactEccentric(10, 20, 1e-6);
  const Grid grid = harmonic::centredGrid({60, 60, 1}, {0.75, 0.75, 1});
  const auto annulus = harmonic::annulusFromLevels(harmonic::sampled(grid, exact.innerLevel),
                                                   harmonic::sampled(grid, exact.outerLevel),
                                                   {0, harmonic::LevelInside::Below});
  const auto u = harmonic::solveInterpolant(annulus);
  const auto found = findCorrespondences(annulus, u);
  const auto cells = anatomicalGrid(annulus, u, 3);
  EXPECT_EQ(fullestSlice(annulus), 0);
  const std::string svg = drawField(annulus, u, found, 0, &cells);
  for (const char* title : {"(a) harmonic", "(b) tangent", "(c) trajectories", "(d) grid"}) {
    EXPECT_EQ(countOf(svg, title), 1U) << title;
  }
  const auto inner = circles(svg, "2.4", "#b01414"), outer = circles(svg, "2.4", "#143c9c");
  ASSERT_GT(inner.size(), 20U);
  ASSERT_EQ(inner.size(), outer.size());
  Eigen::Vector2d middle = Eigen::Vector2d::Zero();
  for (std::size_t k = 0; k < outer.size(); ++k)
    middle += outer[k] / static_cast<double>(outer.size());
  for (std::size_t k = 0; k < inner.size(); ++k) {
    // Radial, and half as far from the middle.
    EXPECT_NEAR((inner[k] - middle).norm() / (outer[k] - middle).norm(), 0.5, 0.03);
  }
  // Without a grid three panels.
  EXPECT_EQ(countOf(drawField(annulus, u, found, 0), "(d)"), 0U);
  EXPECT_THROW((void)drawField(annulus, u, found, 5), InvalidInput);
}

}  // namespace
