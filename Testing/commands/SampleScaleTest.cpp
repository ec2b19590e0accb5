// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
// explica sample beside Workbench, on real images of full size.

#include "Explica/IO/SurfaceFile.h"
#include "Explica/IO/VertexDataFile.h"
#include "Explica/IO/VolumeFile.h"
#include "Explica/Testing/Command.h"
#include "Explica/Testing/FreeSurferSubject.h"

#include <gtest/gtest.h>

#include <cmath>
#include <sstream>

namespace explica::testing {
namespace {

namespace fs = std::filesystem;

using Words = std::vector<std::string>;

/// For a machine that has other work, too.
CommandSetting patience() {
  CommandSetting patient;
  patient.timeout = 500;
  return patient;
}

void run(const Words& words) {
  const CommandResult result = runProgram(words, patience());
  EXPECT_EQ(result.exitCode, 0) << result;
}

void runExplica(const Words& words) {
  const CommandResult result = explica(words, patience());
  EXPECT_EQ(result.exitCode, 0) << result;
}

/// Ours beside Workbench's mapping of the same volume on the same surface.
struct Beside {
  double worst = 0;        ///< difference over the range, where both know the value
  double correlation = 0;  ///< with the ribbon mapping, ours the mean of depths
  double ribbon = 0;       ///< with the ribbon mapping, ours over the same volumes
};

class BesideWorkbench : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!fs::exists(EXPLICA_REAL_DATA)) GTEST_SKIP() << "skipped: no real data";
  }

  /// Volume and surfaces must lie in one space.
  Beside compare(const std::string& volume, const TriangleMesh& white, const TriangleMesh& pial) {
    const std::string w = folder_ / "w.surf.gii", p = folder_ / "p.surf.gii",
                      m = folder_ / "m.surf.gii";
    TriangleMesh mid = white;
    mid.positions = 0.5 * (white.positions + pial.positions);
    io::writeSurface(w, white);
    io::writeSurface(p, pial);
    io::writeSurface(m, mid);
    const std::string nifti = folder_ / "volume.nii.gz";
    run({"/usr/bin/python3", "-c",
         "import nibabel,sys\ni=nibabel.load(sys.argv[1])\n"
         "nibabel.save(nibabel.Nifti1Image(i.get_fdata().astype('f4'),i.affine),sys.argv[2])",
         volume, nifti});
    run({"wb_command", "-volume-to-surface-mapping", nifti, m, folder_ / "wb.shape.gii",
         "-trilinear"});
    run({"wb_command", "-volume-to-surface-mapping", nifti, m, folder_ / "ribbon.shape.gii",
         "-ribbon-constrained", w, p});
    runExplica({"sample", nifti, "--white", w, "--pial", p, "--out", folder_ / "one"});
    runExplica({"sample", nifti, "--white", w, "--pial", p, "--depths", "0.1,0.3,0.5,0.7,0.9",
                "--across", "mean", "--out", folder_ / "mean"});
    runExplica({"sample", nifti, "--white", w, "--pial", p, "--across", "ribbon", "--out",
                folder_ / "over"});
    const auto map = [&](const std::string& file) {
      return io::readVertexMaps(folder_ / file, white.vertexCount())[0].values;
    };
    const Eigen::VectorXd wb = map("wb.shape.gii"), ribbon = map("ribbon.shape.gii"),
                          one = map("one/volume.func.gii"), mean = map("mean/volume.func.gii"),
                          over = map("over/volume.func.gii");
    Beside beside;
    const double range = wb.maxCoeff() - wb.minCoeff();
    std::vector<double> a, b, c;
    for (Eigen::Index v = 0; v < wb.size(); ++v) {
      if (!std::isnan(one[v]))
        beside.worst = std::max(beside.worst, std::abs(one[v] - wb[v]) / range);
      // Workbench writes 0 where it finds no voxel in the ribbon about a vertex.
      if (std::isnan(mean[v]) || ribbon[v] == 0) continue;
      a.push_back(mean[v]);
      b.push_back(ribbon[v]);
      c.push_back(over[v]);
    }
    beside.correlation = correlation(a, b);
    beside.ribbon = correlation(c, b);
    RecordProperty("worst_share_of_range_e6", std::to_string(1e6 * beside.worst));
    RecordProperty("r_ribbon_mean_of_depths", std::to_string(beside.correlation));
    RecordProperty("r_ribbon", std::to_string(beside.ribbon));
    return beside;
  }
  TemporaryFolder folder_;
};

