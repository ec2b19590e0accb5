// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <itkImageIOBase.h>
#include <itkObjectFactoryBase.h>

namespace explica::io {

/// FreeSurfer's MGH and MGZ for ITK, read and write.
///
/// Three-dimensional; the frames of a file are the components of a pixel.  Geometry is LPS here, as
/// ITK has it.  Types: uchar, short, ushort, int, float.
class MghImageIO : public itk::ImageIOBase {
 public:
  using Self = MghImageIO;
  using Superclass = itk::ImageIOBase;
  using Pointer = itk::SmartPointer<Self>;
  itkNewMacro(Self) itkTypeMacro(MghImageIO, ImageIOBase);

  bool CanReadFile(const char* name) override;
  void ReadImageInformation() override;
  void Read(void* buffer) override;
  bool CanWriteFile(const char* name) override;
  void WriteImageInformation() override {}
  void Write(const void* buffer) override;

 protected:
  MghImageIO();
};

/// Offers MghImageIO to ITK's readers and writers.
class MghImageIOFactory : public itk::ObjectFactoryBase {
 public:
  using Self = MghImageIOFactory;
  using Superclass = itk::ObjectFactoryBase;
  using Pointer = itk::SmartPointer<Self>;
  itkFactorylessNewMacro(Self) itkTypeMacro(MghImageIOFactory, ObjectFactoryBase);

  [[nodiscard]] const char* GetITKSourceVersion() const override;
  [[nodiscard]] const char* GetDescription() const override {
    return "FreeSurfer MGH and MGZ (Explica)";
  }

 protected:
  MghImageIOFactory();
};

}  // namespace explica::io
