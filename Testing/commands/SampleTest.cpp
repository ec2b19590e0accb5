// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
// explica sample: what users type and what they get; LayNii as a witness.

#include "Explica/Geometry/Fixtures.h"
#include "Explica/IO/SurfaceFile.h"
#include "Explica/IO/TransformFile.h"
#include "Explica/IO/VertexDataFile.h"
#include "Explica/IO/VolumeFile.h"
#include "Explica/Testing/Command.h"
#include "Explica/Testing/FreeSurferLabel.h"
#include "Explica/Testing/FreeSurferSubject.h"
#include "Explica/Testing/Grids.h"

#include <gtest/gtest.h>

#include <cmath>
#include <sstream>

namespace explica::testing {
namespace {

namespace fs = std::filesystem;

using Words = std::vector<std::string>;
using Row = std::map<std::string, std::string>;

std::vector<Row> readTable(const fs::path& path) {
  std::istringstream text(readText(path));
  std::vector<Row> rows;
  Words names;
  for (std::string line; std::getline(text, line);) {
    std::istringstream cells(line);
    Row row;
    std::size_t n = 0;
    for (std::string cell; std::getline(cells, cell, '\t'); ++n) {
      if (rows.empty() && names.size() <= n) {
        names.push_back(cell);
      } else {
        row[names.at(n)] = cell;
      }
    }
    if (!row.empty()) rows.push_back(row);
  }
  return rows;
}

Grid gridAbout0() {
  Grid grid;
  grid.size = {40, 44, 36};
  grid.spacing = {1.2, 1.0, 1.3};
  grid.direction.col(0) *= -1;  // as FreeSurfer and most scanners have it
  grid.origin = -grid.direction * grid.spacing.cwiseProduct(Vector(19.5, 21.5, 17.5));
  return grid;
}

/// White and pial spheres of 10 and 14 mm, and volumes of coordinates.
class Sample : public ::testing::Test {
 protected:
  void SetUp() override {
    io::writeSurface(folder_ / "white.surf.gii", geometry::makeIcosphere(3, 10.0));
    io::writeSurface(folder_ / "pial.surf.gii", geometry::makeIcosphere(3, 14.0));
  }
  void writeX(const std::string& name) {
    io::writeVolume(folder_ / name, volumeOf(gridAbout0(), [](const Point& x) { return x[0]; }));
  }
  CommandResult sample(Words words) {
    words.insert(words.begin(), "sample");
    words.insert(words.end(), {"--surfaces", folder_.path().string(), "--out", folder_ / "out"});
    return explica(words);
  }
  [[nodiscard]] std::vector<io::VertexMap> maps(const std::string& name) const {
    return io::readVertexMaps(folder_ / ("out/" + name), 642);
  }
  TemporaryFolder folder_;
};

TEST_F(Sample, WritesAMapADepth) {
  writeX("x.nii.gz");
  const CommandResult result = sample({folder_ / "x.nii.gz", "--depths", "3"});
  ASSERT_EQ(result.exitCode, 0) << result;
  const auto got = maps("x.func.gii");
  ASSERT_EQ(got.size(), 3U);
  EXPECT_EQ(got[1].name, "depth 0.5");
  const double radius[] = {10, 12, 14};
  const TriangleMesh white = io::readSurface(folder_ / "white.surf.gii").mesh;
  for (int d = 0; d < 3; ++d) {
    const Eigen::VectorXd x = radius[d] / 10 * white.positions.col(0);
    EXPECT_LT((got[d].values - x).cwiseAbs().maxCoeff(), 1e-4);
  }
  const auto valid = maps("valid.shape.gii");
  ASSERT_EQ(valid.size(), 3U);
  EXPECT_EQ(valid[2].values.minCoeff(), 1);
  const auto rows = readTable(folder_ / "out/profiles.tsv");
  ASSERT_EQ(rows.size(), 3U);
  EXPECT_EQ(rows[2].at("depth"), "1");
  EXPECT_EQ(rows[2].at("n"), "642");
  EXPECT_NEAR(std::stod(rows[2].at("sd")), 14 / std::sqrt(3), 0.05);
}

TEST_F(Sample, AcceptsNaNAndWhatLiesOutside) {
  // Not a number where x < 0, as programs write it outside the brain; and no field of view above.
  Volume<float> map = volumeOf(gridAbout0(), [](const Point& x) { return x[0] < 0 ? kNaN : 3; });
  Grid low = map.grid;
  low.size[2] = 18;  // up to the middle
  Volume<float> cut(low);
  std::copy_n(map.data.begin(), cut.size(), cut.data.begin());
  io::writeVolume(folder_ / "map.nii.gz", cut);
  const CommandResult result = sample({folder_ / "map.nii.gz", "--depths", "0.5"});
  ASSERT_EQ(result.exitCode, 0) << result;
  const Eigen::VectorXd values = maps("map.func.gii")[0].values,
                        valid = maps("valid.shape.gii")[0].values;
  const TriangleMesh white = io::readSurface(folder_ / "white.surf.gii").mesh;
  int known = 0;
  for (Eigen::Index v = 0; v < 642; ++v) {
    const Point at = 1.2 * white.positions.row(v).transpose();
    EXPECT_EQ(valid[v] == 1, !std::isnan(values[v]));
    if (at[0] < -0.65 || at[2] > 0.01) {
      EXPECT_TRUE(std::isnan(values[v])) << at.transpose();
    }
    if (at[0] > 0.65 && at[2] < -0.01) {
      EXPECT_NEAR(values[v], 3, 1e-6) << at.transpose();
    }
    known += valid[v] == 1;
  }
  EXPECT_GT(known, 100);
  const auto rows = readTable(folder_ / "out/profiles.tsv");
  EXPECT_EQ(rows[0].at("mean"), "3");
  EXPECT_EQ(rows[0].at("n"), std::to_string(known));
  EXPECT_NE(result.err.find("known at"), std::string::npos) << result;  // less than half
}

TEST_F(Sample, GoesToATemplateByTheTransformThatSegmentWrites) {
  // to_template.h5: T(x) = A (x + u(x)), from the T1's space, where the surfaces lie.
  Eigen::Affine3d affine = Eigen::Affine3d::Identity();
  affine.rotate(Eigen::AngleAxisd(0.2, Vector(1, 2, -1).normalized()))
      .pretranslate(Vector(3, -2, 1));
  Volume<Eigen::Vector3f> field(gridAbout0(), Eigen::Vector3f::Zero());
  const Eigen::Vector3f slope(0.05F, -0.03F, 0.02F);
  for (std::size_t v = 0; v < field.size(); ++v) {
    const auto [i, j, k] = field.grid.subscripts(v);
    const Point at = field.grid.toWorld(Vector(i, j, k));
    field[v] = slope * static_cast<float>(at[1]) + Eigen::Vector3f(1, 0, 0);
  }
  io::writeTransform(folder_ / "to_template.h5", affine, field);
  writeX("template.nii.gz");
  const CommandResult result = sample(
      {folder_ / "template.nii.gz", "--depths", "0.5", "--to-volume", folder_ / "to_template.h5"});
  ASSERT_EQ(result.exitCode, 0) << result;
  const Eigen::VectorXd values = maps("template.func.gii")[0].values;
  const TriangleMesh white = io::readSurface(folder_ / "white.surf.gii").mesh;
  for (Eigen::Index v = 0; v < values.size(); ++v) {
    const Point at = 1.2 * white.positions.row(v).transpose();
    const Point moved = at + slope.cast<double>() * at[1] + Vector(1, 0, 0);
    EXPECT_NEAR(values[v], (affine * moved)[0], 1e-3) << at.transpose();
  }
}

TEST_F(Sample, RefusesAVolumeThatLiesElsewhere) {
  Volume<float> map(gridAbout0(), 1.0F);
  map.grid.origin += Vector(500, 0, 0);
  io::writeVolume(folder_ / "far.nii.gz", map);
  const CommandResult result = sample({folder_ / "far.nii.gz"});
  EXPECT_EQ(result.exitCode, 2);
  EXPECT_NE(result.err.find("same space"), std::string::npos) << result;
}

TEST_F(Sample, SeriesKeepFramesAndMaskAndAcross) {
  std::vector<VolumeOnDemand<float>> frames;
  const Grid grid = gridAbout0();
  for (int frame = 0; frame < 20; ++frame) {
    frames.push_back({grid, 0, 0, grid.voxelCount(),
                      [frame, grid](std::size_t first, std::size_t count, float* to) {
                        for (std::size_t v = 0; v < count; ++v) {
                          const auto [i, j, k] = grid.subscripts(first + v);
                          to[v] = static_cast<float>(frame +
                                                     0.1 * grid.toWorld(Vector(i, j, k)).norm());
                        }
                      }});
  }
  io::writeFrames(folder_ / "bold.nii.gz", frames);
  const std::string bold = folder_ / "bold.nii.gz";
  ASSERT_EQ(sample({bold, "--depths", "0,1.0"}).exitCode, 0);
  ASSERT_EQ(maps("bold_depth-1.func.gii").size(), 20U);
  const auto white = maps("bold_depth-0.func.gii");
  EXPECT_EQ(white[17].name, "frame 17");
  EXPECT_NEAR(white[17].values.mean(), 18, 0.02);
  EXPECT_EQ(readTable(folder_ / "out/profiles.tsv").size(), 40U);

  Volume<Label> mask(grid);
  for (std::size_t v = 0; v < mask.size(); ++v) mask[v] = grid.subscripts(v)[0] < 20;
  io::writeVolume(folder_ / "mask.nii.gz", mask);
  ASSERT_EQ(sample({bold, "--depths", "5", "--across", "mean", "--mask", folder_ / "mask.nii.gz",
                    "--force"})
                .exitCode,
            0);
  const auto mean = maps("bold.func.gii");
  ASSERT_EQ(mean.size(), 20U);
  const TriangleMesh mesh = io::readSurface(folder_ / "white.surf.gii").mesh;
  for (Eigen::Index v = 0; v < 642; ++v) {
    if (mesh.positions(v, 0) < -1) {
      EXPECT_TRUE(std::isnan(mean[3].values[v]));
    }
    if (mesh.positions(v, 0) > 1) {
      EXPECT_NEAR(mean[3].values[v], 4.2, 0.02);
    }
  }
  const CommandResult wrong = sample({bold, "--mask", folder_ / "other.nii.gz", "--force"});
  EXPECT_EQ(wrong.exitCode, 2) << wrong;
}

TEST_F(Sample, LabelsByMajorityWithFreeSurfersColours) {
  Volume<Label> atlas(gridAbout0());
  for (std::size_t v = 0; v < atlas.size(); ++v) {
    const auto [i, j, k] = atlas.grid.subscripts(v);
    const Point x = atlas.grid.toWorld(Vector(i, j, k));
    atlas[v] = x.norm() < 10.5 ? 2 : x[2] > 0 ? 1024 : 1022;  // white matter, pre- and postcentral
  }
  io::writeVolume(folder_ / "aparc+aseg.mgz", atlas);
  ASSERT_EQ(
      sample({"--label-volume", folder_ / "aparc+aseg.mgz", "--depths", "5", "--across", "mean"})
          .exitCode,
      0);
  const io::LabelMap labels = io::readVertexLabels(folder_ / "out/aparc+aseg.label.gii", 642);
  const TriangleMesh mesh = io::readSurface(folder_ / "white.surf.gii").mesh;
  for (Eigen::Index v = 0; v < 642; ++v) {
    if (std::abs(mesh.positions(v, 2)) < 1) continue;
    EXPECT_EQ(labels.keys[v], mesh.positions(v, 2) > 0 ? 1024 : 1022);
  }
  ASSERT_EQ(labels.table.back().name, "ctx-lh-precentral");
  EXPECT_NEAR(labels.table.back().colour[2], 220 / 255.0, 1e-6);
}

TEST_F(Sample, PointsAndRegions) {
  io::LabelMap regions{"parts", {}, {{0, "unknown", {0, 0, 0, 0}}, {1, "upper", {1, 0, 0, 1}}}};
  const TriangleMesh mesh = io::readSurface(folder_ / "white.surf.gii").mesh;
  regions.keys = (mesh.positions.col(2).array() > 0).cast<Label>();
  io::writeGiftiLabel(folder_ / "parts.label.gii", regions, "CortexLeft");
  writeText(folder_ / "electrodes.tsv", "name\tx\ty\tz\nA1\t0\t0\t13\nB2\t0\t0\t-20\n");
  writeX("x.nii.gz");
  const CommandResult result =
      sample({folder_ / "x.nii.gz", "--labels", folder_ / "parts.label.gii", "--points",
              folder_ / "electrodes.tsv"});
  ASSERT_EQ(result.exitCode, 0) << result;
  const auto points = readTable(folder_ / "out/points.tsv");
  ASSERT_EQ(points.size(), 2U);
  EXPECT_EQ(points[0].at("name"), "A1");
  EXPECT_EQ(points[0].at("region"), "upper");
  EXPECT_NEAR(std::stod(points[0].at("depth")), 0.75, 0.02);
  EXPECT_LT(std::stod(points[0].at("distance")), 1.0);
  EXPECT_EQ(points[1].at("region"), "n/a");
  EXPECT_NEAR(std::stod(points[1].at("distance")), 6, 0.1);
  const auto rows = readTable(folder_ / "out/profiles.tsv");
  ASSERT_EQ(rows.size(), 2U);
  EXPECT_EQ(rows[0].at("region"), "upper");
  EXPECT_EQ(rows[1].at("region"), "all");
  EXPECT_EQ(rows[0].at("n"), rows[1].at("n"));  // "all" are vertices with a region
  writeText(folder_ / "bad.tsv", "x\ty\n1\t2\n");
  const CommandResult bad = sample({"--points", folder_ / "bad.tsv", "--force"});
  EXPECT_EQ(bad.exitCode, 2);
  EXPECT_NE(bad.err.find("'z'"), std::string::npos) << bad;
}

TEST_F(Sample, RibbonIsTheMeanOverTheTissueAboutAVertex) {
  writeX("x.nii.gz");
  const CommandResult result = sample({folder_ / "x.nii.gz", "--across", "ribbon"});
  ASSERT_EQ(result.exitCode, 0) << result;
  const auto got = maps("x.func.gii");
  ASSERT_EQ(got.size(), 1U);
  EXPECT_EQ(got[0].name, "ribbon");
  const TriangleMesh white = io::readSurface(folder_ / "white.surf.gii").mesh;
  // Mean radius by volume of the shell from 10 to 14 mm.
  const double mean = 0.75 * (std::pow(14, 4) - 1e4) / (std::pow(14, 3) - 1e3);
  EXPECT_LT((got[0].values - mean / 10 * white.positions.col(0)).cwiseAbs().maxCoeff(),
            0.04 * mean);
  const auto rows = readTable(folder_ / "out/profiles.tsv");
  ASSERT_EQ(rows.size(), 1U);
  EXPECT_EQ(rows[0].at("depth"), "n/a");
  EXPECT_EQ(
      sample({folder_ / "x.nii.gz", "--across", "ribbon", "--depths", "5", "--force"}).exitCode, 1);
}

TEST_F(Sample, RegionsOfSeveralFilesMayOverlap) {
  const TriangleMesh mesh = io::readSurface(folder_ / "white.surf.gii").mesh;
  io::LabelMap upper{"parts", {}, {{0, "unknown", {0, 0, 0, 0}}, {1, "upper", {1, 0, 0, 1}}}};
  upper.keys = (mesh.positions.col(2).array() > 0).cast<Label>();
  io::writeGiftiLabel(folder_ / "parts.label.gii", upper, "CortexLeft");
  io::LabelMap right = upper;
  right.keys = (mesh.positions.col(0).array() > 0).cast<Label>();
  explica::test::writeFreeSurferLabel(folder_ / "lh.right.label", right, mesh.positions);
  writeX("x.nii.gz");
  const CommandResult result =
      sample({folder_ / "x.nii.gz", "--labels", folder_ / "parts.label.gii", "--labels",
              folder_ / "lh.right.label", "--depths", "3"});
  ASSERT_EQ(result.exitCode, 0) << result;
  std::map<std::string, int> count;
  for (const Row& row : readTable(folder_ / "out/profiles.tsv")) {
    count[row.at("region")] = std::stoi(row.at("n"));
  }
  ASSERT_EQ(count.size(), 3U);
  EXPECT_EQ(count["upper"], upper.keys.sum());
  EXPECT_EQ(count["lh.right"], right.keys.sum());
  EXPECT_EQ(count["all"], (upper.keys.array() + right.keys.array() > 0).count());
}

TEST_F(Sample, GoesIntoACiftiFileOfBothHemispheres) {
  writeX("x.nii.gz");
  ASSERT_EQ(sample({folder_ / "x.nii.gz", "--depths", "2"}).exitCode, 0);
  io::LabelMap cortex{"cortex", {}, {{0, "wall", {0, 0, 0, 0}}, {1, "cortex", {1, 0, 0, 1}}}};
  cortex.keys.setOnes(642);
  cortex.keys.head(42).setZero();
  io::writeGiftiLabel(folder_ / "cortex.label.gii", cortex, "CortexLeft");
  const std::string map = folder_ / "out/x.func.gii";
  const CommandResult result =
      explica({"cifti", "--left", map, "--right", map, "--left-cortex",
               folder_ / "cortex.label.gii", "--name", "x", "--out", folder_ / "cifti"});
  ASSERT_EQ(result.exitCode, 0) << result;
  const CommandResult seen =
      runProgram({"/usr/bin/python3", "-c",
                  "import nibabel,sys\ni=nibabel.load(sys.argv[1])\n"
                  "print(i.shape, i.header.get_axis(0).name, i.get_fdata()[1].max())",
                  folder_ / "cifti/x.dscalar.nii"});
  EXPECT_EQ(seen.exitCode, 0) << seen;
  EXPECT_EQ(seen.out.substr(0, 9), "(2, 1242)") << seen;
  EXPECT_NE(seen.out.find("depth 1"), std::string::npos) << seen;
  const CommandResult none = explica({"cifti", "--out", folder_ / "none"});
  EXPECT_EQ(none.exitCode, 1) << none;
}

TEST_F(Sample, SaysWhatCannotBeMeant) {
  writeX("x.nii.gz");
  const std::string x = folder_ / "x.nii.gz";
  const auto fault = [&](const Words& words, int code, const std::string& sentence) {
    const CommandResult result = explica(words);
    EXPECT_EQ(result.exitCode, code) << result;
    EXPECT_NE(result.err.find(sentence), std::string::npos) << result;
  };
  const std::string out = folder_ / "no", surfaces = folder_.path().string();
  fault({"sample", x, "--out", out}, 1, "--surfaces");
  fault({"sample", "--surfaces", surfaces, "--out", out}, 1, "nothing to sample");
  fault({"sample", x, x, "--surfaces", surfaces, "--out", out}, 1, "two volumes");
  fault({"sample", x, "--white", folder_ / "white.surf.gii", "--out", out}, 1, "belong together");
  fault({"sample", x, "--surfaces", surfaces, "--depths", "0.5,2", "--out", out}, 2, "depths: '2'");
  fault({"sample", x, "--surfaces", surfaces, "--to-volume-sense", "inverse", "--out", out}, 1,
        "--to-volume");
  fs::create_directory(folder_ / "empty");
  fault({"sample", x, "--surfaces", folder_ / "empty", "--hemisphere", "L", "--out", out}, 2,
        "*hemi-L_*white.surf.gii");
  fault({"sample", x, "--thickness", folder_ / "empty", "--out", out}, 2, "thickness.nii.gz");
}

TEST_F(Sample, FindsTheSurfacesOfOtherPrograms) {
  writeX("x.nii.gz");
  const TriangleMesh white = geometry::makeIcosphere(3, 10.0),
                     pial = geometry::makeIcosphere(3, 14.0);
  for (const char* name : {"fs/surf", "fs/mri", "prep/anat", "hcp"}) {
    fs::create_directories(folder_ / name);
  }
  const auto both = [&](const std::string& whiteName, const std::string& pialName) {
    io::writeSurface(folder_ / whiteName, white);
    io::writeSurface(folder_ / pialName, pial);
  };
  both("fs/surf/rh.white", "fs/surf/rh.pial");
  both("prep/anat/sub-01_hemi-R_white.surf.gii", "prep/anat/sub-01_hemi-R_pial.surf.gii");
  both("hcp/100307.R.white.32k_fs_LR.surf.gii", "hcp/100307.R.pial.32k_fs_LR.surf.gii");
  for (const std::string place : {"fs/surf", "prep/anat", "hcp"}) {
    const CommandResult result =
        explica({"sample", folder_ / "x.nii.gz", "--surfaces", folder_ / place, "--hemisphere", "R",
                 "--out", folder_ / "out", "--force"});
    ASSERT_EQ(result.exitCode, 0) << result;
    EXPECT_LT((maps("x.func.gii")[0].values - 1.2 * white.positions.col(0)).cwiseAbs().maxCoeff(),
              1e-4)
        << place;
  }
}

TEST(SampleLayers, OfAShellFollowDepthAndKeepTheIntegral) {
  TemporaryFolder folder;
  ASSERT_EQ(explica({"phantom", "shell", "--size", "40", "--out", folder / "shell"}).exitCode, 0);
  ASSERT_EQ(explica({"thickness", folder / "shell/labels.nii.gz", "--inner", "1", "--tissue", "2",
                     "--layers", "4", "--out", folder / "thickness"})
                .exitCode,
            0);
  const Volume<float> depth = io::readScalars(folder / "thickness/depth.nii.gz").volume,
                      thickness = io::readScalars(folder / "thickness/thickness.nii.gz").volume;
  Volume<float> map(depth.grid);
  double integral = 0;
  for (std::size_t v = 0; v < map.size(); ++v) {
    map[v] = 1 + 3 * depth[v];
    if (thickness[v] > 0) integral += map[v] * map.grid.voxelVolume();
  }
  io::writeVolume(folder / "map.nii.gz", map);
  for (const std::string layers : {"", "4", "12"}) {
    Words words = {"sample", folder / "map.nii.gz", "--thickness", folder / "thickness",
                   "--out",  folder / "out",        "--force"};
    if (!layers.empty()) words.insert(words.end(), {"--depths", layers});
    const CommandResult result = explica(words);
    ASSERT_EQ(result.exitCode, 0) << result;
    const auto rows = readTable(folder / "out/map_layers.tsv");
    ASSERT_EQ(rows.size(), layers == "12" ? 12U : 4U);
    double sum = 0;
    for (const Row& row : rows) {
      sum += std::stod(row.at("mean")) * std::stod(row.at("volume"));
      EXPECT_NEAR(std::stod(row.at("mean")), 1 + 3 * std::stod(row.at("depth")), 0.15);
    }
    EXPECT_NEAR(sum, integral, 1e-5 * integral);  // six digits a cell
  }
}

/// Profiles of real activation over LayNii's layers and over ours of the same tissue.
TEST(SampleLayers, AgreeWithLayNiisOnRealActivation) {
  const fs::path data = fs::path(EXPLICA_REAL_DATA) / "laynii_lo";
  if (!fs::exists(data)) GTEST_SKIP() << "skipped: no real data";
  TemporaryFolder folder;
  const Volume<Label> theirs = io::readLabels(data / "lo_layers.nii.gz").volume;
  // Banks of sulci touch there, so that the tissue is what lies between the first layer and the
  // last.
  Volume<Label> rim(theirs.grid);
  constexpr Label kInner = 1, kTissue = 2, kOuter = 3;
  const Label last = *std::max_element(theirs.data.begin(), theirs.data.end());
  for (std::size_t v = 0; v < rim.size(); ++v) {
    const Label layer = theirs[v];
    rim[v] = layer == 0 ? 0 : layer == 1 ? kInner : layer == last ? kOuter : kTissue;
  }
  io::writeVolume(folder / "rim.nii.gz", rim);
  const CommandResult made =
      explica({"thickness", folder / "rim.nii.gz", "--inner", "1", "--tissue", "2", "--outer", "3",
               "--insulated", "0", "--sulci", "ignore", "--out", folder / "thickness"});
  ASSERT_EQ(made.exitCode, 0) << made;
  const Volume<float> thickness = io::readScalars(folder / "thickness/thickness.nii.gz").volume;
  for (const std::string name : {"lo_VASO_act", "lo_BOLD_act"}) {
    const CommandResult result = explica({"sample", (data / (name + ".nii.gz")).string(),
                                          "--thickness", folder / "thickness", "--depths",
                                          std::to_string(last - 2), "--out", folder / name});
    ASSERT_EQ(result.exitCode, 0) << result;
    std::vector<double> ours, layNii;
    for (const Row& row : readTable(folder / (name + "/" + name + "_layers.tsv"))) {
      ours.push_back(std::stod(row.at("mean")));
    }
    const Volume<float> map = io::readScalars(data / (name + ".nii.gz")).volume;
    std::vector<double> sum(last + 1), count(last + 1);
    for (std::size_t v = 0; v < map.size(); ++v) {
      if (!(thickness[v] > 0)) continue;  // both know the layer
      sum[theirs[v]] += map[v];
      count[theirs[v]] += 1;
    }
    for (Label n = 2; n < last; ++n) layNii.push_back(sum[n] / count[n]);
    ASSERT_EQ(ours.size(), layNii.size());
    RecordProperty("r_" + name, std::to_string(correlation(ours, layNii)));
    EXPECT_GT(correlation(ours, layNii), 0.95) << name;
  }
}

}  // namespace
}  // namespace explica::testing
