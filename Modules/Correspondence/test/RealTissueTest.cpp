// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Correspondence/Correspondence.h"
#include "Explica/Correspondence/Layers.h"
#include "Explica/Correspondence/Measurement.h"
#include "Explica/Correspondence/Sulci.h"
#include "Explica/Harmonic/Phantoms.h"
#include "Explica/IO/VolumeFile.h"
#include "Explica/Testing/FreeSurferSubject.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <filesystem>

using namespace explica;
using namespace explica::correspondence;
using namespace explica::testing;

namespace {

const std::filesystem::path kData = EXPLICA_REAL_DATA;

}  // namespace

TEST(LabelBoundary, HoldsAtTheSizesOfTheTables) {
  for (const auto kind : {harmonic::PhantomKind::Shell, harmonic::PhantomKind::Spheroid}) {
    for (const harmonic::PhantomOptions& size :
         {harmonic::PhantomOptions{128, 1}, harmonic::PhantomOptions{256, 0.5}}) {
      const auto phantom = harmonic::makePhantom(kind, size);
      const auto annulus = harmonic::annulusFromLabels(phantom.labels, {{1}, {2}, {}, {}});
      const auto found = findCorrespondences(annulus, harmonic::solveInterpolant(annulus));
      double mean = 0, worst = 0;
      for (std::int32_t n = 0; n < static_cast<std::int32_t>(annulus.count()); ++n) {
        const double error =
            std::abs(found.thickness(n) - phantom.exact.answer(annulus.world(n)).thickness()) /
            size.spacing;
        mean += error / static_cast<double>(annulus.count());
        worst = std::max(worst, error);
      }
      std::printf("%d at %g mm: mean %.4f greatest %.4f voxel\n", static_cast<int>(kind),
                  size.spacing, mean, worst);
      EXPECT_EQ(found.missing, 0U);
      EXPECT_LE(mean, 0.06);
      EXPECT_LE(worst, 0.5);
    }
  }
}

TEST(RealTissue, CortexIsAsThickAsFreeSurferSays) {
  const auto folder = kData / "bert_freesurfer";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "skipped: no real data";
  const auto labels = io::readLabels(folder / "mri/ribbon.mgz").volume;
  struct Hemisphere {
    const char* name;
    Label white, grey;
  };
  constexpr std::size_t kMostMissing = 60;
  for (const auto& [name, white, grey] : {Hemisphere{"lh", 2, 3}, Hemisphere{"rh", 41, 42}}) {
    const auto annulus =
        recoverSulci(harmonic::annulusFromLabels(labels, {{white}, {grey}, {}, {}})).annulus;
    const auto found = findCorrespondences(annulus, harmonic::solveInterpolant(annulus));
    Volume<float> thickness = volumeOf(harmonic::spread(annulus, thicknessOf(found)));
    ThicknessComparison comparison;
    const auto vertices =
        knownVertices(folder / (std::string(name) + ".thickness_at_known_vertices.csv.gz"));
    EXPECT_GT(vertices.size(), 40000U);
    for (const KnownVertex& v : vertices) {
      // The nearest tissue voxel, at most two voxels away.
      const std::array<int, 3> at = {static_cast<int>(std::lround(v.index[0])),
                                     static_cast<int>(std::lround(v.index[1])),
                                     static_cast<int>(std::lround(v.index[2]))};
      double nearest = 4, value = 0;
      for (int k = at[2] - 2; k <= at[2] + 2; ++k) {
        for (int j = at[1] - 2; j <= at[1] + 2; ++j) {
          for (int i = at[0] - 2; i <= at[0] + 2; ++i) {
            if (!thickness.grid.contains(i, j, k) || thickness(i, j, k) <= 0) continue;
            const double squared = (Vector(i, j, k) - v.index).squaredNorm();
            if (squared >= nearest) continue;
            nearest = squared;
            value = thickness(i, j, k);
          }
        }
      }
      if (value == 0) continue;
      comparison.add(v, value);
    }
    const auto regions =
        comparison.regions(folder / "stats" / (std::string(name) + ".aparc.stats"));
    std::printf(
        "%s: %zu vertices, r %.3f, difference %.3f mm, %zu regions r %.3f, %zu voxels without "
        "thickness\n",
        name, comparison.vertices(), comparison.vertexCorrelation(), comparison.difference(),
        regions.count, regions.correlation, found.missing);
    EXPECT_GT(comparison.vertices(), 0.999 * static_cast<double>(vertices.size()));
    EXPECT_GE(comparison.vertexCorrelation(), 0.80);
    EXPECT_LE(comparison.difference(), 0.33);
    // What is left is grey matter joined to the rest by a neck, where u is 1 in all its digits.
    EXPECT_LE(found.missing, kMostMissing);
    EXPECT_GE(regions.count, 10U);
    EXPECT_GE(regions.correlation, 0.9);
  }
}

