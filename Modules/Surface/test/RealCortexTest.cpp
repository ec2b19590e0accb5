// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "../src/AnnulusBetween.h"
#include "Explica/Geometry/FaceTree.h"
#include "Explica/Geometry/MeshMeasures.h"
#include "Explica/Geometry/MeshTopology.h"
#include "Explica/Geometry/SelfIntersection.h"
#include "Explica/IO/VolumeFile.h"
#include "Explica/Surface/CorticalSurface.h"
#include "Explica/Surface/Measures.h"
#include "Explica/Surface/TissueSheet.h"
#include "Explica/Testing/FreeSurferSubject.h"
#include "VoxelAndVertex.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numeric>
#include <string>
#include <tuple>
#include <vector>

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

/// Our surfaces beside FreeSurfer's known points.
struct Agreement {
  double distance = 0, distance95 = 0;       ///< of the points from our white surface, mm
  double correlation = 0, difference = 0;    ///< of thickness at the points; mm
  double deviation = 0, theirDeviation = 0;  ///< of thickness at the points, mm
  double regions = 0;                        ///< correlation of regional means
  std::size_t points = 0, withThickness = 0, regionCount = 0;
};

Agreement agreementWith(const std::filesystem::path& folder, const CorticalSurfaces& made) {
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
  Agreement found;
  found.points = distances.size();
  if (distances.empty()) return found;
  found.distance = std::accumulate(distances.begin(), distances.end(), 0.0) /
                   static_cast<double>(distances.size());
  std::sort(distances.begin(), distances.end());
  found.distance95 = distances[distances.size() * 95 / 100];
  found.withThickness = thickness.vertices();
  found.correlation = thickness.vertexCorrelation();
  found.difference = thickness.difference();
  std::tie(found.deviation, found.theirDeviation) = thickness.deviations();
  const auto regions = thickness.regions(folder / "stats/lh.aparc.stats");
  found.regions = regions.correlation;
  found.regionCount = regions.count;
  testing::ThicknessComparison nearestWays;
  for (const auto& vertex :
       testing::knownVertices(folder / "lh.thickness_at_known_vertices.csv.gz")) {
    const auto nearest = tree.closestPoint(vertex.place);
    double sum = 0;
    for (int c = 0; c < 3; ++c) {
      sum += made.nearestThickness[made.white.mesh.faces(nearest.face, c)];
    }
    if (sum > 0) nearestWays.add(vertex, sum / 3);
  }
  std::printf("by FreeSurfer's definition r %.3f, difference %.3f mm, SD %.3f, regions r %.3f\n",
              nearestWays.vertexCorrelation(), nearestWays.difference(),
              nearestWays.deviations().first,
              nearestWays.regions(folder / "stats/lh.aparc.stats").correlation);
  std::printf(
      "%zu points: %.3f mm from the white surface, 95 %% within %.3f mm; thickness at %zu r %.3f, "
      "difference %.3f mm, SD %.3f (FreeSurfer's %.3f); %zu regions r %.3f\n",
      found.points, found.distance, found.distance95, found.withThickness, found.correlation,
      found.difference, found.deviation, found.theirDeviation, found.regionCount, found.regions);
  return found;
}

void expectEven(const CorticalSurfaces& made) {
  for (const TriangleMesh* mesh : {&made.white.mesh, &made.mid, &made.pial}) {
    const Evenness even = evennessOf(*mesh);
    EXPECT_LE(even.dihedralAbove60, mesh == &made.pial ? 0.04 : 0.025);
    EXPECT_LE(even.longestEdge, 4);
    EXPECT_GE(even.leastFace, 0.02);
    EXPECT_LE(even.highestSpike, 1.5);
    EXPECT_TRUE(geometry::findSelfIntersections(*mesh).empty());
    EXPECT_EQ(geometry::inspectMesh(*mesh).eulerCharacteristic, 2);
  }
  printEvenness("white", made.white.mesh);
  printEvenness("mid", made.mid);
  printEvenness("pial", made.pial);
  printThickness(made);
}

/// Of the voxels labelled as left cortex, the share whose centres lie between white and pial
/// surface.
double shareBetween(const std::filesystem::path& folder, const CorticalSurfaces& made) {
  constexpr Label kLeftCortex = 3;
  const Volume<Label> labels = io::readLabels(folder / "mri/ribbon.mgz").volume;
  const GridCrossings white(made.white.mesh, labels.grid), pial(made.pial, labels.grid);
  double cortex = 0, between = 0;
  for (std::size_t v = 0; v < labels.size(); ++v) {
    if (labels[v] != kLeftCortex) continue;
    const auto voxel = labels.grid.subscripts(v);
    ++cortex;
    between += pial.inside(voxel) && !white.inside(voxel);
  }
  std::printf("between the surfaces lies %.3f of the labelled cortex\n", between / cortex);
  return between / cortex;
}

