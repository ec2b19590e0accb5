// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Geometry/FaceTree.h"
#include "Explica/Geometry/MeshMeasures.h"
#include "Explica/Geometry/SelfIntersection.h"
#include "Explica/IO/VolumeFile.h"
#include "Explica/Surface/CorticalSurface.h"
#include "Explica/Surface/Measures.h"
#include "Explica/Testing/FreeSurferSubject.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace explica::surface {
namespace {

void printEvenness(const char* name, const TriangleMesh& mesh) {
  const Evenness e = evennessOf(mesh);
  std::printf(
      "%s: %.2f %% of edges above 60 degrees, longest %.2f mm, least face %.5f mm2, spike %.2f "
      "mm\n",
      name, 100 * e.dihedralAbove60, e.longestEdge, e.leastFace, e.highestSpike);
}

void printThickness(const CorticalSurfaces& made) {
  const Eigen::VectorXd areas = geometry::vertexAreas(made.white.mesh);
  double weight = 0, sum = 0, squares = 0, above = 0;
  for (Eigen::Index v = 0; v < areas.size(); ++v) {
    const double t = made.thickness[v];
    if (t <= 0) continue;
    weight += areas[v];
    sum += areas[v] * t;
    squares += areas[v] * t * t;
    if (t > 5) above += areas[v];
  }
  const double mean = sum / weight;
  std::printf(
      "thickness %.3f mm, SD %.3f, above 5 mm %.2f %%, greatest %.2f; held back %.2f %% by %.3f "
      "mm\n",
      mean, std::sqrt(squares / weight - mean * mean), 100 * above / weight,
      made.thickness.maxCoeff(),
      100.0 * static_cast<double>(made.heldBackPial) / static_cast<double>(areas.size()),
      made.heldBackMean);
  std::printf("seconds: remeshing %.1f, trajectories %.1f, growing %.1f\n", made.seconds.remeshing,
              made.seconds.trajectories, made.seconds.growing);
}

TEST(RealCortex, LiesWhereFreeSurferPutsItAndIsAsThick) {
  const std::filesystem::path folder = std::filesystem::path(EXPLICA_REAL_DATA) / "bert_freesurfer";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "skipped: no real data";
  TissueOptions tissue;
  tissue.hemisphere = Side::Left;
  const auto made =
      buildSurfaces(tissueFromLabels(io::readLabels(folder / "mri/ribbon.mgz").volume, tissue));

  const geometry::FaceTree tree(made.white.mesh);
  std::vector<double> distances;
  std::vector<std::pair<double, double>> at;
  testing::ThicknessComparison thickness;
  for (const auto& vertex :
       testing::knownVertices(folder / "lh.thickness_at_known_vertices.csv.gz")) {
    const auto nearest = tree.closestPoint(vertex.place);
    distances.push_back(std::sqrt(nearest.squaredDistance));
    double sum = 0;
    for (int c = 0; c < 3; ++c) sum += made.thickness[made.white.mesh.faces(nearest.face, c)];
    if (sum > 0) thickness.add(vertex, sum / 3);
    at.push_back({sum / 3, vertex.thickness});
  }
  ASSERT_GT(distances.size(), 40000U);
  double mean = 0;
  for (const double d : distances) mean += d / static_cast<double>(distances.size());
  std::sort(distances.begin(), distances.end());
  const double high = distances[distances.size() * 95 / 100];
  const auto regions = thickness.regions(folder / "stats/lh.aparc.stats");
  std::printf(
      "%zu points: %.3f mm from the white surface, 95 %% within %.3f mm; thickness at %zu r %.3f, "
      "difference %.3f mm; %zu regions r %.3f\n",
      distances.size(), mean, high, thickness.vertices(), thickness.vertexCorrelation(),
      thickness.difference(), regions.count, regions.correlation);
  double sums[4] = {};
  for (const auto& t : at) {
    sums[0] += t.first;
    sums[1] += t.first * t.first;
    sums[2] += t.second;
    sums[3] += t.second * t.second;
  }
  const double n = static_cast<double>(at.size());
  std::printf("at points: ours %.3f SD %.3f, FreeSurfer %.3f SD %.3f\n", sums[0] / n,
              std::sqrt(sums[1] / n - sums[0] * sums[0] / n / n), sums[2] / n,
              std::sqrt(sums[3] / n - sums[2] * sums[2] / n / n));
  printEvenness("white", made.white.mesh);
  printEvenness("mid", made.mid);
  printEvenness("pial", made.pial);
  printThickness(made);
  EXPECT_LE(mean, 0.15);
  EXPECT_LE(high, 0.41);
  EXPECT_GT(thickness.vertices(), 0.99 * static_cast<double>(distances.size()));
  EXPECT_GE(thickness.vertexCorrelation(), 0.92);
  EXPECT_LE(thickness.difference(), 0.25);
  EXPECT_GE(regions.count, 10U);
  EXPECT_GE(regions.correlation, 0.95);
  EXPECT_TRUE(geometry::findSelfIntersections(made.pial).empty());
  for (const TriangleMesh* mesh : {&made.white.mesh, &made.mid, &made.pial}) {
    const Evenness even = evennessOf(*mesh);
    EXPECT_LE(even.dihedralAbove60, mesh == &made.pial ? 0.04 : 0.025);
    EXPECT_LE(even.longestEdge, 4);
    EXPECT_GE(even.leastFace, 0.02);
    EXPECT_LE(even.highestSpike, 1.5);
  }
  EXPECT_LE(made.heldBackPial, made.pial.vertexCount() / 50);
}

}  // namespace
}  // namespace explica::surface
