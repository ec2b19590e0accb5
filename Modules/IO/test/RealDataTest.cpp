// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/IO/SurfaceFile.h"
#include "Explica/IO/VertexDataFile.h"
#include "Explica/IO/VolumeFile.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

namespace {

using namespace explica;
namespace fs = std::filesystem;

class RealData : public testing::Test {
 protected:
  void SetUp() override {
    if (!fs::exists(data_)) GTEST_SKIP() << "skipped: no real data";
  }
  fs::path data_ = EXPLICA_REAL_DATA;
};

TEST_F(RealData, RibbonOfBertHasItsVoxelsAtItsPlace) {
  const io::LoadedVolume<Label> ribbon = io::readLabels(data_ / "bert_freesurfer/mri/ribbon.mgz");
  const auto count = [&](Label label) {
    return std::count(ribbon.volume.data.begin(), ribbon.volume.data.end(), label);
  };
  EXPECT_EQ(count(2), 279239);
  EXPECT_EQ(count(41), 277971);
  EXPECT_EQ(count(3), 243809);
  EXPECT_EQ(count(42), 242147);
  // Conformed LIA axes: voxel (128, 128, 128) is at c_ras.
  EXPECT_LT((ribbon.volume.grid.toWorld(Vector::Constant(128)) - Point(5.399719, 18, 0)).norm(),
            1e-5);
  EXPECT_EQ(ribbon.volume.grid.direction.col(2), Vector(0, 1, 0));
}

TEST_F(RealData, FsaverageIsTheSameInGiftiAndFreeSurferFiles) {
  const fs::path folder = data_ / "fsaverage5";
  for (const auto& [gifti, binary] : {std::pair{"pial_left.gii.gz", "lh.pial"},
                                      {"white_right.gii.gz", "rh.white"},
                                      {"infl_left.gii.gz", "lh.inflated"}}) {
    const io::LoadedSurface a = io::readSurface(folder / gifti);
    const io::LoadedSurface b = io::readSurface(folder / "fs_binary" / binary);
    EXPECT_EQ(a.mesh.vertexCount(), 10242);
    EXPECT_EQ(a.mesh.positions, b.mesh.positions) << gifti;
    EXPECT_EQ(a.mesh.faces, b.mesh.faces) << gifti;
    EXPECT_EQ(a.metadata.structure, b.metadata.structure);
    EXPECT_EQ(b.origin.space, "not stated");  // its footer says that it knows no volume
  }
  const Eigen::VectorXd a = io::readVertexMaps(folder / "thick_left.gii.gz", 10242)[0].values;
  const Eigen::VectorXd b = io::readVertexMaps(folder / "fs_binary/lh.thickness", 10242)[0].values;
  EXPECT_EQ(a, b);
}

TEST_F(RealData, SurfacesOfS1ShareTheirFaces) {
  const fs::path folder = data_ / "s1_pycortex_lh";
  const io::LoadedSurface white = io::readSurface(folder / "wm_lh.gii");
  const io::LoadedSurface pial = io::readSurface(folder / "pia_lh.gii");
  EXPECT_EQ(white.mesh.vertexCount(), 152893);
  EXPECT_EQ(white.mesh.faceCount(), 305782);
  EXPECT_EQ(white.mesh.faces, pial.mesh.faces);
  EXPECT_NEAR((white.mesh.positions - pial.mesh.positions).rowwise().norm().mean(), 2.871, 5e-4);
}

TEST_F(RealData, AnnotationOfBertNamesItsRegions) {
  const io::LabelMap aparc =
      io::readVertexLabels(data_ / "bert_freesurfer/label/lh.aparc.annot", 134814);
  const auto named = std::find_if(aparc.table.begin(), aparc.table.end(),
                                  [](const io::LabelEntry& e) { return e.name == "insula"; });
  ASSERT_NE(named, aparc.table.end());
  EXPECT_GT((aparc.keys.array() == named->key).count(), 1000);
  const Eigen::VectorXd thickness =
      io::readVertexMaps(data_ / "bert_freesurfer/surf/lh.thickness", 134814)[0].values;
  EXPECT_EQ(thickness.maxCoeff(), 5.0);
}

TEST_F(RealData, VolumesOfOtherToolsAreRead) {
  const io::LoadedVolume<float> ventricle =
      io::readScalars(data_ / "lv_sunnybrook_SCD0000101/ED_image.nii.gz");
  EXPECT_EQ(ventricle.volume.grid.size, (std::array<int, 3>{256, 256, 9}));
  EXPECT_NEAR(ventricle.volume.grid.spacing[2], 10, 1e-4);
  const io::LoadedVolume<Label> seg =
      io::readLabels(data_ / "synthseg_labels/training_seg_09.nii.gz");
  EXPECT_EQ(std::count(seg.volume.data.begin(), seg.volume.data.end(), 2), 205288);
  const io::LoadedVolume<float> grey =
      io::readScalars(data_ / "mni152_tissue/mni_icbm152_gm_tal_nlin_sym_09a_converted.nii.gz");
  EXPECT_EQ(std::count_if(grey.volume.data.begin(), grey.volume.data.end(),
                          [](float p) { return p > 127.5F; }),
            1079599);
}

}  // namespace
