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
  std::vector<double> distances, ours, theirs;
  std::map<std::string, std::pair<double, double>> byRegion;  // thickness times area, area
  for (const auto& vertex :
       testing::knownVertices(folder / "lh.thickness_at_known_vertices.csv.gz")) {
    const auto nearest = tree.closestPoint(vertex.place);
    distances.push_back(std::sqrt(nearest.squaredDistance));
    double thickness = 0;
    for (int c = 0; c < 3; ++c) thickness += made.thickness[made.white.mesh.faces(nearest.face, c)];
    if (thickness <= 0) continue;
    ours.push_back(thickness / 3);
    theirs.push_back(vertex.thickness);
    byRegion[vertex.region].first += vertex.area * ours.back();
    byRegion[vertex.region].second += vertex.area;
  }
  ASSERT_GT(distances.size(), 40000U);
  double mean = 0;
  for (const double d : distances) mean += d / static_cast<double>(distances.size());
  std::sort(distances.begin(), distances.end());
  const double high = distances[distances.size() * 95 / 100];
  double difference = 0;
  for (std::size_t k = 0; k < ours.size(); ++k) {
    difference += std::abs(ours[k] - theirs[k]) / static_cast<double>(ours.size());
  }
  std::vector<double> ourRegions, theirRegions;
  for (const auto& [region, expected] : testing::regionStats(folder / "stats/lh.aparc.stats")) {
    // A part of a region need not be as thick as the whole.
    if (byRegion[region].second < 0.5 * expected.area) continue;
    ourRegions.push_back(byRegion[region].first / byRegion[region].second);
    theirRegions.push_back(expected.thickness);
  }
  std::printf(
      "%zu points: %.3f mm from the white surface, 95 %% within %.3f mm; thickness r %.3f, "
      "difference %.3f mm; %zu regions r %.3f\n",
      distances.size(), mean, high, testing::correlation(ours, theirs), difference,
      ourRegions.size(), testing::correlation(ourRegions, theirRegions));
  EXPECT_LE(mean, 0.15);
  EXPECT_LE(high, 0.41);
  EXPECT_GE(testing::correlation(ours, theirs), 0.90);
  EXPECT_LE(difference, 0.25);
  EXPECT_GE(ourRegions.size(), 10U);
  EXPECT_GE(testing::correlation(ourRegions, theirRegions), 0.95);
  EXPECT_TRUE(geometry::findSelfIntersections(made.pial).empty());
}

}  // namespace
}  // namespace explica::surface
