// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
// Heads of full size: out of the skull, to a thickness, through a study; of a macaque.

#include "Explica/Geometry/FaceTree.h"
#include "Explica/IO/SurfaceFile.h"
#include "Explica/IO/VertexDataFile.h"
#include "Explica/IO/VolumeFile.h"
#include "Explica/Testing/Command.h"
#include "Explica/Testing/FreeSurferSubject.h"

#include <gtest/gtest.h>

#include <cstdio>
#include <set>

namespace explica::testing {
namespace {

namespace fs = std::filesystem;

const fs::path kTemplates = "/usr/share/mricron/templates";

CommandResult patiently(const std::vector<std::string>& words) {
  CommandSetting setting;
  setting.timeout = 1800;
  return explica(words, setting);
}

double numberOf(const fs::path& folder, const char* name) {
  return readJson(folder / "summary.json")[name].get<double>();
}

class WholeHead : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!fs::exists(kTemplates)) GTEST_SKIP() << "skipped: no templates of mricron-data";
  }

  /// Left surfaces of a segmentation, their borders placed by its image.
  CommandResult surface(const fs::path& image) {
    const std::string side = folder_ / "segment/left/";
    return patiently({"surface", "--inner-level", side + "white_share.nii.gz", "--outer-level",
                      side + "tissue_share.nii.gz", "--insulated-mask", side + "cut.nii.gz",
                      "--hemisphere", "L", "--faces", "60000", "--image", image.string(), "--out",
                      folder_ / "surface"});
  }

  TemporaryFolder folder_;
};

TEST_F(WholeHead, IsTakenOutOfItsSkull) {
  const auto run = patiently({"segment", kTemplates / "ch2.nii.gz", "--out", folder_ / "segment"});
  ASSERT_EQ(run.exitCode, 0) << run;
  ASSERT_EQ(explica({"report", folder_ / "segment"}).exitCode, 0);
  EXPECT_NE(readText(folder_ / "segment/report.html").find("Template on ch2.nii.gz"),
            std::string::npos);
  const auto ours = io::readLabels(folder_ / "segment/brain_mask.nii.gz").volume;
  const auto known = io::readScalars(kTemplates / "ch2bet.nii.gz").volume;
  ASSERT_EQ(ours.size(), known.size());
  double both = 0, sum = 0;
  for (std::size_t v = 0; v < ours.size(); ++v) {
    both += ours[v] != 0 && known[v] > 0;
    sum += (ours[v] != 0) + (known[v] > 0);
  }
  std::printf("Dice with ch2bet %.4f\n", 2 * both / sum);
  EXPECT_GT(2 * both / sum, 0.96);
}

TEST_F(WholeHead, Colin27IsAsThickAsOthers) {
  const fs::path image = kTemplates / "ch2bet.nii.gz";
  const auto run = patiently(
      {"segment", image, "--atlas", kTemplates / "aal.nii.gz", "--out", folder_ / "segment"});
  ASSERT_EQ(run.exitCode, 0) << run;
  const auto made = surface(image);
  ASSERT_EQ(made.exitCode, 0) << made;
  const double mean = numberOf(folder_ / "surface", "thickness_mean");
  std::printf("mean thickness %.3f mm\n", mean);
  EXPECT_GT(mean, 2.3);
  EXPECT_LT(mean, 2.9);
}