/// How much a value changes across a voxel: the sum of its central differences, NaN at the edge.
double acrossVoxel(const Volume<float>& values, std::size_t voxel) {
  const auto at = values.grid.subscripts(voxel);
  const auto& n = values.grid.size;
  const std::array<std::size_t, 3> strides = {1, static_cast<std::size_t>(n[0]),
                                              static_cast<std::size_t>(n[0]) * n[1]};
  double sum = 0;
  for (int a = 0; a < 3; ++a) {
    if (at[a] == 0 || at[a] == n[a] - 1) return kNaN;
    sum += 0.5 * std::abs(values[voxel + strides[a]] - values[voxel - strides[a]]);
  }
  return sum;
}

/// How values spread.
struct Spread {
  double count = 0, sum = 0, squares = 0;
  void add(double value) {
    ++count;
    sum += value;
    squares += value * value;
  }
  [[nodiscard]] double mean() const { return sum / count; }
  [[nodiscard]] double deviation() const { return std::sqrt(squares / count - mean() * mean()); }
};

/// Depths of the voxels that a layer of voxels at half depth is made of: of any two neighbours (by
/// a face, an edge or a corner) on either side of it the nearer one.  Unknown depths are NaN.
Spread midGreyOf(const Volume<float>& depth) {
  const Grid& grid = depth.grid;
  const auto isNearer = [&](const std::array<int, 3>& s, float off) {
    for (int n = 0; n < 27; ++n) {
      const std::array<int, 3> t = {s[0] + n % 3 - 1, s[1] + n / 3 % 3 - 1, s[2] + n / 9 - 1};
      if (!grid.contains(t[0], t[1], t[2])) continue;
      const float other = depth(t[0], t[1], t[2]) - 0.5F;
      if (off * other < 0 && std::abs(off) <= std::abs(other)) return true;
    }
    return false;
  };
  Spread spread;
  for (std::size_t v = 0; v < depth.size(); ++v) {
    if (depth[v] > 0 && isNearer(grid.subscripts(v), depth[v] - 0.5F)) spread.add(depth[v]);
  }
  return spread;
}

/// LayNii's voxels at half depth, which are voxels that a surface cuts: they lie as far off it as a
/// voxel reaches, as those do that are picked from our own depth by the same rule.
void expectMidGreyAtHalfDepth(const std::filesystem::path& folder, const Volume<float>& depth,
                              const Volume<float>& layers) {
  const auto midGrey = io::readScalars(folder / "sc_midGM.nii.gz").volume;
  Spread ours, theirs;
  double reach = 0, reaching = 0;
  for (std::size_t v = 0; v < depth.size(); ++v) {
    if (midGrey[v] <= 0 || !(depth[v] > 0)) continue;
    ours.add(depth[v]);
    theirs.add((layers[v] - 0.5) / 20);
    const double across = acrossVoxel(depth, v);
    if (std::isnan(across)) continue;
    reach += across * across / 12;
    ++reaching;
  }
  const double own = midGreyOf(depth).deviation();
  std::printf(
      "LayNii's %.0f mid-grey voxels: depth %.3f +- %.3f, by its own layers %.3f +- %.3f, a "
      "voxel's reach alone +- %.3f, mid-grey voxels of our own depth +- %.3f\n",
      ours.count, ours.mean(), ours.deviation(), theirs.mean(), theirs.deviation(),
      std::sqrt(reach / reaching), own);
  EXPECT_NEAR(ours.mean(), 0.5, 0.02);
  EXPECT_LE(ours.deviation(), 0.07);
  EXPECT_LE(ours.deviation(), 1.3 * std::sqrt(reach / reaching));
  EXPECT_LE(ours.deviation(), 1.1 * own);
}

