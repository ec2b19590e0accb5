// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Correspondence/Correspondence.h"
#include "Explica/Correspondence/Layers.h"
#include "Explica/Correspondence/Sulci.h"
#include "Explica/Correspondence/Ventricle.h"
#include "Explica/IO/VolumeFile.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <map>

using namespace explica;
using namespace explica::correspondence;

namespace {

const std::filesystem::path kData = EXPLICA_REAL_DATA;

double correlation(const std::vector<double>& a, const std::vector<double>& b) {
  double sa = 0, sb = 0, saa = 0, sbb = 0, sab = 0;
  const auto n = static_cast<double>(a.size());
  for (std::size_t k = 0; k < a.size(); ++k) {
    sa += a[k];
    sb += b[k];
    saa += a[k] * a[k];
    sbb += b[k] * b[k];
    sab += a[k] * b[k];
  }
  return (n * sab - sa * sb) / std::sqrt((n * saa - sa * sa) * (n * sbb - sb * sb));
}

}  // namespace

TEST(RealTissue, OpenSlabOfCortexHasDepthNearTheEquidistantLayers) {
  const auto folder = kData / "laynii_sc";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "skipped: no real data";
  const auto rim = io::readLabels(folder / "sc_rim.nii.gz").volume;
  const auto equidistant = io::readScalars(folder / "sc_layers.nii.gz").volume;
  const auto annulus = harmonic::annulusFromLabels(rim, {{2}, {3}, {1}, {0}});
  const auto interpolant = harmonic::solveInterpolant(annulus);
  EXPECT_EQ(interpolant.termination, Termination::Converged);
  const auto depth = depthOf(findCorrespondences(annulus, interpolant));
  std::vector<double> ours, theirs;
  for (std::int32_t n = 0; n < static_cast<std::int32_t>(annulus.count()); ++n) {
    const double layer = equidistant[annulus.linear(n)];
    if (std::isnan(depth[n]) || layer <= 0) continue;
    ours.push_back(depth[n]);
    theirs.push_back(layer);
  }
  EXPECT_GT(ours.size(), 700000U);
  EXPECT_GE(correlation(ours, theirs), 0.9);
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
