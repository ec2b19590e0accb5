// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

// ITK and VTK read our files, and we read theirs.

#include "Explica/Core/Errors.h"
#include "Explica/Geometry/Fixtures.h"
#include "Explica/IO/PolygonFile.h"
#include "Explica/IO/SurfaceFile.h"
#include "Explica/IO/VolumeFile.h"
#include "Explica/IO/VtkFile.h"
#include "TemporaryFolder.h"

#include <gtest/gtest.h>

#include <itkImageFileReader.h>
#include <itkImageFileWriter.h>
#include <itkMetaImageIOFactory.h>
#include <itkNiftiImageIOFactory.h>
#include <itkNrrdImageIOFactory.h>

#include <vtkCellData.h>
#include <vtkDataArray.h>
#include <vtkFieldData.h>
#include <vtkFloatArray.h>
#include <vtkNew.h>
#include <vtkOBJReader.h>
#include <vtkPLYReader.h>
#include <vtkPLYWriter.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkPolyDataReader.h>
#include <vtkPolyDataWriter.h>
#include <vtkSTLReader.h>
#include <vtkSTLWriter.h>
#include <vtkUnstructuredGrid.h>
#include <vtkXMLPolyDataReader.h>
#include <vtkXMLPolyDataWriter.h>
#include <vtkXMLUnstructuredGridReader.h>

#include <Eigen/Geometry>

#include <cmath>
#include <string>