TEST_F(WholeHead, BertIsAsThickAsFreeSurferSays) {
  const fs::path bert = fs::path(EXPLICA_REAL_DATA) / "bert_freesurfer";
  if (!fs::exists(bert)) GTEST_SKIP() << "skipped: no real data";
  const fs::path image = bert / "mri/brain.mgz";
  const auto run = patiently({"segment", image, "--out", folder_ / "segment"});
  ASSERT_EQ(run.exitCode, 0) << run;
  const auto made = surface(image);
  ASSERT_EQ(made.exitCode, 0) << made;
  const auto white = io::readSurface(folder_ / "surface/white.surf.gii").mesh;
  const auto thickness = io::readVertexMaps(folder_ / "surface/thickness.shape.gii").front().values;
  const geometry::FaceTree tree(white);
  ThicknessComparison comparison;
  double distance = 0, points = 0;
  for (const auto& vertex : knownVertices(bert / "lh.thickness_at_known_vertices.csv.gz")) {
    const auto nearest = tree.closestPoint(vertex.place);
    double sum = 0;
    for (int c = 0; c < 3; ++c) sum += thickness[white.faces(nearest.face, c)];
    distance += std::sqrt(nearest.squaredDistance);
    points += 1;
    if (sum > 0) comparison.add(vertex, sum / 3);
  }
  const double mean = numberOf(folder_ / "surface", "thickness_mean");
  const auto regions = comparison.regions(bert / "stats/lh.aparc.stats");
  std::printf(
      "mean %.3f mm (FreeSurfer 2.603); known points %.3f mm from the white surface, thickness r "
      "%.3f, difference %.3f mm; %zu regions r %.3f\n",
      mean, distance / points, comparison.vertexCorrelation(), comparison.difference(),
      regions.count, regions.correlation);
  EXPECT_NEAR(mean, 2.603, 0.15);
  EXPECT_LT(distance / points, 0.31);
  EXPECT_GT(comparison.vertexCorrelation(), 0.81);
  EXPECT_LT(comparison.difference(), 0.36);
  EXPECT_GT(regions.correlation, 0.95);
}

/// Which numbers of a head were implausible.
std::set<std::string> flagsOf(const fs::path& folder) {
  std::set<std::string> names;
  const auto summary = readJson(folder / "summary.json");
  for (const auto& flag : summary["flags"]) names.insert(flag["name"].get<std::string>());
  return names;
}

TEST_F(WholeHead, HalvesOfAHeadAreFlagged) {
  const Volume<float> whole = io::readScalars(kTemplates / "ch2.nii.gz").volume;
  for (const int axis : {0, 2}) {  // the left half, the upper half
    Volume<float> half = whole;
    for (std::size_t v = 0; v < half.size(); ++v) {
      const auto [i, j, k] = half.grid.subscripts(v);
      const double at = half.grid.toWorld(Vector(i, j, k))[axis];
      if (axis == 0 ? at > 0 : at < 18) half[v] = 0;
    }
    io::writeVolume(folder_ / "half.nii.gz", half);
    const auto run =
        patiently({"segment", folder_ / "half.nii.gz", "--force", "--out", folder_ / "segment"});
    EXPECT_EQ(run.exitCode, 3) << run;
    const auto flags = flagsOf(folder_ / "segment");
    EXPECT_TRUE(flags.contains("registration")) << run;
    EXPECT_EQ(flags.contains("half-head"), axis == 0) << run;
  }
}

TEST_F(WholeHead, GoesThroughAStudyAsTheScannerGivesIt) {
  fs::create_directories(folder_ / "data/sub-01/anat");
  fs::copy_file(kTemplates / "ch2.nii.gz", folder_ / "data/sub-01/anat/sub-01_T1w.nii.gz");
  writeText(folder_ / "data/dataset_description.json", R"({"Name": "a", "BIDSVersion": "1.8.0"})");
  const auto run = patiently({"bids", folder_ / "data", folder_ / "out", "participant", "--steps",
                              "segment,surface", "--surface.faces", "20000"});
  ASSERT_EQ(run.exitCode, 0) << run;
  const fs::path anat = folder_ / "out/sub-01/anat";
  for (const char* side : {"L", "R"}) {
    const fs::path surface = anat / ("sub-01_hemi-" + std::string(side) + "_pial.surf.gii");
    EXPECT_TRUE(fs::exists(surface)) << surface;
  }
  ASSERT_EQ(explica({"bids", folder_ / "data", folder_ / "out", "group"}).exitCode, 0);
  const std::string table = readText(folder_ / "out/study.tsv");
  EXPECT_NE(table.find("sub-01\tL\tdone\t"), std::string::npos) << table;
  EXPECT_NE(table.find("sub-01\tR\tdone\t"), std::string::npos) << table;
}

}  // namespace
}  // namespace explica::testing
