// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/IO/PatchFile.h"

#include "Explica/Core/Errors.h"
#include "Explica/Testing/Meshes.h"
#include "TemporaryFolder.h"

#include <gtest/gtest.h>

namespace {

using namespace explica;

/// The vertices of a 6 x 5 rectangle but those of its first column.
io::Patch somePatch(TriangleMesh& mesh) {
  mesh = geometry::makeRectangle(6, 5, 6, 5);
  std::vector<bool> in(static_cast<std::size_t>(mesh.vertexCount()));
  for (std::size_t v = 0; v < in.size(); ++v) in[v] = mesh.positions(v, 0) > 0.5;
  return io::patchOf(mesh, in);
}

/// A patch file by its words.
std::string fileOf(const std::vector<std::int32_t>& words) {
  std::string bytes;
  for (const std::int32_t word : words) {
    for (int shift = 24; shift >= 0; shift -= 8) bytes += static_cast<char>(word >> shift);
  }
  return bytes;
}

TEST(Patch, ComesBackAsItWasWritten) {
  const TemporaryFolder folder;
  TriangleMesh mesh;
  const io::Patch patch = somePatch(mesh);
  io::writePatch(folder / "lh.patch.3d", patch);
  EXPECT_TRUE(io::isPatchFile(folder / "lh.patch.3d"));
  const io::Patch read = io::readPatch(folder / "lh.patch.3d", mesh.vertexCount());
  EXPECT_EQ(read.vertices, patch.vertices);
  EXPECT_EQ(read.border, patch.border);
  EXPECT_EQ(read.positions, patch.positions.cast<float>().cast<double>());
}

TEST(Patch, HasTheFacesAndTheRimOfItsVertices) {
  TriangleMesh mesh;
  const io::Patch patch = somePatch(mesh);
  EXPECT_EQ(patch.vertices.size(), 36U);  // 6 x 6 of 7 x 6
  EXPECT_EQ(io::patchFaces(patch, mesh.faces, mesh.vertexCount()).rows(), 2 * 5 * 5);
  // All but the 4 x 4 in the middle of the 6 x 6.
  EXPECT_EQ(std::count(patch.border.begin(), patch.border.end(), true), 20);
  for (std::size_t i = 0; i < patch.vertices.size(); ++i) {
    const auto at = patch.positions.row(static_cast<Eigen::Index>(i));
    const bool rim = at[0] < 1.5 || at[0] > 5.5 || at[1] < 0.5 || at[1] > 4.5;
    EXPECT_EQ(patch.border[i], rim) << at;
  }
}

TEST(Patch, ThatCannotBeIsRefused) {
  const TemporaryFolder folder;
  const auto complaint = [&](const std::string& content, const std::string& words) {
    putContent(folder / "p", content);
    std::string text;
    try {
      static_cast<void>(io::readPatch(folder / "p", 10));
    } catch (const Error& error) {
      text = error.what();
    }
    EXPECT_NE(text.find(words), std::string::npos) << text;
  };
  complaint(fileOf({-2, 1, 1, 0, 0, 0}), "not a FreeSurfer patch");
  complaint(fileOf({-1, 2, 1, 0, 0, 0}), "vertices");
  complaint(fileOf({-1, -5, 1, 0, 0, 0}), "vertices");
  complaint(fileOf({-1, 1, 0, 0, 0, 0}), "code 0");
  complaint(fileOf({-1, 1, -11, 0, 0, 0}), "vertex 10");
  complaint(fileOf({-1, 2, 3, 0, 0, 0, -3, 0, 0, 0}), "vertex 2 twice");
  complaint(fileOf({-1, 1, 3, 0x7fc00000, 0, 0}), "not finite");
}

}  // namespace