/// NaN where no depth is known.
Volume<float> depthEverywhere(const harmonic::Annulus& annulus,
                              const harmonic::Interpolant& interpolant) {
  Volume<float> depth =
      volumeOf(harmonic::spread(annulus, depthOf(findCorrespondences(annulus, interpolant))));
  std::replace_if(
      depth.data.begin(), depth.data.end(), [](float d) { return !(d > 0); },
      static_cast<float>(kNaN));
  return depth;
}

TEST(RealTissue, OpenSlabOfCortexHasDepthNearTheEquidistantLayers) {
  const auto folder = kData / "laynii_sc";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "skipped: no real data";
  const auto rim = io::readLabels(folder / "sc_rim.nii.gz").volume;
  const auto equidistant = io::readScalars(folder / "sc_layers.nii.gz").volume;
  const auto annulus = harmonic::annulusFromLabels(rim, {{2}, {3}, {1}, {0}});
  const auto interpolant = harmonic::solveInterpolant(annulus);
  EXPECT_EQ(interpolant.termination, Termination::Converged);
  const Volume<float> depth = depthEverywhere(annulus, interpolant);
  std::vector<double> ours, theirs;
  for (std::size_t v = 0; v < depth.size(); ++v) {
    if (!(depth[v] > 0) || equidistant[v] <= 0) continue;
    ours.push_back(depth[v]);
    theirs.push_back(equidistant[v]);
  }
  EXPECT_GT(ours.size(), 700000U);
  EXPECT_GE(correlation(ours, theirs), 0.9);
  expectMidGreyAtHalfDepth(folder, depth, equidistant);
  const auto parted = recoverSulci(annulus).annulus;
  expectMidGreyAtHalfDepth(folder, depthEverywhere(parted, harmonic::solveInterpolant(parted)),
                           equidistant);
}

TEST(RealTissue, ABlockIsMeasuredUpToItsEdge) {
  const auto folder = kData / "laynii_sc";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "skipped: no real data";
  const Measurement m = measure(harmonic::annulusFromLabels(
      io::readLabels(folder / "sc_rim.nii.gz").volume, {{2}, {3}, {1}, {}}));
  const auto theirs = io::readScalars(folder / "sc_layers.nii.gz").volume;
  std::vector<double> depth, layers;
  for (std::int32_t n = 0; n < static_cast<std::int32_t>(m.annulus.count()); ++n) {
    if (std::isnan(m.depth[n]) || theirs[m.annulus.linear(n)] <= 0) continue;
    EXPECT_GT(m.layers[n], 0);
    depth.push_back(m.depth[n]);
    layers.push_back(theirs[m.annulus.linear(n)]);
  }
  const auto share = [&](std::size_t voxels) {
    return static_cast<double>(voxels) / static_cast<double>(m.annulus.count());
  };
  const double r = correlation(depth, layers);
  std::printf(
      "block: depth of %.2f %% of the voxels, r %.4f with LayNii's layers, near the edge "
      "%.2f %%, lost %.3f %%, ends %d, holes %d\n",
      100 * share(depth.size()), r, 100 * share(m.cutVoxels), 100 * share(m.lost), m.annulus.ends,
      m.annulus.holes);
  EXPECT_GT(share(depth.size()), 0.97);
  EXPECT_LT(share(m.lost), 0.02);
  EXPECT_GT(share(m.cutVoxels), 0.9);
  EXPECT_GE(r, 0.98);
}