TEST_F(BesideWorkbench, EchoPlanarImageOfS1) {
  const fs::path data = fs::path(EXPLICA_REAL_DATA) / "s1_pycortex_lh";
  const fs::path volume = data / "transforms/fullhead_reference.nii.gz";
  // Workbench knows no transform: the surfaces are moved into the volume's world.
  const auto json = readJson(data / "transforms/fullhead_matrices.xfm");
  Eigen::Matrix4d coord;
  for (int i = 0; i < 16; ++i) coord(i / 4, i % 4) = json["coord"][i / 4][i % 4];
  const Eigen::Matrix4d matrix = io::readGrid(volume).affine() * coord;
  const auto moved = [&](const char* name) {
    TriangleMesh mesh = io::readSurface(data / name).mesh;
    mesh.positions = ((mesh.positions * matrix.topLeftCorner<3, 3>().transpose()).rowwise() +
                      matrix.topRightCorner<3, 1>().transpose())
                         .eval();
    return mesh;
  };
  const TriangleMesh white = moved("wm_lh.gii"), pial = moved("pia_lh.gii");
  const Beside beside = compare(volume, white, pial);
  EXPECT_LT(beside.worst, 1e-4);
  EXPECT_GT(beside.correlation, 0.99);
  EXPECT_GT(beside.ribbon, 0.99);

  // The same through pycortex's own file.
  runExplica({"sample", volume, "--white", data / "wm_lh.gii", "--pial", data / "pia_lh.gii",
              "--to-volume", data / "transforms/fullhead_matrices.xfm", "--out", folder_ / "x"});
  const Eigen::VectorXd a = io::readVertexMaps(folder_ / "x/fullhead_reference.func.gii")[0].values,
                        b = io::readVertexMaps(folder_ / "one/volume.func.gii")[0].values;
  EXPECT_LT((a - b).cwiseAbs().maxCoeff(), 1e-4 * (b.maxCoeff() - b.minCoeff()));
}

TEST_F(BesideWorkbench, OccipitalSlabOfS1IsKnownWhereItLies) {
  const fs::path data = fs::path(EXPLICA_REAL_DATA) / "s1_pycortex_lh";
  const CommandResult result =
      explica({"sample", data / "transforms/retinotopy_reference.nii.gz", "--white",
               data / "wm_lh.gii", "--pial", data / "pia_lh.gii", "--to-volume",
               data / "transforms/retinotopy_matrices.xfm", "--out", folder_ / "out"});
  ASSERT_EQ(result.exitCode, 0) << result;
  const double known =
      readJson(folder_ / "out/summary.json")["known_fraction_retinotopy_reference"];
  EXPECT_GT(known, 0.1);
  EXPECT_LT(known, 0.5);
  const Eigen::VectorXd map =
      io::readVertexMaps(folder_ / "out/retinotopy_reference.func.gii")[0].values;
  EXPECT_NEAR(static_cast<double>(map.array().isNaN().count()) / static_cast<double>(map.size()),
              1 - known, 1e-9);
}

TEST_F(BesideWorkbench, BrainOfBert) {
  const fs::path data = fs::path(EXPLICA_REAL_DATA) / "bert_freesurfer/mri";
  runExplica({"surface", data / "ribbon.mgz", "--preset", "ribbon", "--hemisphere", "L", "--faces",
              "60000", "--out", folder_ / "surface"});
  const Beside beside =
      compare(data / "brain.mgz", io::readSurface(folder_ / "surface/white.surf.gii").mesh,
              io::readSurface(folder_ / "surface/pial.surf.gii").mesh);
  EXPECT_LT(beside.worst, 1e-4);
  // The ribbon mapping averages over all faces about a vertex, whose edges are 1.7 mm long here,
  // across the borders of a sharp image; columns of points do not.
  EXPECT_GT(beside.correlation, 0.94);
  EXPECT_GT(beside.ribbon, 0.99);
}

/// A slab of motor cortex, of which LayNii's own depths are the maps: their profiles over our
/// layers and over LayNii's of the same tissue.
TEST(BesideLayNii, ProfilesOfASlab) {
  const fs::path data = fs::path(EXPLICA_REAL_DATA) / "laynii_sc";
  if (!fs::exists(data)) GTEST_SKIP() << "skipped: no real data";
  constexpr int kLayers = 20;
  TemporaryFolder folder;
  // At the open ends of the slab 2 % of the voxels reach one border only, and that is said.
  const CommandResult made =
      explica({"thickness", data / "sc_rim.nii.gz", "--inner", "2", "--tissue", "3", "--outer", "1",
               "--insulated", "0", "--sulci", "ignore", "--out", folder / "thickness"},
              patience());
  ASSERT_TRUE(made.exitCode == 0 || made.exitCode == 3) << made;
  const Volume<float> thickness = io::readScalars(folder / "thickness/thickness.nii.gz").volume;
  const Volume<Label> theirs = io::readLabels(data / "sc_layers.nii.gz").volume;
  for (const std::string name : {"sc_leakylay_1000", "sc_distlay_1000"}) {
    const fs::path map = data / (name + ".nii.gz");
    runExplica({"sample", map, "--thickness", folder / "thickness", "--depths",
                std::to_string(kLayers), "--out", folder / name});
    std::vector<double> ours, layNii;
    std::istringstream table(readText(folder / (name + "/" + name + "_layers.tsv")));
    std::string line;
    std::getline(table, line);
    while (std::getline(table, line)) {
      std::istringstream cells(line);
      std::string region, layer, depth, mean;
      cells >> region >> layer >> depth >> mean;
      ours.push_back(std::stod(mean));
    }
    const Volume<float> values = io::readScalars(map).volume;
    std::vector<double> sum(kLayers + 1), count(kLayers + 1);
    for (std::size_t v = 0; v < values.size(); ++v) {
      if (!(thickness[v] > 0) || theirs[v] < 1 || theirs[v] > kLayers) continue;
      sum[theirs[v]] += values[v];
      count[theirs[v]] += 1;
    }
    for (int n = 1; n <= kLayers; ++n) layNii.push_back(sum[n] / count[n]);
    ASSERT_EQ(ours.size(), layNii.size());
    const double r = correlation(ours, layNii);
    RecordProperty("r_" + name, std::to_string(r));
    EXPECT_GT(r, 0.95) << name;
  }
}

}  // namespace
}  // namespace explica::testing