CorticalTissue leftOf(const std::filesystem::path& folder) {
  TissueOptions tissue;
  tissue.hemisphere = Side::Left;
  return tissueFromLabels(io::readLabels(folder / "mri/ribbon.mgz").volume, tissue);
}

/// Every second slice along k.
Volume<Label> thickSlices(const Volume<Label>& labels) {
  Grid grid = labels.grid;
  grid.size[2] /= 2;
  grid.spacing[2] *= 2;
  Volume<Label> thick(grid);
  for (int k = 0; k < grid.size[2]; ++k) {
    for (int j = 0; j < grid.size[1]; ++j) {
      for (int i = 0; i < grid.size[0]; ++i) thick(i, j, k) = labels(i, j, 2 * k);
    }
  }
  return thick;
}

TEST(RealCortex, HasOneThicknessInVoxelsAndAtVertices) {
  const std::filesystem::path data(EXPLICA_REAL_DATA);
  if (!std::filesystem::exists(data / "bert_freesurfer")) GTEST_SKIP() << "skipped: no real data";
  const auto bert = io::readLabels(data / "bert_freesurfer/mri/ribbon.mgz").volume;
  const auto person = [&](const char* number) {
    return io::readLabels(data / "synthseg_people" /
                          ("training_seg_" + std::string(number) + ".nii.gz"))
        .volume;
  };
  SurfaceOptions few;
  few.faces = 40000;
  const auto expectSame = [&](const char* name, const Volume<Label>& labels, TissueOptions tissue) {
    const TissueMasks masks = masksFromLabels(labels, tissue);
    const auto both = compare(
        name, masks,
        isBlock(masks) ? buildSheets(masks, few) : buildSurfaces(tissueFromMasks(masks), few));
    EXPECT_GT(both.share, 0.99) << name;
    EXPECT_GE(both.r, 0.98) << name;
    EXPECT_LE(std::abs(both.mean), 0.01) << name;
    EXPECT_LE(both.absolute, 0.05) << name;
    EXPECT_NEAR(both.meanOfVoxels, both.meanOfVertices, 0.02) << name;
  };
  TissueOptions left;
  left.hemisphere = Side::Left;
  expectSame("bert, left", bert, left);
  expectSame("bert, left, slices of 2 mm", thickSlices(bert), left);
  expectSame("person 03, left", person("03"), left);
  expectSame("block", io::readLabels(data / "laynii_sc/sc_rim.nii.gz").volume, {});
}

TEST(RealCortex, LiesWhereFreeSurferPutsItAndIsAsThick) {
  const std::filesystem::path folder = std::filesystem::path(EXPLICA_REAL_DATA) / "bert_freesurfer";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "skipped: no real data";
  const auto made = buildSurfaces(leftOf(folder));
  const Agreement found = agreementWith(folder, made);
  EXPECT_GT(found.points, 40000U);
  EXPECT_LE(found.distance, 0.15);
  EXPECT_LE(found.distance95, 0.41);
  EXPECT_GT(found.withThickness, 0.99 * static_cast<double>(found.points));
  EXPECT_GE(found.correlation, 0.93);
  EXPECT_LE(found.difference, 0.21);
  EXPECT_GE(found.regionCount, 10U);
  EXPECT_GE(found.regions, 0.988);
  EXPECT_LE(found.deviation, 1.03 * found.theirDeviation);
  EXPECT_LE(made.heldBackPial, made.pial.vertexCount() / 200);
  EXPECT_GE(shareBetween(folder, made), 0.94);
  expectEven(made);
}

TEST(RealCortex, IsNearerToFreeSurfersWhereTheImagePlacesIt) {
  const std::filesystem::path folder = std::filesystem::path(EXPLICA_REAL_DATA) / "bert_freesurfer";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "skipped: no real data";
  const auto made = buildSurfaces(leftOf(folder), io::readScalars(folder / "mri/brain.mgz").volume);
  const Agreement found = agreementWith(folder, made);
  std::printf("without an edge: %ld white, %ld outer; moved %.3f and %.3f mm\n",
              static_cast<long>(made.image.missingWhite),
              static_cast<long>(made.image.missingOuter), made.image.movedWhite,
              made.image.movedOuter);
  EXPECT_LE(found.distance, 0.125);
  EXPECT_GE(found.correlation, 0.925);
  EXPECT_LE(found.difference, 0.22);
  EXPECT_GE(found.regions, 0.99);
  expectEven(made);
}

}  // namespace
}  // namespace explica::surface