/// Voxels of a hexahedron, by six tetrahedra.
double voxelsIn(const AnatomicalGrid& grid, Eigen::Index cell, double voxel) {
  constexpr int kTetrahedra[6][4] = {{0, 1, 2, 6}, {0, 2, 3, 6}, {0, 3, 7, 6},
                                     {0, 7, 4, 6}, {0, 4, 5, 6}, {0, 5, 1, 6}};
  const auto at = [&](int c) -> Vector { return grid.points.row(grid.cells(cell, c)).transpose(); };
  double sum = 0;
  for (const auto& t : kTetrahedra) {
    const Vector a = at(t[0]);
    sum += (at(t[1]) - a).cross(at(t[2]) - a).dot(at(t[3]) - a) / 6;
  }
  return sum / voxel;
}

TEST(RealTissue, TheGridSaysHowMuchOfAVentriclesWallItCovers) {
  const auto folder = kData / "lv_sunnybrook_SCD0000101";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "skipped: no real data";
  const auto labels = io::readLabels(folder / "ED_label.nii.gz").volume;
  const auto gridOf = [&](const harmonic::AnnulusOptions& annulus) {
    MeasurementOptions options;
    options.annulus = annulus;
    options.grid = 4;
    return measure(harmonic::annulusFromLabels(labels, {{1}, {2}, {}, {}}, annulus), options);
  };
  const Vector& h = labels.grid.spacing;
  const Measurement slices = gridOf({.perSlice = true});
  EXPECT_NEAR(slices.grid->volume / (static_cast<double>(slices.annulus.count()) * h[0] * h[1]), 1,
              0.002);
  // Slices of 10 mm make terraces of a slanting wall, whose corners no trajectory enters.
  const Measurement space = gridOf({.openEnds = true});
  const auto tissue = static_cast<double>(space.annulus.count());
  double voxels = 0;
  for (Eigen::Index c = 0; c < space.grid->cells.rows(); ++c) {
    voxels += voxelsIn(*space.grid, c, h.prod());
  }
  std::printf("grid over tissue: %.4f in space\n", space.grid->volume / h.prod() / tissue);
  EXPECT_NEAR(space.grid->volume / h.prod(), voxels, 0.005 * tissue);
  EXPECT_GT(voxels / tissue, 0.94);
  EXPECT_EQ(space.grid->lost, 0U);
}

TEST(RealTissue, ShortAxisStackIsMeasuredThoughItsBasalRingIsOpen) {
  const auto folder = kData / "lv_sunnybrook_SCD0000101";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "skipped: no real data";
  const auto labels = io::readLabels(folder / "ED_label.nii.gz").volume;
  std::vector<std::string> warnings;
  Monitor monitor;
  monitor.onWarning = [&](const std::string& text) { warnings.push_back(text); };
  harmonic::AnnulusOptions options;
  options.perSlice = true;
  const auto annulus = harmonic::annulusFromLabels(labels, {{1}, {2}, {}, {}}, options, monitor);
  ASSERT_FALSE(warnings.empty());
  EXPECT_NE(warnings[0].find("open in slice 0"), std::string::npos) << warnings[0];
  const auto found = findCorrespondences(annulus, harmonic::solveInterpolant(annulus));
  // Area-equivalent wall of slices 1 to 8, from the expert's contours.
  const double wall[] = {0, 8.39, 7.55, 7.84, 6.55, 6.52, 6.11, 5.22, 4.35};
  std::map<int, std::pair<double, int>> bySlice;
  for (std::int32_t n = 0; n < static_cast<std::int32_t>(annulus.count()); ++n) {
    if (std::isnan(found.thickness(n))) continue;
    auto& [sum, count] = bySlice[static_cast<int>(annulus.index(n)[2])];
    sum += found.thickness(n);
    ++count;
  }
  for (int k = 1; k < 9; ++k) {
    EXPECT_NEAR(bySlice[k].first / bySlice[k].second, wall[k], 0.15 * wall[k]) << "slice " << k;
  }
}
