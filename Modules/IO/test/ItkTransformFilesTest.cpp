// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
// Transforms as ITK (and so ANTs and fMRIPrep) writes them, against ITK's own idea of them.

#include "Explica/Core/Errors.h"
#include "Explica/IO/PointTransformFile.h"
#include "Explica/IO/TransformFile.h"
#include "TemporaryFolder.h"

#include <gtest/gtest.h>

#include <itkAffineTransform.h>
#include <itkCompositeTransform.h>
#include <itkDisplacementFieldTransform.h>
#include <itkEuler3DTransform.h>
#include <itkHDF5TransformIOFactory.h>
#include <itkMatlabTransformIOFactory.h>
#include <itkTransformFactoryBase.h>
#include <itkTransformFileReader.h>
#include <itkTransformFileWriter.h>
#include <itkTxtTransformIOFactory.h>

#include <cmath>
#include <fstream>
#include <iterator>

namespace explica::io {
namespace {

using Affine = itk::AffineTransform<double, 3>;
using Composite = itk::CompositeTransform<double, 3>;
using Warp = itk::DisplacementFieldTransform<double, 3>;
using Transform = itk::Transform<double, 3, 3>;

class ItkTransformFiles : public ::testing::Test {
 protected:
  void SetUp() override {
    itk::TransformFactoryBase::RegisterDefaultTransforms();
    itk::HDF5TransformIOFactory::RegisterOneFactory();
    itk::MatlabTransformIOFactory::RegisterOneFactory();
    itk::TxtTransformIOFactory::RegisterOneFactory();
    sides_.volume.size = {40, 40, 40};
  }

  /// As antsRegistration writes it: about a centre of its own.
  static Affine::Pointer affine() {
    const auto transform = Affine::New();
    Affine::CenterType centre;
    centre[0] = 12;
    centre[1] = -30;
    centre[2] = 7;
    transform->SetCenter(centre);
    Affine::OutputVectorType axis;
    axis[0] = 1;
    axis[1] = 2;
    axis[2] = -1;
    transform->Rotate3D(axis, 0.3);
    transform->Scale(1.1);
    Affine::OutputVectorType move;
    move[0] = 5;
    move[1] = -7;
    move[2] = 11;
    transform->Translate(move);
    return transform;
  }

  /// A smooth displacement of some millimetres on an anisotropic lattice.
  static Warp::Pointer warp() {
    const auto field = Warp::DisplacementFieldType::New();
    field->SetRegions(Warp::DisplacementFieldType::SizeType{{30, 28, 26}});
    field->SetSpacing(std::array<double, 3>{4, 5, 6}.data());
    field->SetOrigin(std::array<double, 3>{-60, -70, -75}.data());
    field->Allocate();
    itk::ImageRegionIteratorWithIndex<Warp::DisplacementFieldType> at(
        field, field->GetLargestPossibleRegion());
    for (; !at.IsAtEnd(); ++at) {
      const auto index = at.GetIndex();
      Warp::DisplacementFieldType::PixelType move;
      for (int axis = 0; axis < 3; ++axis) {
        move[axis] = (axis + 1) * std::sin(0.2 * index[axis] + 0.1 * index[(axis + 1) % 3]);
      }
      at.Set(move);
    }
    const auto transform = Warp::New();
    transform->SetDisplacementField(field);
    return transform;
  }

  static void write(const itk::Object* transform, const std::filesystem::path& path) {
    const auto writer = itk::TransformFileWriterTemplate<double>::New();
    writer->SetInput(transform);
    writer->SetFileName(path.string());
    writer->Update();
  }

  /// What ITK itself makes of a file.
  static Transform::Pointer readByItk(const std::filesystem::path& path) {
    const auto reader = itk::TransformFileReaderTemplate<double>::New();
    reader->SetFileName(path.string());
    reader->Update();
    return dynamic_cast<Transform*>(reader->GetTransformList()->front().GetPointer());
  }

  static std::string bytesOf(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
  }

  /// The file takes points where ITK's object does, LPS on both sides.
  void expectMapsAs(const std::filesystem::path& path, const Transform& truth) {
    const PointTransform read = readPointTransform(path, sides_);
    for (const Point& ras : {Point(10, 20, 30), Point(-33, 12, -8), Point(0, 0, 0)}) {
      Transform::InputPointType lps;
      lps[0] = -ras[0];
      lps[1] = -ras[1];
      lps[2] = ras[2];
      const auto there = truth.TransformPoint(lps);
      EXPECT_LT((read.map(ras) - Point(-there[0], -there[1], there[2])).norm(), 1e-6)
          << path << " at " << ras.transpose();
    }
  }

