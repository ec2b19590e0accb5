// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Maps/Icosphere.h"

#include "Explica/Core/Errors.h"
#include "Explica/Geometry/MeshMeasures.h"
#include "Explica/Geometry/MeshTopology.h"
#include "Explica/IO/SurfaceFile.h"

#include <gtest/gtest.h>

#include <filesystem>

namespace explica::maps {
namespace {

TEST(Icosphere, IsAClosedSphereWhoseLevelsBeginTheNext) {
  for (int level = 0; level < 6; ++level) {
    const TriangleMesh mesh = fsaverageSphere(level), finer = fsaverageSphere(level + 1);
    EXPECT_EQ(mesh.vertexCount(), 10 * (1 << (2 * level)) + 2);
    EXPECT_TRUE(geometry::inspectMesh(mesh).closedManifold());
    EXPECT_GT(geometry::enclosedVolume(mesh), 0);
    EXPECT_LT((mesh.positions - finer.positions.topRows(mesh.vertexCount())).cwiseAbs().maxCoeff(),
              1e-9);
    EXPECT_LT((mesh.positions.rowwise().norm().array() - 100).abs().maxCoeff(), 1e-9);
  }
}

TEST(Icosphere, NamesAreFsaveragesAndOthersAreNone) {
  EXPECT_EQ(fsaverageLevel("fsaverage"), 7);
  EXPECT_EQ(fsaverageLevel("fsaverage5"), 5);
  EXPECT_EQ(fsaverageLevel("fsaverage7"), std::nullopt);
  EXPECT_EQ(fsaverageLevel("fs_LR-32k"), std::nullopt);
  EXPECT_THROW((void)fsaverageSphere(8), InvalidInput);
}

TEST(Icosphere, IsFsaveragesSphereVertexForVertex) {
  const auto file = std::filesystem::path(EXPLICA_REAL_DATA) /
                    "fsaverage/surf/fsaverage_std_sphere.L.164k_fsavg_L.surf.gii";
  if (!std::filesystem::exists(file)) GTEST_SKIP() << "skipped: no real data";
  const TriangleMesh theirs = io::readSurface(file).mesh, ours = fsaverageSphere(7);
  EXPECT_EQ(ours.faces, theirs.faces);
  const Eigen::VectorXd off = (ours.positions - theirs.positions).rowwise().norm();
  EXPECT_LT(off.maxCoeff(), 0.015);  // the last of four decimals
  EXPECT_LT((off.array() > 1e-4).count(), 300);
}

}  // namespace
}  // namespace explica::maps
