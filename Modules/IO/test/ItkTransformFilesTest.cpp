// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
// Transforms as ITK (and so ANTs and fMRIPrep) writes them, against ITK's own idea of them.

#include "Explica/Core/Errors.h"
#include "Explica/IO/PointTransformFile.h"
#include "TemporaryFolder.h"

#include <gtest/gtest.h>

#include <itkAffineTransform.h>
#include <itkCompositeTransform.h>
#include <itkDisplacementFieldTransform.h>
#include <itkEuler3DTransform.h>
#include <itkHDF5TransformIOFactory.h>
#include <itkMatlabTransformIOFactory.h>
#include <itkTransformFactoryBase.h>
#include <itkTransformFileWriter.h>
#include <itkTxtTransformIOFactory.h>

#include <cmath>

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

}  // namespace
}  // namespace explica::io