namespace {

using namespace explica;
using Image = itk::Image<float, 3>;

void registerFormats() {
  itk::NiftiImageIOFactory::RegisterOneFactory();
  itk::NrrdImageIOFactory::RegisterOneFactory();
  itk::MetaImageIOFactory::RegisterOneFactory();
}

Volume<float> someVolume(bool leftHanded) {
  Grid grid;
  grid.size = {6, 5, 4};
  grid.spacing = {0.9, 1.7, 3.1};
  grid.direction = Eigen::AngleAxisd(0.8, Vector(2, 1, -1).normalized()).toRotationMatrix();
  if (leftHanded) grid.direction.col(2) *= -1;
  grid.origin = {12.5, -7.25, 30};
  Volume<float> volume(grid);
  for (std::size_t v = 0; v < volume.size(); ++v) volume[v] = std::cos(static_cast<float>(v));
  return volume;
}

void expectSame(const Image& image, const Volume<float>& volume, const std::string& what) {
  const Grid& grid = volume.grid;
  for (std::size_t v = 0; v < volume.size(); ++v) {
    const std::array<int, 3> at = grid.subscripts(v);
    const Image::IndexType index = {{at[0], at[1], at[2]}};
    ASSERT_EQ(image.GetPixel(index), volume[v]) << what;
    Image::PointType lps;
    image.TransformIndexToPhysicalPoint(index, lps);
    const Point world = grid.toWorld(Vector(at[0], at[1], at[2]));
    ASSERT_LT((world - Point(-lps[0], -lps[1], lps[2])).norm(), 1e-5) << what;
  }
}

TEST(Itk, ReadsOurVolumesThroughItsFactories) {
  registerFormats();
  const TemporaryFolder folder;
  for (const bool leftHanded : {false, true}) {
    const Volume<float> volume = someVolume(leftHanded);
    for (const char* name : {"a.nii", "a.nii.gz"}) {
      io::writeVolume(folder / name, volume);
      const auto reader = itk::ImageFileReader<Image>::New();
      reader->SetFileName((folder / name).string());
      ASSERT_NO_THROW(reader->Update()) << name;
      expectSame(*reader->GetOutput(), volume, name);
    }
  }
}

TEST(Itk, WritesVolumesThatWeRead) {
  registerFormats();
  const TemporaryFolder folder;
  const Volume<float> volume = someVolume(true);
  io::writeVolume(folder / "a.nii", volume);
  const auto reader = itk::ImageFileReader<Image>::New();
  reader->SetFileName((folder / "a.nii").string());
  for (const char* name : {"b.nii.gz", "b.nrrd", "b.nhdr", "b.mha", "b.mhd"}) {
    for (const bool packed : {false, true}) {
      const auto writer = itk::ImageFileWriter<Image>::New();
      writer->SetInput(reader->GetOutput());
      writer->SetFileName((folder / name).string());
      writer->SetUseCompression(packed);
      ASSERT_NO_THROW(writer->Update()) << name;
      const io::LoadedVolume<float> read = io::readScalars(folder / name);
      EXPECT_EQ(read.volume.data, volume.data) << name;
      EXPECT_TRUE(sameGrid(read.volume.grid, volume.grid, 1e-5)) << name;
    }
  }
}

vtkSmartPointer<vtkPolyData> polyDataOf(const TriangleMesh& mesh, const Eigen::VectorXd& values) {
  auto data = vtkSmartPointer<vtkPolyData>::New();
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  for (Eigen::Index v = 0; v < mesh.vertexCount(); ++v) {
    points->InsertNextPoint(mesh.positions(v, 0), mesh.positions(v, 1), mesh.positions(v, 2));
  }
  vtkNew<vtkCellArray> cells;
  for (Eigen::Index f = 0; f < mesh.faceCount(); ++f) {
    const vtkIdType corners[] = {mesh.faces(f, 0), mesh.faces(f, 1), mesh.faces(f, 2)};
    cells->InsertNextCell(3, corners);
  }
  vtkNew<vtkFloatArray> scalars;
  scalars->SetName("some values");
  for (const double value : values) scalars->InsertNextValue(static_cast<float>(value));
  data->SetPoints(points);
  data->SetPolys(cells);
  data->GetPointData()->SetScalars(scalars);
  return data;
}

void expectSame(vtkPolyData* data, const TriangleMesh& mesh, double bound, const char* what) {
  ASSERT_EQ(data->GetNumberOfPoints(), mesh.vertexCount()) << what;
  ASSERT_EQ(data->GetNumberOfPolys(), mesh.faceCount()) << what;
  for (Eigen::Index v = 0; v < mesh.vertexCount(); ++v) {
    for (int c = 0; c < 3; ++c) {
      ASSERT_NEAR(data->GetPoint(v)[c], mesh.positions(v, c), bound) << what;
    }
  }
  for (Eigen::Index f = 0; f < mesh.faceCount(); ++f) {
    for (int k = 0; k < 3; ++k) {
      ASSERT_EQ(data->GetCell(f)->GetPointId(k), mesh.faces(f, k)) << what;
    }
  }
}

TEST(Vtk, ReadsOurSurfacesAndTheirMaps) {
  const TemporaryFolder folder;
  const TriangleMesh mesh = geometry::makeIcosphere(2, 3.7, Point(1, 2, 3));
  const Eigen::VectorXd perVertex = Eigen::VectorXd::LinSpaced(mesh.vertexCount(), 0, 1);
  Eigen::VectorXd perFace = Eigen::VectorXd::LinSpaced(mesh.faceCount(), 5, 6);
  perFace[3] = std::nan("");
  io::writeVtp(folder / "a.vtp", mesh, {{"depth <mm>", "mm", perVertex}}, {{"flux", "", perFace}});
  vtkNew<vtkXMLPolyDataReader> reader;
  reader->SetFileName((folder / "a.vtp").c_str());
  reader->Update();
  expectSame(reader->GetOutput(), mesh, 0, "vtp");
  vtkDataArray* depth = reader->GetOutput()->GetPointData()->GetArray("depth <mm>");
  ASSERT_NE(depth, nullptr);
  EXPECT_EQ(depth->GetTuple1(17), perVertex[17]);
  vtkDataArray* flux = reader->GetOutput()->GetCellData()->GetArray("flux");
  ASSERT_NE(flux, nullptr);
  EXPECT_EQ(flux->GetTuple1(4), perFace[4]);
  EXPECT_TRUE(std::isnan(flux->GetTuple1(3)));
  vtkDataArray* ras = reader->GetOutput()->GetFieldData()->GetArray("SpaceRAS");
  ASSERT_NE(ras, nullptr);
  EXPECT_EQ(ras->GetTuple1(0), 1);

  io::writeSurface(folder / "a.ply", mesh);
  vtkNew<vtkPLYReader> ply;
  ply->SetFileName((folder / "a.ply").c_str());
  ply->Update();
  expectSame(ply->GetOutput(), mesh, 1e-6, "ply");
  io::writeSurface(folder / "a.obj", mesh);
  vtkNew<vtkOBJReader> obj;
  obj->SetFileName((folder / "a.obj").c_str());
  obj->Update();
  expectSame(obj->GetOutput(), mesh, 1e-6, "obj");
  io::writeSurface(folder / "a.stl", mesh);
  vtkNew<vtkSTLReader> stl;
  stl->SetFileName((folder / "a.stl").c_str());
  stl->Update();
  EXPECT_EQ(stl->GetOutput()->GetNumberOfPolys(), mesh.faceCount());
  EXPECT_EQ(stl->GetOutput()->GetNumberOfPoints(), mesh.vertexCount());
}

TEST(Vtk, ReadsOurGridsAndPolygons) {
  const TemporaryFolder folder;
  Positions points(8, 3);
  points << 0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 0, 0, 1, 1, 0, 1, 1, 1, 1, 0, 1, 1;
  io::Cells box{io::CellKind::Hexahedron, {}};
  box.vertices.resize(1, 8);
  box.vertices << 0, 1, 2, 3, 4, 5, 6, 7;
  io::Cells edges{io::CellKind::Line, {}};
  edges.vertices.resize(2, 2);
  edges.vertices << 0, 6, 1, 7;
  io::writeVtu(folder / "a.vtu", points, {box, edges}, {{"depth", "", points.col(2)}},
               {{"layer", "", Eigen::Vector3d(1, 2, 3)}});
  vtkNew<vtkXMLUnstructuredGridReader> reader;
  reader->SetFileName((folder / "a.vtu").c_str());
  reader->Update();
  ASSERT_EQ(reader->GetOutput()->GetNumberOfCells(), 3);
  EXPECT_EQ(reader->GetOutput()->GetCellType(0), VTK_HEXAHEDRON);
  EXPECT_EQ(reader->GetOutput()->GetCellType(2), VTK_LINE);
  EXPECT_EQ(reader->GetOutput()->GetCell(2)->GetPointId(1), 7);
  EXPECT_EQ(reader->GetOutput()->GetCellData()->GetArray("layer")->GetTuple1(1), 2);

  Positions2 polygon(3, 2);
  polygon << 0, 0, 1, 0, 0.25, 1;
  io::writePolygonVtp(folder / "p.vtp", polygon, {}, {{"length", "", Eigen::Vector3d(1, 2, 3)}});
  vtkNew<vtkXMLPolyDataReader> lines;
  lines->SetFileName((folder / "p.vtp").c_str());
  lines->Update();
  EXPECT_EQ(lines->GetOutput()->GetNumberOfLines(), 3);
  EXPECT_EQ(lines->GetOutput()->GetCell(2)->GetPointId(1), 0);
}

TEST(Vtk, WritesSurfacesThatWeReadInEveryEncoding) {
  const TemporaryFolder folder;
  const TriangleMesh mesh = geometry::makeIcosphere(2, 3.7, Point(1, 2, 3));
  const Eigen::VectorXd values = Eigen::VectorXd::LinSpaced(mesh.vertexCount(), 0, 1);
  const vtkSmartPointer<vtkPolyData> data = polyDataOf(mesh, values);
  const auto check = [&](const char* name, double bound, bool maps) {
    const io::LoadedSurface read = io::readSurface(folder / name);
    ASSERT_EQ(read.mesh.faces, mesh.faces) << name;
    EXPECT_LE((read.mesh.positions - mesh.positions).cwiseAbs().maxCoeff(), bound) << name;
    if (!maps) return;
    ASSERT_EQ(read.maps.size(), 1U) << name;
    EXPECT_LT((read.maps[0].values - values).cwiseAbs().maxCoeff(), 1e-6) << name;
  };
  for (const int mode : {vtkXMLWriter::Ascii, vtkXMLWriter::Binary, vtkXMLWriter::Appended}) {
    for (const bool packed : {false, true}) {
      for (const bool wide : {false, true}) {
        for (const bool base64 : {false, true}) {
          vtkNew<vtkXMLPolyDataWriter> writer;
          writer->SetFileName((folder / "x.vtp").c_str());
          writer->SetInputData(data);
          writer->SetDataMode(mode);
          writer->SetEncodeAppendedData(base64);
          if (packed) {
            writer->SetCompressorTypeToZLib();
            writer->SetBlockSize(4096);  // several blocks an array
          } else {
            writer->SetCompressorTypeToNone();
          }
          wide ? writer->SetHeaderTypeToUInt64() : writer->SetHeaderTypeToUInt32();
          ASSERT_EQ(writer->Write(), 1);
          SCOPED_TRACE("mode " + std::to_string(mode) + (packed ? " packed" : "") +
                       (wide ? " wide" : "") + (base64 ? " base64" : ""));
          check("x.vtp", mode == vtkXMLWriter::Ascii ? 1e-9 : 0, true);
        }
      }
    }
  }
  for (const bool text : {false, true}) {
    for (const int version : {42, 51}) {
      vtkNew<vtkPolyDataWriter> writer;
      writer->SetFileName((folder / "x.vtk").c_str());
      writer->SetInputData(data);
      writer->SetFileVersion(version);
      text ? writer->SetFileTypeToASCII() : writer->SetFileTypeToBinary();
      ASSERT_EQ(writer->Write(), 1);
      SCOPED_TRACE(std::string(text ? "text" : "binary") + " version " + std::to_string(version));
      check("x.vtk", text ? 1e-4 : 0, true);
    }
    vtkNew<vtkPLYWriter> ply;
    ply->SetFileName((folder / "x.ply").c_str());
    ply->SetInputData(data);
    text ? ply->SetFileTypeToASCII() : ply->SetFileTypeToBinary();
    ASSERT_EQ(ply->Write(), 1);
    check("x.ply", 1e-4, false);
    vtkNew<vtkSTLWriter> stl;
    stl->SetFileName((folder / "x.stl").c_str());
    stl->SetInputData(data);
    text ? stl->SetFileTypeToASCII() : stl->SetFileTypeToBinary();
    ASSERT_EQ(stl->Write(), 1);
    EXPECT_EQ(io::readSurface(folder / "x.stl").mesh.vertexCount(), mesh.vertexCount());
  }
}

}  // namespace
