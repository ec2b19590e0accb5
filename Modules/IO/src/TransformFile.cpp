// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/IO/TransformFile.h"

#include "Explica/Core/Errors.h"

#include <itkAffineTransform.h>
#include <itkCompositeTransform.h>
#include <itkDisplacementFieldTransform.h>
#include <itkHDF5TransformIO.h>
#include <itkTransformFileWriter.h>

namespace explica::io {
namespace {

/// RAS to LPS and back.
const Eigen::Vector3d kTurned(-1, -1, 1);

itk::AffineTransform<double, 3>::Pointer affineInLps(const Eigen::Affine3d& affine) {
  auto result = itk::AffineTransform<double, 3>::New();
  itk::AffineTransform<double, 3>::MatrixType matrix;
  itk::AffineTransform<double, 3>::OutputVectorType offset;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) {
      matrix(row, column) = kTurned[row] * affine.linear()(row, column) * kTurned[column];
    }
    offset[row] = kTurned[row] * affine.translation()[row];
  }
  result->SetMatrix(matrix);
  result->SetOffset(offset);
  return result;
}

itk::DisplacementFieldTransform<double, 3>::Pointer fieldInLps(
    const Volume<Eigen::Vector3f>& displacement) {
  using Transform = itk::DisplacementFieldTransform<double, 3>;
  using Field = Transform::DisplacementFieldType;
  const Grid& grid = displacement.grid;
  auto field = Field::New();
  Field::RegionType region;
  Field::SpacingType spacing;
  Field::PointType origin;
  Field::DirectionType direction;
  for (int a = 0; a < 3; ++a) {
    region.SetSize(a, static_cast<itk::SizeValueType>(grid.size[a]));
    spacing[a] = grid.spacing[a];
    origin[a] = kTurned[a] * grid.origin[a];
    for (int b = 0; b < 3; ++b) direction(a, b) = kTurned[a] * grid.direction(a, b);
  }
  field->SetRegions(region);
  field->SetSpacing(spacing);
  field->SetOrigin(origin);
  field->SetDirection(direction);
  field->Allocate();
  auto* voxel = field->GetBufferPointer();
  for (std::size_t v = 0; v < displacement.size(); ++v) {
    for (int a = 0; a < 3; ++a) voxel[v][a] = kTurned[a] * displacement[v][a];
  }
  auto result = Transform::New();
  result->SetDisplacementField(field);
  return result;
}

}  // namespace

void writeTransform(const std::filesystem::path& path, const Eigen::Affine3d& affine,
                    const Volume<Eigen::Vector3f>& displacement) {
  try {
    // The transform that is added last is applied first.
    auto composite = itk::CompositeTransform<double, 3>::New();
    composite->AddTransform(affineInLps(affine));
    if (displacement.size() != 0) composite->AddTransform(fieldInLps(displacement));
    auto writer = itk::TransformFileWriterTemplate<double>::New();
    writer->SetTransformIO(itk::HDF5TransformIOTemplate<double>::New());
    writer->SetUseCompression(true);
    writer->SetFileName(path.string());
    writer->SetInput(composite);
    writer->Update();
  } catch (const itk::ExceptionObject& fault) {
    throw EnvironmentError(path.string() + ": cannot be written: " + fault.GetDescription());
  }
}

}  // namespace explica::io
