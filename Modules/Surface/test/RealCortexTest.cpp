// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Geometry/FaceTree.h"
#include "Explica/Geometry/MeshMeasures.h"
#include "Explica/Geometry/SelfIntersection.h"
#include "Explica/IO/VolumeFile.h"
#include "Explica/Surface/CorticalSurface.h"
#include "Explica/Testing/FreeSurferSubject.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace explica::surface {
namespace {

TEST(RealCortex, LiesWhereFreeSurferPutsItAndIsAsThick) {
  const std::filesystem::path folder = std::filesystem::path(EXPLICA_REAL_DATA) / "bert_freesurfer";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "skipped: no real data";
  TissueOptions tissue;
  tissue.hemisphere = Side::Left;
  const auto made =
      buildSurfaces(tissueFromLabels(io::readLabels(folder / "mri/ribbon.mgz").volume, tissue));

  const geometry::FaceTree tree(made.white.mesh);
  std::vector<double> distances;
  testing::ThicknessComparison thickness;
  for (const auto& vertex :
       testing::knownVertices(folder / "lh.thickness_at_known_vertices.csv.gz")) {
    const auto nearest = tree.closestPoint(vertex.place);
    distances.push_back(std::sqrt(nearest.squaredDistance));
    double sum = 0;
    for (int c = 0; c < 3; ++c) sum += made.thickness[made.white.mesh.faces(nearest.face, c)];
    if (sum > 0) thickness.add(vertex, sum / 3);
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
  EXPECT_LE(mean, 0.15);
  EXPECT_LE(high, 0.41);
  EXPECT_GT(thickness.vertices(), 0.99 * static_cast<double>(distances.size()));
  EXPECT_GE(thickness.vertexCorrelation(), 0.90);
  EXPECT_LE(thickness.difference(), 0.25);
  EXPECT_GE(regions.count, 10U);
  EXPECT_GE(regions.correlation, 0.95);
  EXPECT_TRUE(geometry::findSelfIntersections(made.pial).empty());
}

}  // namespace
}  // namespace explica::surface
