// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "ItkTransform.h"

#include "Bytes.h"

#include <itkCompositeTransform.h>
#include <itkHDF5TransformIOFactory.h>
#include <itkMatlabTransformIOFactory.h>
#include <itkTransformFactoryBase.h>
#include <itkTransformFileReader.h>
#include <itkTxtTransformIOFactory.h>

#include <hdf5.h>

#include <mutex>

namespace explica::io {
namespace {

using Composite = itk::CompositeTransform<double, 3>;
using Transform = itk::Transform<double, 3, 3>;

void registerFactories() {
  static std::once_flag once;
  std::call_once(once, [] {
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);  // it tells faults on standard error otherwise
    itk::TransformFactoryBase::RegisterDefaultTransforms();
    itk::ObjectFactoryBase::RegisterFactory(itk::HDF5TransformIOFactory::New());
    itk::ObjectFactoryBase::RegisterFactory(itk::MatlabTransformIOFactory::New());
    itk::ObjectFactoryBase::RegisterFactory(itk::TxtTransformIOFactory::New());
  });
}

Transform::Pointer compositeOf(const std::filesystem::path& path) {
  const auto reader = itk::TransformFileReaderTemplate<double>::New();
  reader->SetFileName(path.string());
  reader->Update();
  const auto& list = *reader->GetTransformList();
  const Composite::Pointer composite = Composite::New();
  for (const auto& entry : list) {
    auto* transform = dynamic_cast<Transform*>(entry.GetPointer());
    if (transform == nullptr) refuse(path, "holds a transform that is not of three dimensions");
    composite->AddTransform(transform);
  }
  if (list.empty()) refuse(path, "holds no transform");
  return composite.GetPointer();
}

}  // namespace

std::function<Point(const Point&)> readItkTransform(const std::filesystem::path& path,
                                                    bool inverse) {
  registerFactories();
  Transform::Pointer transform;
  try {
    transform = compositeOf(path);
  } catch (const itk::ExceptionObject& error) {
    const std::string cause = error.GetDescription();
    failToRead(path, "ITK cannot read this transform: " + cause.substr(0, cause.find('\n')));
  }
  if (inverse) {
    const auto inverted = transform->GetInverseTransform();
    if (inverted.IsNull()) {
      refuse(path,
             "has no inverse; give the transform of the other direction, which ANTs writes as "
             "InverseComposite or InverseWarp");
    }
    transform = dynamic_cast<Transform*>(inverted.GetPointer());
  }
  return [transform](const Point& ras) -> Point {
    Transform::InputPointType lps;
    lps[0] = -ras[0];
    lps[1] = -ras[1];
    lps[2] = ras[2];
    const auto there = transform->TransformPoint(lps);
    return {-there[0], -there[1], there[2]};
  };
}

}  // namespace explica::io
