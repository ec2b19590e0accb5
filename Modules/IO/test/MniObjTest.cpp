// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Core/Errors.h"
#include "Explica/Geometry/Fixtures.h"
#include "Explica/IO/SurfaceFile.h"
#include "TemporaryFolder.h"

#include <gtest/gtest.h>

#include <string>

namespace {

using namespace explica;

/// A tetrahedron as BIC's library writes it: quads of corners spread over lines, colours a point.
const std::string kTetrahedron =
    "P 0.3 0.3 0.4 10 1 4\n 0 0 0\n 1 0 0\n 0 1 0\n 0 0 1\n\n -1 -1 -1\n 1 0 0\n 0 1 0\n 0 0 1\n\n"
    " 4\n 2 1 0 0 1 0 1 0 1 0 0 1 1 1 1 1 1\n\n 3 6 9 12\n\n 0 2 1 0 1 3 0\n 3 2 1 2 3\n";

TEST(MniObj, IsToldFromWavefrontByContentAndGivenBackExactly) {
  const TemporaryFolder folder;
  TriangleMesh mesh = geometry::makeIcosphere(2, 33.3, Point(1.1, -2.2, 3.3));
  io::writeSurface(folder / "a.mni.obj", mesh);
  EXPECT_TRUE(contentOf(folder / "a.mni.obj").starts_with("P "));
  std::filesystem::rename(folder / "a.mni.obj", folder / "gray_surface_left_81920.obj");
  const io::LoadedSurface read = io::readSurface(folder / "gray_surface_left_81920.obj");
  EXPECT_EQ(read.origin.format, "MNI obj");
  EXPECT_EQ(read.origin.space, "MINC world");
  EXPECT_EQ(read.mesh.positions, mesh.positions);
  EXPECT_EQ(read.mesh.faces, mesh.faces);
  io::writeSurface(folder / "b.obj", mesh);
  EXPECT_EQ(io::readSurface(folder / "b.obj").origin.format, "OBJ");
}

TEST(MniObj, ReadsColoursAndNumbersOverAnyLines) {
  const TemporaryFolder folder;
  putContent(folder / "a.obj", kTetrahedron);
  const TriangleMesh mesh = io::readSurface(folder / "a.obj").mesh;
  ASSERT_EQ(mesh.vertexCount(), 4);
  ASSERT_EQ(mesh.faceCount(), 4);
  EXPECT_EQ(mesh.faces(3, 0), 1);
  EXPECT_EQ(mesh.faces(3, 2), 3);
}

TEST(MniObj, WhatCannotBeUsedIsSaid) {
  const TemporaryFolder folder;
  const auto said = [&](const std::string& content) {
    putContent(folder / "a.obj", content);
    return complaintOf<Error>([&] { static_cast<void>(io::readSurface(folder / "a.obj")); });
  };
  const auto changed = [](const std::string& from, const std::string& to) {
    std::string text = kTetrahedron;
    return text.replace(text.find(from), from.size(), to);
  };
  EXPECT_EQ(said(kTetrahedron), "");
  EXPECT_NE(said("L 0.1 2\n0 0 0\n1 0 0\n").find("lines, no polygons"), std::string::npos);
  EXPECT_NE(said("p" + std::string(30, '\0')).find("binary MNI object"), std::string::npos);
  EXPECT_NE(said(changed("10 1 4\n", "10 1 4000000000\n")).find("more than it can hold"),
            std::string::npos);
  EXPECT_NE(said(changed(" 4\n 2", " -4\n 2")).find("more than it can hold"), std::string::npos);
  EXPECT_NE(said(changed(" 4\n 2 ", " 4\n 7 ")).find("unknown kind 7"), std::string::npos);
  EXPECT_NE(said(changed("3 6 9 12", "3 6 5 12")).find("go backwards"), std::string::npos);
  EXPECT_NE(said(changed("3 2 1 2 3", "3 2 1 2 9")).find("names vertex 9"), std::string::npos);
  EXPECT_NE(said(changed(" 1 0 0\n 0 1", " 1e18 0 0\n 0 1")).find("farther than 10 km"),
            std::string::npos);
  EXPECT_NE(said(kTetrahedron + kTetrahedron).find("more than one object"), std::string::npos);
  EXPECT_NE(said(kTetrahedron.substr(0, kTetrahedron.size() - 4)), "");
}

}  // namespace
