// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Core/Errors.h"
#include "Explica/Geometry/Fixtures.h"
#include "Explica/IO/SurfaceFile.h"
#include "Explica/IO/VolumeFile.h"
#include "Explica/Testing/Meshes.h"
#include "TemporaryFolder.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include <cmath>
#include <map>
#include <string>

namespace {

using namespace explica;
namespace fs = std::filesystem;

/// A sphere at no special place, so that every digit of its coordinates counts.
TriangleMesh someSurface() {
  return geometry::makeIcosphere(2, 47.3, Point(-12.345678901234567, 31.4159265358979, 1.0 / 3));
}

double largestDistance(const TriangleMesh& a, const TriangleMesh& b) {
  return (a.positions - b.positions).rowwise().norm().maxCoeff();
}

struct Format {
  std::string name;
  bool exact;          ///< keeps doubles; else float32
  bool keepsVertices;  ///< numbers vertices as we do

  friend std::ostream& operator<<(std::ostream& out, const Format& format) {
    return out << format.name;
  }
};

TEST(SurfaceFormats, EveryEndingIsWrittenReadBackAndTakenOffNames) {
  const TemporaryFolder folder;
  const TriangleMesh mesh = someSurface();
  std::map<std::string, std::string> formatBy;
  for (const std::string& ending : io::surfaceEndings()) {
    const fs::path file = folder / ("lh.pial" + ending);
    io::writeSurface(file, mesh);
    const io::LoadedSurface read = io::readSurface(file);
    EXPECT_EQ(read.mesh.faceCount(), mesh.faceCount()) << ending;
    formatBy[ending] = read.origin.format;
    EXPECT_EQ(io::nameOfSurface(file), "lh.pial");
  }
  EXPECT_EQ(formatBy[".obj"], "OBJ");
  EXPECT_EQ(io::nameOfSurface("a/lh.pial"), "lh.pial");
  EXPECT_EQ(io::nameOfSurface("lh.pial.surf.gii.gz"), "lh.pial");
  EXPECT_EQ(io::nameOfSurface("lh.pial.VTK"), "lh.pial");
  EXPECT_EQ(io::nameOfSurface(".ply"), ".ply");
}

class SurfaceContract : public testing::TestWithParam<Format> {
 protected:
  [[nodiscard]] fs::path file() const { return folder_ / GetParam().name; }
  TemporaryFolder folder_;
};

TEST_P(SurfaceContract, WriteThenReadIsIdentityWithinTheFormatsNumbers) {
  const TriangleMesh written = someSurface();
  io::writeSurface(file(), written);
  const TriangleMesh read = io::readSurface(file()).mesh;
  ASSERT_EQ(read.vertexCount(), written.vertexCount());
  ASSERT_EQ(read.faceCount(), written.faceCount());
  if (GetParam().keepsVertices) {
    EXPECT_EQ(read.faces, written.faces);
    // Half a unit in the last place of float32 below 128, in each of 3 coordinates.
    const double bound = GetParam().exact ? 0 : std::sqrt(3.0) * 64 * std::exp2(-24);
    EXPECT_LE(largestDistance(read, written), bound);
  } else {
    for (Eigen::Index f = 0; f < read.faceCount(); ++f) {
      for (int k = 0; k < 3; ++k) {
        EXPECT_LT((read.corner(f, k) - written.corner(f, k)).norm(), 1e-5);
      }
    }
  }
}

TEST_P(SurfaceContract, TheSameBytesEveryTime) {
  io::writeSurface(file(), someSurface());
  const std::string first = contentOf(file());
  io::writeSurface(file(), someSurface());
  EXPECT_TRUE(contentOf(file()) == first);
  EXPECT_EQ(folder_.entryCount(), 1);
}

TEST_P(SurfaceContract, EveryTruncationIsRefused) {
  io::writeSurface(file(), geometry::makeIcosphere(0));
  const std::string whole = contentOf(file());
  // FreeSurfer's geometry footer may be missing; text formats lose nothing with the last line feed.
  std::size_t needed = whole.size() - 1;
  if (GetParam().name == "lh.white") needed = whole.find("valid") - 12;
  if (GetParam().name == "a.obj") needed = 0;  // has no counts: any prefix may be whole
  if (GetParam().name == "a.vtp") needed = whole.size() - 60;
  if (GetParam().name == "a.surf.gii") needed = whole.size() - 2;
  for (std::size_t kept = 0; kept < needed; kept += 1 + kept / 64) {
    putContent(file(), whole.substr(0, kept));
    EXPECT_NE(complaintOf<Error>([&] { static_cast<void>(io::readSurface(file())); }), "")
        << kept << " of " << whole.size() << " bytes";
  }
}

TEST_P(SurfaceContract, AnEmptyMeshIsNotWritten) {
  EXPECT_THROW(io::writeSurface(file(), TriangleMesh()), InvalidInput);
  EXPECT_EQ(folder_.entryCount(), 0);
}

INSTANTIATE_TEST_SUITE_P(Formats, SurfaceContract,
                         testing::Values(Format{"a.surf.gii", false, true},
                                         Format{"a.surf.gii.gz", false, true},
                                         Format{"lh.white", false, true},
                                         Format{"a.vtp", true, true}, Format{"a.ply", true, true},
                                         Format{"a.obj", true, true}, Format{"a.off", true, true},
                                         Format{"a.stl", false, false}),
                         [](const auto& instance) {
                           std::string name = instance.param.name;
                           std::replace(name.begin(), name.end(), '.', '_');
                           return name;
                         });

TEST(GiftiSurface, KeepsItsMetadata) {
  const TemporaryFolder folder;
  io::SurfaceMetadata metadata;
  metadata.structure = "CortexRight";
  metadata.secondary = "Pial";
  metadata.geometricType = "Inflated";
  metadata.name = "a <name> & more";
  metadata.extra["Explica:Version"] = "0.1";
  io::writeGiftiSurface(folder / "a.surf.gii", someSurface(), metadata);
  const io::LoadedSurface read = io::readSurface(folder / "a.surf.gii");
  EXPECT_EQ(read.metadata.structure, "CortexRight");
  EXPECT_EQ(read.metadata.secondary, "Pial");
  EXPECT_EQ(read.metadata.geometricType, "Inflated");
  EXPECT_EQ(read.metadata.topologicalType, "Closed");
  EXPECT_EQ(read.metadata.name, "a <name> & more");
  EXPECT_EQ(read.metadata.extra.at("Explica:Version"), "0.1");
  EXPECT_EQ(read.origin.space, "SCANNER_ANAT");
  io::writeGiftiSurface(folder / "b.surf.gii", geometry::makeRectangle(3, 3, 1, 1));
  EXPECT_EQ(io::readSurface(folder / "b.surf.gii").metadata.topologicalType, "Open");
}

/// GIFTI of one triangle with the given point set element's insides.
std::string giftiOf(const std::string& metadata, const std::string& system) {
  return "<?xml version=\"1.0\"?><GIFTI Version=\"1.0\" NumberOfDataArrays=\"2\"><MetaData/>"
         "<LabelTable/><DataArray Intent=\"NIFTI_INTENT_POINTSET\" DataType=\"NIFTI_TYPE_FLOAT32\" "
         "ArrayIndexingOrder=\"RowMajorOrder\" Dimensionality=\"2\" Dim0=\"3\" Dim1=\"3\" "
         "Encoding=\"ASCII\" Endian=\"LittleEndian\">" +
         metadata + system +
         "<Data>1 2 3 4 5 6 7 8 10</Data></DataArray><DataArray "
         "Intent=\"NIFTI_INTENT_TRIANGLE\" DataType=\"NIFTI_TYPE_INT32\" "
         "ArrayIndexingOrder=\"ColumnMajorOrder\" Dimensionality=\"2\" Dim0=\"1\" Dim1=\"3\" "
         "Encoding=\"ASCII\" Endian=\"LittleEndian\"><Data>0 1 2</Data></DataArray></GIFTI>";
}

std::string systemOf(const std::string& space) {
  return "<CoordinateSystemTransformMatrix><DataSpace>NIFTI_XFORM_" + space +
         "</DataSpace><TransformedSpace>NIFTI_XFORM_TALAIRACH</TransformedSpace><MatrixData>1 0 0 "
         "5 "
         "0 1 0 0 0 0 1 0 0 0 0 1</MatrixData></CoordinateSystemTransformMatrix>";
}

/// An oblique, anisotropic volume of odd sizes.
Grid obliqueVolume() {
  Grid grid;
  grid.size = {61, 50, 43};
  grid.spacing = {0.8, 1.1, 2.3};
  grid.direction = Eigen::AngleAxisd(0.7, Vector(3, -1, 2).normalized()).toRotationMatrix();
  grid.origin = {-20, 33, 5};
  return grid;
}

std::string volGeomOf(const Grid& grid) {
  std::string text = "<MetaData>";
  const auto put = [&text](const std::string& key, double value) {
    char number[40];
    std::snprintf(number, sizeof(number), "%.12f", value);
    text += "<MD><Name>VolGeom" + key + "</Name><Value>" + number + "</Value></MD>";
  };
  put("Width", grid.size[0]);
  put("Height", grid.size[1]);
  put("Depth", grid.size[2]);
  put("Xsize", grid.spacing[0]);
  put("Ysize", grid.spacing[1]);
  put("Zsize", grid.spacing[2]);
  const Point centre = grid.toWorld(0.5 * Vector(grid.size[0], grid.size[1], grid.size[2]));
  const char letters[] = {'R', 'A', 'S'};
  for (int row = 0; row < 3; ++row) {
    put(std::string("X_") + letters[row], grid.direction(row, 0));
    put(std::string("Y_") + letters[row], grid.direction(row, 1));
    put(std::string("Z_") + letters[row], grid.direction(row, 2));
    put(std::string("C_") + letters[row], centre[row]);
  }
  return text + "</MetaData>";
}

/// Surface RAS of a voxel by FreeSurfer's definition, written out.
Point tkrOfVoxel(const Grid& grid, const Vector& voxel) {
  const Vector fromMiddle =
      (voxel - 0.5 * Vector(grid.size[0], grid.size[1], grid.size[2])).cwiseProduct(grid.spacing);
  return {-fromMiddle[0], fromMiddle[2], -fromMiddle[1]};
}

TEST(SurfaceFrame, ScannerFromTkrSendsEachVoxelToItsPlace) {
  const Grid grid = obliqueVolume();
  const Eigen::Matrix4d matrix = io::scannerFromTkr(grid);
  for (const Vector& voxel : {Vector(0, 0, 0), Vector(60, 3, 17), Vector(2.5, 49, 42)}) {
    const Point moved = (matrix * tkrOfVoxel(grid, voxel).homogeneous()).head<3>();
    EXPECT_LT((moved - grid.toWorld(voxel)).norm(), 1e-12);
  }
}

TEST(SurfaceFrame, ScannerAndAtlasSpacesAreUsedAsTheyStand) {
  const TemporaryFolder folder;
  for (const char* space : {"SCANNER_ANAT", "ALIGNED_ANAT", "TALAIRACH", "MNI_152"}) {
    putContent(folder / "a.gii", giftiOf(volGeomOf(obliqueVolume()), systemOf(space)));
    const io::LoadedSurface read = io::readSurface(folder / "a.gii");
    EXPECT_EQ(read.mesh.positions(2, 2), 10);
    EXPECT_EQ(read.origin.space, space);
    EXPECT_EQ(read.origin.notes.size(), 1U) << "a matrix that is not applied is to be mentioned";
  }
}

TEST(SurfaceFrame, UnknownWithVolGeomIsSurfaceRasAndMovedByTheWholeMatrix) {
  const TemporaryFolder folder;
  const Grid grid = obliqueVolume();
  putContent(folder / "a.gii", giftiOf(volGeomOf(grid), systemOf("UNKNOWN")));
  const io::LoadedSurface read = io::readSurface(folder / "a.gii");
  EXPECT_EQ(read.origin.space, "tkr, moved to scanner");
  const Eigen::Vector4d expected = io::scannerFromTkr(grid) * Eigen::Vector4d(7, 8, 10, 1);
  EXPECT_LT((read.mesh.positions.row(2).transpose() - expected.head<3>()).norm(), 1e-9);
  EXPECT_GT((read.mesh.positions.row(2) - Eigen::RowVector3d(7, 8, 10)).norm(), 1);
  EXPECT_EQ(
      io::readSurface(folder / "a.gii", {.space = io::SurfaceSpace::Scanner}).mesh.positions(2, 2),
      10);
}

TEST(SurfaceFrame, UnknownWithoutVolGeomIsSaidNotGuessed) {
  const TemporaryFolder folder;
  putContent(folder / "a.gii", giftiOf("<MetaData/>", ""));
  const io::LoadedSurface read = io::readSurface(folder / "a.gii");
  EXPECT_EQ(read.origin.space, "not stated");
  ASSERT_EQ(read.origin.notes.size(), 1U);
  EXPECT_NE(read.origin.notes[0].find("--surface-space"), std::string::npos);
  const std::string complaint = complaintOf<InvalidInput>([&] {
    static_cast<void>(io::readSurface(folder / "a.gii", {.space = io::SurfaceSpace::Tkr}));
  });
  EXPECT_NE(complaint.find("--fs-volume"), std::string::npos) << complaint;
}

TEST(SurfaceFrame, AVolumeOnTheSidePlacesASurface) {
  const TemporaryFolder folder;
  const Grid grid = obliqueVolume();
  io::writeVolume(folder / "orig.mgz", Volume<std::uint8_t>(grid, 1));
  putContent(folder / "a.gii", giftiOf("<MetaData/>", ""));
  io::SurfaceReadOptions options;
  options.fsVolume = (folder / "orig.mgz").string();
  const io::LoadedSurface read = io::readSurface(folder / "a.gii", options);
  const Eigen::Vector4d expected = io::scannerFromTkr(grid) * Eigen::Vector4d(7, 8, 10, 1);
  EXPECT_LT((read.mesh.positions.row(2).transpose() - expected.head<3>()).norm(), 1e-4);
}

TEST(FreeSurferSurface, WrittenForAVolumeComesBackToScanner) {
  const TemporaryFolder folder;
  const TriangleMesh written = someSurface();
  io::writeFreeSurferSurface(folder / "lh.white", written, obliqueVolume());
  const io::LoadedSurface read = io::readSurface(folder / "lh.white");
  EXPECT_EQ(read.origin.space, "tkr, moved to scanner");
  EXPECT_EQ(read.metadata.structure, "CortexLeft");
  EXPECT_LT(largestDistance(read.mesh, written), 3e-5);  // float32 about 100 mm, rotated
  const io::LoadedSurface raw =
      io::readSurface(folder / "lh.white", {.space = io::SurfaceSpace::Scanner});
  EXPECT_GT(largestDistance(raw.mesh, written), 1);
}

std::string bigEndian32(std::uint32_t value) {
  return {static_cast<char>(value >> 24), static_cast<char>(value >> 16),
          static_cast<char>(value >> 8), static_cast<char>(value)};
}

TEST(FreeSurferSurface, QuadsOfOldFilesAreSplit) {
  const TemporaryFolder folder;
  // Old magic, 4 vertices in hundredths, one quad that starts at an odd vertex.
  std::string bytes = "\xff\xff\xff";
  bytes += bigEndian32(4).substr(1) + bigEndian32(1).substr(1);
  for (const int x : {0, 0, 0, 150, 0, 0, 150, 250, 0, 0, 250, -100}) {
    bytes += bigEndian32(static_cast<std::uint32_t>(x)).substr(2);
  }
  for (const std::uint32_t corner : {1U, 2U, 3U, 0U}) bytes += bigEndian32(corner).substr(1);
  putContent(folder / "rh.old", bytes);
  const io::LoadedSurface read = io::readSurface(folder / "rh.old");
  EXPECT_DOUBLE_EQ(read.mesh.positions(3, 2), -1.0);
  EXPECT_DOUBLE_EQ(read.mesh.positions(2, 1), 2.5);
  Faces expected(2, 3);
  expected << 1, 2, 3, 1, 3, 0;
  EXPECT_EQ(read.mesh.faces, expected);
}

TEST(SurfaceFile, PolygonsAreSplitAndSaid) {
  const TemporaryFolder folder;
  putContent(folder / "a.off",
             "OFF # a square\n4 1 4\n\n0 0 0\n1 0 0 # corner\n1 1 0\n0 1 0\n4 0 1 2 3\n");
  putContent(folder / "a.obj",
             "v 0 0 0\nv 1 0 0\nvt 0 0\nv 1 1 0\nv 0 1 0\nf -4/1 -3/1 -2/1 -1/1\n");
  putContent(folder / "a.ply",
             "ply\nformat ascii 1.0\nelement vertex 4\nproperty uchar red\nproperty float x\n"
             "property float y\nproperty float z\nelement face 1\nproperty list uchar int "
             "vertex_index\nend_header\n9 0 0 0\n8 1 0 0\n7 1 1 0\n6 0 1 0\n4 0 1 2 3\n");
  putContent(folder / "a.vtk",
             "# vtk DataFile Version 3.0\na title\nASCII\nDATASET POLYDATA\nPOINTS 4 float\n"
             "0 0 0 1 0 0 1 1 0 0 1 0\nPOLYGONS 1 5\n4 0 1 2 3\nPOINT_DATA 4\nSCALARS red float\n"
             "LOOKUP_TABLE default\n9 8 7 6\n");
  Faces expected(2, 3);
  expected << 0, 1, 2, 0, 2, 3;
  for (const char* name : {"a.off", "a.obj", "a.ply", "a.vtk"}) {
    const io::LoadedSurface read = io::readSurface(folder / name);
    EXPECT_EQ(read.mesh.faces, expected) << name;
    EXPECT_NE(read.origin.notes[0].find("split"), std::string::npos) << name;
  }
  for (const char* name : {"a.ply", "a.vtk"}) {
    const std::vector<io::VertexMap> maps = io::readVertexMaps(folder / name, 4);
    ASSERT_EQ(maps.size(), 1U);
    EXPECT_EQ(maps[0].name, "red");
    EXPECT_EQ(maps[0].values, Eigen::Vector4d(9, 8, 7, 6));
  }
}

TEST(SurfaceFile, WhatLiesBehindTheLastFaceIsSaid) {
  const TemporaryFolder folder;
  const std::string off = "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
  const std::string ply =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
      "property float z\nelement face 1\nproperty list uchar int vertex_index\nend_header\n"
      "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
  const auto said = [&](const std::string& name) {
    std::string notes;
    for (const std::string& note : io::readSurface(folder / name).origin.notes)
      notes += note + "\n";
    return notes.find("8 bytes after the last face are not used") != std::string::npos;
  };
  for (const auto& [name, text] : {std::pair("a.off", off), std::pair("a.ply", ply)}) {
    putContent(folder / name, text + "\n \n# the end\n");
    EXPECT_FALSE(said(name)) << name;
    putContent(folder / name, text + "3 0 2 1\n");
    EXPECT_TRUE(said(name)) << name;
  }
}

TEST(SurfaceFile, StripsAlternateTheirSense) {
  const TemporaryFolder folder;
  putContent(folder / "a.vtk",
             "# vtk DataFile Version 3.0\na title\nASCII\nDATASET POLYDATA\nPOINTS 4 double\n"
             "0 0 0 1 0 0 0 1 0 1 1 0\nTRIANGLE_STRIPS 1 5\n4 0 1 2 3\n");
  Faces expected(2, 3);
  expected << 0, 1, 2, 1, 3, 2;
  EXPECT_EQ(io::readSurface(folder / "a.vtk").mesh.faces, expected);
}

TEST(SurfaceFile, TextStlIsMerged) {
  const TemporaryFolder folder;
  putContent(
      folder / "a.stl",
      "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\n"
      "endloop\nendfacet\nfacet normal 0 0 1\nouter loop\nvertex 1 0 0\nvertex 1 1 0\nvertex "
      "-0 1 0\nendloop\nendfacet\nendsolid a\n");
  const TriangleMesh mesh = io::readSurface(folder / "a.stl").mesh;
  EXPECT_EQ(mesh.vertexCount(), 4);
  Faces expected(2, 3);
  expected << 0, 1, 2, 1, 3, 2;
  EXPECT_EQ(mesh.faces, expected);
}

TEST(SurfaceFile, WhatIsNoSurfaceIsNamed) {
  const TemporaryFolder folder;
  putContent(folder / "text.gii", "just text");
  putContent(folder / "range.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n");
  putContent(folder / "nan.off", "OFF\n3 1 0\n0 0 0\n1 nan 0\n0 1 0\n3 0 1 2\n");
  putContent(folder / "xml.gii", "<?xml version=\"1.0\"?>\n<VTKFile type=\"ImageData\"></VTKFile>");
  io::writeGiftiShape(folder / "a.shape.gii", {{"a", "", Eigen::VectorXd::Ones(3)}}, "Other");
  io::writeFreeSurferCurv(folder / "lh.curv", Eigen::VectorXd::Ones(3), 1);
  struct Row {
    fs::path path;
    const char* words;
  };
  for (const Row& row :
       {Row{folder / "missing.gii", "no such file"}, Row{folder.path(), "is a folder"},
        Row{folder / "text.gii", "not a surface"}, Row{folder / "range.off", "names vertex 3"},
        Row{folder / "nan.off", "not finite"}, Row{folder / "xml.gii", "PolyData is needed"},
        Row{folder / "a.shape.gii", "without points"},
        Row{folder / "lh.curv", "per-vertex values"}}) {
    const std::string complaint =
        complaintOf<Error>([&] { static_cast<void>(io::readSurface(row.path)); });
    EXPECT_NE(complaint.find(row.words), std::string::npos) << complaint;
    EXPECT_NE(complaint.find(row.path.string()), std::string::npos) << complaint;
  }
}

TEST(SurfaceFile, StructureFollowsUsualNames) {
  EXPECT_EQ(io::structureFromName("surf/lh.pial"), "CortexLeft");
  EXPECT_EQ(io::structureFromName("sub-01_hemi-R_white.surf.gii"), "CortexRight");
  EXPECT_EQ(io::structureFromName("pial_left.gii.gz"), "CortexLeft");
  EXPECT_EQ(io::structureFromName("ventricle.stl"), "Other");
}

TEST(SurfaceTypes, FollowTheNameWhereTheFileIsSilent) {
  const TemporaryFolder folder;
  const TriangleMesh mesh = geometry::makeIcosphere(1, 10.0);
  struct Row {
    const char *name, *type, *secondary;
  };
  for (const Row& row : {Row{"lh.white", "Anatomical", "GrayWhite"},
                         Row{"lh.pial", "Anatomical", "Pial"}, Row{"rh.inflated", "Inflated", ""},
                         Row{"lh.sphere", "Spherical", ""}, Row{"lh.orig", "Anatomical", ""}}) {
    io::writeFreeSurferSurface(folder / row.name, mesh);
    const io::SurfaceMetadata read = io::readSurface(folder / row.name).metadata;
    EXPECT_EQ(read.geometricType, row.type) << row.name;
    EXPECT_EQ(read.secondary, row.secondary) << row.name;
  }
}

TEST(FrameMixUp, IsNamedWhenItExplainsTheDistance) {
  const TriangleMesh mesh = geometry::makeIcosphere(3, 30.0, Point(10, 20, 30));
  Eigen::Matrix4d shift = Eigen::Matrix4d::Identity();
  shift.topRightCorner<3, 1>() << 0, -25, 18;  // surface RAS to scanner RAS
  const Point onSurface = mesh.positions.row(7).transpose();
  EXPECT_EQ(io::frameMixUp(onSurface, mesh.positions, shift), "");
  const std::string tkr = io::frameMixUp(onSurface - Vector(0, -25, 18), mesh.positions, shift);
  EXPECT_NE(tkr.find("tkregister"), std::string::npos) << tkr;
  const std::string scanner = io::frameMixUp(onSurface + Vector(0, -25, 18), mesh.positions, shift);
  EXPECT_NE(scanner.find("scanner RAS"), std::string::npos) << scanner;
  EXPECT_EQ(io::frameMixUp(Point(500, 0, 0), mesh.positions, shift), "");
  EXPECT_EQ(io::frameMixUp(Point(500, 0, 0), mesh.positions, Eigen::Matrix4d::Identity()), "");
}

}  // namespace
