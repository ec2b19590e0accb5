// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/IO/PointTransformFile.h"

#include "Explica/Core/Errors.h"
#include "Explica/IO/SurfaceFile.h"
#include "TemporaryFolder.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include <cstdio>

namespace {

using namespace explica;

Eigen::Matrix4d someRigid() {
  Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
  matrix.topLeftCorner<3, 3>() =
      Eigen::AngleAxisd(0.3, Vector(1, 2, -1).normalized()).toRotationMatrix();
  matrix.topRightCorner<3, 1>() = Vector(5, -7, 11);
  return matrix;
}

std::string rowsOf(const Eigen::Matrix4d& matrix, const char* between = " ") {
  std::string text;
  char number[40];
  for (int i = 0; i < 16; ++i) {
    std::snprintf(number, sizeof number, "%.17g%s", matrix(i / 4, i % 4),
                  i % 4 == 3 ? "\n" : between);
    text += number;
  }
  return text;
}

/// An echo-planar volume, oblique and mirrored.
Grid volumeGrid() {
  Grid grid;
  grid.size = {64, 60, 30};
  grid.spacing = {2.2, 2.2, 3.5};
  grid.direction = Eigen::AngleAxisd(0.2, Vector::UnitX()).toRotationMatrix();
  grid.direction.col(0) *= -1;
  grid.origin = {60, -70, -40};
  return grid;
}

/// The anatomy, as FreeSurfer conforms it but shifted.
Grid anatomyGrid() {
  Grid grid;
  grid.size = {256, 256, 256};
  grid.direction << -1, 0, 0, 0, 0, 1, 0, -1, 0;
  grid.origin = {131, -120, 125};
  return grid;
}

io::TransformSides sides(io::TransformSense sense = io::TransformSense::Auto) {
  io::TransformSides both;
  both.volume = volumeGrid();
  both.scannerFromTkr = io::scannerFromTkr(anatomyGrid());
  both.scannerFromFile = *both.scannerFromTkr;
  both.sense = sense;
  return both;
}

std::string volumeInfo(const Grid& grid) {
  const auto line = [](const char* key, const Vector& v) {
    char text[160];
    std::snprintf(text, sizeof text, "%s = %.15e %.15e %.15e\n", key, v[0], v[1], v[2]);
    return std::string(text);
  };
  const Vector size(grid.size[0], grid.size[1], grid.size[2]);
  return "valid = 1  # volume info valid\nfilename = a.mgz\nvolume = " +
         std::to_string(grid.size[0]) + " " + std::to_string(grid.size[1]) + " " +
         std::to_string(grid.size[2]) + "\n" + line("voxelsize", grid.spacing) +
         line("xras  ", grid.direction.col(0)) + line("yras  ", grid.direction.col(1)) +
         line("zras  ", grid.direction.col(2)) + line("cras  ", grid.toWorld(0.5 * size));
}

std::string ltaOf(int type, const Eigen::Matrix4d& matrix, const Grid& source, const Grid& target) {
  return "# transform file a.lta\n# created by somebody\n\ntype      = " + std::to_string(type) +
         " # LINEAR\nnxforms   = 1\nmean      = 0 0 0\nsigma     = 1\n1 4 4\n" + rowsOf(matrix) +
         "src volume info\n" + volumeInfo(source) + "dst volume info\n" + volumeInfo(target) +
         "subject bert\nfscale 0.15\n";
}

/// Where a file takes a point, and what it should be: the world of the volume of a scanner point.
void expectMaps(const std::filesystem::path& path, const io::TransformSides& both,
                const Eigen::Matrix4d& truth) {
  const io::PointTransform transform = io::readPointTransform(path, both);
  Positions points(2, 3);
  points << 10, 20, 30, -40, 5, 1;
  const Positions moved = transform(points);
  for (int p = 0; p < 2; ++p) {
    const Eigen::Vector4d expected = truth * points.row(p).transpose().homogeneous();
    EXPECT_LT((moved.row(p).transpose() - expected.head<3>()).norm(), 1e-4)
        << path << ": " << transform.format << ", " << transform.sense;
  }
}

TEST(PointTransform, AllFormatsOfOneTransformAgree) {
  const TemporaryFolder folder;
  const Eigen::Matrix4d truth = someRigid();  // surface to volume, RAS
  putContent(folder / "plain.txt", "# surface to volume\n" + rowsOf(truth));
  expectMaps(folder / "plain.txt", sides(), truth);
  putContent(folder / "comma.csv", rowsOf(truth.inverse(), ","));
  expectMaps(folder / "comma.csv", sides(io::TransformSense::Inverse), truth);

  // ITK: points of the fixed image (the surface's) to the moving one, LPS.
  const Eigen::Vector4d flip(-1, -1, 1, 1);
  const Eigen::Matrix4d lps = flip.asDiagonal() * truth * flip.asDiagonal();
  std::string parameters;
  char number[40];
  for (int i = 0; i < 12; ++i) {
    const double value = i < 9 ? lps(i / 3, i % 3) : lps(i - 9, 3);
    std::snprintf(number, sizeof number, " %.17g", value);
    parameters += number;
  }
  putContent(folder / "itk.txt",
             "#Insight Transform File V1.0\n#Transform 0\nTransform: AffineTransform_double_3_3\n"
             "Parameters:" +
                 parameters + "\nFixedParameters: 0 0 0\n");
  expectMaps(folder / "itk.txt", sides(), truth);
  expectMaps(folder / "itk.txt", sides(io::TransformSense::Inverse), truth.inverse());

  // LTA, either way round and either type.
  putContent(folder / "a.lta", ltaOf(1, truth, anatomyGrid(), volumeGrid()));
  expectMaps(folder / "a.lta", sides(), truth);
  putContent(folder / "b.lta", ltaOf(1, truth.inverse(), volumeGrid(), anatomyGrid()));
  expectMaps(folder / "b.lta", sides(), truth);
  const Eigen::Matrix4d voxels =
      anatomyGrid().affine().inverse() * truth.inverse() * volumeGrid().affine();
  putContent(folder / "c.lta", ltaOf(0, voxels, volumeGrid(), anatomyGrid()));
  expectMaps(folder / "c.lta", sides(), truth);

  // register.dat: surface RAS of the anatomy to that of the volume.
  const Eigen::Matrix4d tkr =
      io::scannerFromTkr(volumeGrid()).inverse() * truth * io::scannerFromTkr(anatomyGrid());
  putContent(folder / "register.dat", "bert\n2.2\n3.5\n0.15\n" + rowsOf(tkr) + "round\n");
  expectMaps(folder / "register.dat", sides(), truth);

  // pycortex: coordinates of the surface's file to voxels.
  const Eigen::Matrix4d coord =
      volumeGrid().affine().inverse() * truth * io::scannerFromTkr(anatomyGrid());
  std::string json = "{\"coord\": [";
  for (int row = 0; row < 4; ++row) {
    json += row == 0 ? "[" : ", [";
    for (int column = 0; column < 4; ++column) {
      std::snprintf(number, sizeof number, "%s\n %.17g", column == 0 ? "" : ", ",
                    coord(row, column));
      json += number;
    }
    json += "]";
  }
  putContent(folder / "matrices.xfm",
             json + "\n ], \"magnet\": [[1, 0, 0, 0]], \"shape\": [30, 60, 64]}");
  expectMaps(folder / "matrices.xfm", sides(), truth);
}

TEST(PointTransform, ThatLeavesTheDirectionOpenIsRefused) {
  const TemporaryFolder folder;
  putContent(folder / "both.lta", ltaOf(1, someRigid(), volumeGrid(), volumeGrid()));
  const auto complaint = [&](const char* name, const io::TransformSides& both) {
    return complaintOf<InvalidInput>(
        [&] { static_cast<void>(io::readPointTransform(folder / name, both)); });
  };
  EXPECT_NE(complaint("both.lta", sides()).find("--to-volume-sense"), std::string::npos);
  expectMaps(folder / "both.lta", sides(io::TransformSense::Forward), someRigid());
  expectMaps(folder / "both.lta", sides(io::TransformSense::Inverse), someRigid().inverse());
  putContent(folder / "neither.lta", ltaOf(1, someRigid(), anatomyGrid(), anatomyGrid()));
  EXPECT_NE(complaint("neither.lta", sides()).find("neither"), std::string::npos);

  putContent(folder / "register.dat", "bert\n1\n1\n1\n" + rowsOf(someRigid()) + "round\n");
  io::TransformSides silent = sides();
  silent.scannerFromTkr.reset();
  EXPECT_NE(complaint("register.dat", silent).find("--fs-volume"), std::string::npos);

  Eigen::Matrix4d flat = someRigid();
  flat.row(1).setZero();
  putContent(folder / "flat.txt", rowsOf(flat));
  EXPECT_NE(complaint("flat.txt", sides()).find("cannot be inverted"), std::string::npos);
  putContent(folder / "projective.txt", rowsOf(2 * someRigid()));
  EXPECT_NE(complaint("projective.txt", sides()).find("not affine"), std::string::npos);
}

TEST(PointTransform, OfNoKnownFormatIsNoTransform) {
  const TemporaryFolder folder;
  for (const char* text :
       {"hello", "1 2 3", "{\"magnet\": [[1]]}", "{\"coord\": [[1, 2], [3, 4]]}",
        "#Insight Transform File V1.0\nTransform: Nonsense\n", "\x89HDF\r\n\x1a\nrubbish"}) {
    putContent(folder / "t", text);
    EXPECT_THROW(static_cast<void>(io::readPointTransform(folder / "t", sides())), Error) << text;
  }
  EXPECT_THROW(static_cast<void>(io::readPointTransform(folder / "absent", sides())), IOError);
}

}  // namespace
