// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Statistics/Tfce.h"

#include "Explica/Geometry/Fixtures.h"
#include "Explica/Geometry/MeshMeasures.h"
#include "RandomNumbers.h"

#include <gtest/gtest.h>

#include <cmath>
#include <deque>

namespace explica::statistics {
namespace {

struct Field {
  geometry::IndexLists neighbours;
  std::vector<float> areas;
};

Field sphere(int levels) {
  const TriangleMesh mesh = geometry::makeIcosphere(levels, 10);
  const Eigen::VectorXf areas = geometry::vertexAreas(mesh).cast<float>();
  return {geometry::buildTopology(mesh.faces, mesh.vertexCount()).vertexVertices,
          {areas.data(), areas.data() + areas.size()}};
}

/// Area of the cluster of a vertex at a threshold.
double extentOf(const Field& field, const std::vector<float>& values, std::size_t v, double h) {
  std::vector<bool> seen(values.size());
  std::deque<std::size_t> queue = {v};
  seen[v] = true;
  double area = 0;
  for (; !queue.empty(); queue.pop_front()) {
    area += field.areas[queue.front()];
    for (const auto w : field.neighbours[queue.front()]) {
      const auto n = static_cast<std::size_t>(w);
      if (seen[n] || !(values[n] >= h)) continue;
      seen[n] = true;
      queue.push_back(n);
    }
  }
  return area;
}

TEST(Tfce, IsTheIntegralOverThresholds) {
  const Field field = sphere(2);
  const Eigen::MatrixXd random =
      testing::normalMatrix(static_cast<Eigen::Index>(field.areas.size()), 1, 11);
  std::vector<float> values;
  for (const double v : random.reshaped()) values.push_back(static_cast<float>(v));
  Tfce tfce(field.neighbours, field.areas);
  std::vector<float> enhanced(values.size());
  tfce.enhance(values, enhanced);
  for (std::size_t v = 0; v < values.size(); v += 13) {
    if (!(values[v] > 0)) continue;
    constexpr int kSteps = 4000;
    double integral = 0;
    for (int k = 0; k < kSteps; ++k) {
      const double h = values[v] * (k + 0.5) / kSteps;
      integral += extentOf(field, values, v, h) * h * h;
    }
    integral *= values[v] / kSteps;
    EXPECT_NEAR(enhanced[v], integral, 2e-3 * integral) << v;
  }
}

TEST(Tfce, OfAPlateauIsItsClosedForm) {
  const Field field = sphere(2);
  std::vector<float> values(field.areas.size(), 0.0F), enhanced(values.size());
  values[0] = 3;
  float area = field.areas[0];
  for (const auto w : field.neighbours[0]) {
    values[static_cast<std::size_t>(w)] = 3;
    area += field.areas[static_cast<std::size_t>(w)];
  }
  Tfce(field.neighbours, field.areas).enhance(values, enhanced);
  EXPECT_NEAR(enhanced[0], area * 27 / 3, 1e-4 * area);
  EXPECT_EQ(enhanced[40], 0);
}

TEST(Tfce, ChangesItsSignWithTheMap) {
  const Field field = sphere(1);
  const Eigen::MatrixXd random =
      testing::normalMatrix(static_cast<Eigen::Index>(field.areas.size()), 1, 12);
  std::vector<float> values, negative;
  for (const double v : random.reshaped()) {
    values.push_back(static_cast<float>(v));
    negative.push_back(-values.back());
  }
  Tfce tfce(field.neighbours, field.areas);
  std::vector<float> a(values.size()), b(values.size());
  tfce.enhance(values, a);
  tfce.enhance(negative, b);
  for (std::size_t v = 0; v < a.size(); ++v) EXPECT_EQ(a[v], -b[v]);
}

}  // namespace
}  // namespace explica::statistics