  const TemporaryFolder folder_;
  TransformSides sides_;
};

TEST_F(ItkTransformFiles, AffineInMatTextAndHdf5) {
  const auto transform = affine();
  for (const char* name : {"0GenericAffine.mat", "affine.txt", "affine.h5"}) {
    write(transform, folder_ / name);
    expectMapsAs(folder_ / name, *transform);
  }
}

TEST_F(ItkTransformFiles, InverseOfAnAffineTakesPointsBack) {
  const auto transform = affine();
  write(transform, folder_ / "0GenericAffine.mat");
  sides_.sense = TransformSense::Inverse;
  expectMapsAs(folder_ / "0GenericAffine.mat", *transform->GetInverseTransform());
}

TEST_F(ItkTransformFiles, CompositeAppliesTheLastOfItsTransformsFirst) {
  const auto rigid = itk::Euler3DTransform<double>::New();
  rigid->SetRotation(0.2, -0.1, 0.3);
  const auto composite = Composite::New();
  composite->AddTransform(rigid);
  composite->AddTransform(affine());
  composite->AddTransform(warp());
  write(composite, folder_ / "Composite.h5");
  expectMapsAs(folder_ / "Composite.h5", *composite);
  // The order matters here: the other one leads elsewhere.
  const auto turned = Composite::New();
  turned->AddTransform(warp());
  turned->AddTransform(affine());
  turned->AddTransform(rigid);
  Transform::InputPointType point;
  point.Fill(10);
  EXPECT_GT((composite->TransformPoint(point) - turned->TransformPoint(point)).GetNorm(), 1);
}

TEST_F(ItkTransformFiles, AWarpHasNoInverseAndThatIsSaid) {
  const auto composite = Composite::New();
  composite->AddTransform(affine());
  composite->AddTransform(warp());
  write(composite, folder_ / "Composite.h5");
  sides_.sense = TransformSense::Inverse;
  const std::string complaint = complaintOf<InvalidInput>(
      [&] { static_cast<void>(readPointTransform(folder_ / "Composite.h5", sides_)); });
  EXPECT_NE(complaint.find("InverseComposite"), std::string::npos) << complaint;
}

TEST_F(ItkTransformFiles, ARegistrationIsReadBackNumberForNumber) {
  Eigen::Affine3d affine(Eigen::AngleAxisd(0.3, Vector(1, 2, -1).normalized()));
  affine.linear() *= 1.07;
  affine.translation() = Vector(3.25, -7.1, 11.3);
  Grid grid;
  grid.size = {5, 4, 3};
  grid.spacing = {2, 2.1, 1.9};
  grid.direction = Eigen::AngleAxisd(0.4, Vector(0.2, -1, 0.5).normalized()).toRotationMatrix();
  grid.origin = {-20.3, 14.7, 9.1};
  Volume<Eigen::Vector3f> field(grid, Eigen::Vector3f::Zero());
  for (std::size_t v = 0; v < field.size(); ++v) {
    const auto x = static_cast<float>(v);
    field[v] = {std::sin(x), 0.3F * std::cos(x), 0.01F * x};
  }
  writeTransform(folder_ / "to_template.h5", affine, field);
  const StoredTransform read = readTransform(folder_ / "to_template.h5");
  EXPECT_EQ(read.affine.matrix(), affine.matrix());
  EXPECT_EQ(read.displacement.data, field.data);
  EXPECT_EQ(read.displacement.grid.size, grid.size);
  EXPECT_EQ(read.displacement.grid.spacing, grid.spacing);
  EXPECT_EQ(read.displacement.grid.origin, grid.origin);
  EXPECT_EQ(read.displacement.grid.direction, grid.direction);
  expectMapsAs(folder_ / "to_template.h5", *readByItk(folder_ / "to_template.h5"));
  writeTransform(folder_ / "again.h5", affine, field);
  EXPECT_EQ(bytesOf(folder_ / "again.h5"), bytesOf(folder_ / "to_template.h5"));
  writeTransform(folder_ / "affine.h5", affine, {});
  EXPECT_EQ(readTransform(folder_ / "affine.h5").affine.matrix(), affine.matrix());
  EXPECT_EQ(readTransform(folder_ / "affine.h5").displacement.size(), 0U);
}

TEST_F(ItkTransformFiles, ARegistrationOfAntsHasACentreOfItsOwn) {
  const auto composite = Composite::New();
  composite->AddTransform(affine());
  composite->AddTransform(warp());
  write(composite, folder_ / "Composite.h5");
  const StoredTransform read = readTransform(folder_ / "Composite.h5");
  // At a place of the lattice, where nothing is interpolated.
  const Point ras = read.displacement.grid.toWorld(Vector(10, 11, 12));
  Transform::InputPointType lps;
  lps[0] = -ras[0];
  lps[1] = -ras[1];
  lps[2] = ras[2];
  const auto there = composite->TransformPoint(lps);
  const Point found = read.affine * (ras + read.displacement(10, 11, 12).cast<double>());
  EXPECT_LT((found - Point(-there[0], -there[1], there[2])).norm(), 1e-5);
}

TEST_F(ItkTransformFiles, WhatIsNoRegistrationIsRefused) {
  const auto complaintAbout = [&](const auto& parts) {
    const auto composite = Composite::New();
    for (const auto& part : parts) composite->AddTransform(part);
    write(composite, folder_ / "other.h5");
    return complaintOf<InvalidInput>(
        [&] { static_cast<void>(readTransform(folder_ / "other.h5")); });
  };
  using Parts = std::vector<Transform::Pointer>;
  const auto a = [] { return Transform::Pointer(affine().GetPointer()); };
  const auto w = [] { return Transform::Pointer(warp().GetPointer()); };
  for (const Parts& parts : {Parts{w()}, Parts{w(), a()}, Parts{a(), a()}, Parts{a(), w(), w()}}) {
    EXPECT_NE(complaintAbout(parts).find("is not an affine transform after at most one"),
              std::string::npos);
  }
  const auto flat = Affine::New();
  flat->Scale(std::array<double, 3>{1, 1, 0}.data());
  EXPECT_NE(complaintAbout(Parts{Transform::Pointer(flat.GetPointer())}).find("cannot be inverted"),
            std::string::npos);
}

}  // namespace
}  // namespace explica::io
