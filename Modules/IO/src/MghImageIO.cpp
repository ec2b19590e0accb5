// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "MghImageIO.h"

#include "ByteSource.h"
#include "MghFormat.h"

#include "Explica/IO/ItkFormats.h"

#include <itkCreateObjectFunction.h>
#include <itkVersion.h>

namespace explica::io {
namespace {

struct TypeRow {
  itk::IOComponentEnum itk;
  StoredType stored;
};
constexpr TypeRow kTypes[] = {{itk::IOComponentEnum::UCHAR, StoredType::UInt8},
                              {itk::IOComponentEnum::SHORT, StoredType::Int16},
                              {itk::IOComponentEnum::USHORT, StoredType::UInt16},
                              {itk::IOComponentEnum::INT, StoredType::Int32},
                              {itk::IOComponentEnum::FLOAT, StoredType::Float32}};

bool endsLikeMgh(const std::string& name) {
  return name.ends_with(".mgh") || name.ends_with(".mgz") || name.ends_with(".mgh.gz");
}

Eigen::Matrix3d lpsOfRas() {
  return Vector(-1, -1, 1).asDiagonal();
}

}  // namespace

MghImageIO::MghImageIO() {
  SetNumberOfDimensions(3);
  for (const char* extension : {".mgh", ".mgz", ".mgh.gz"}) {
    AddSupportedReadExtension(extension);
    AddSupportedWriteExtension(extension);
  }
}

bool MghImageIO::CanReadFile(const char* name) {
  if (!endsLikeMgh(name)) return false;
  try {
    ByteSource source(name);
    return looksLikeMgh(source.peek(32));
  } catch (const Error&) {
    return false;
  }
}

void MghImageIO::ReadImageInformation() {
  ByteSource source(GetFileName());
  const StoredVolume volume = readMgh(source, Extent::Header);
  const Eigen::Matrix3d direction = lpsOfRas() * volume.grid.direction;
  const Point origin = lpsOfRas() * volume.grid.origin;
  SetNumberOfDimensions(3);
  for (unsigned axis = 0; axis < 3; ++axis) {
    SetDimensions(axis, static_cast<itk::SizeValueType>(volume.grid.size[axis]));
    SetSpacing(axis, volume.grid.spacing[axis]);
    SetOrigin(axis, origin[axis]);
    SetDirection(axis,
                 std::vector<double>{direction(0, axis), direction(1, axis), direction(2, axis)});
  }
  SetNumberOfComponents(static_cast<unsigned>(volume.valuesPerVoxel));
  SetPixelType(volume.valuesPerVoxel > 1 ? itk::IOPixelEnum::VECTOR : itk::IOPixelEnum::SCALAR);
  for (const TypeRow& row : kTypes) {
    if (row.stored == volume.type) SetComponentType(row.itk);
  }
  SetByteOrderToBigEndian();
}

void MghImageIO::Read(void* buffer) {
  ByteSource source(GetFileName());
  const StoredVolume volume = readMgh(source, Extent::Everything);
  const std::size_t width = widthOf(volume.type);
  const std::size_t voxels = volume.grid.voxelCount();
  const auto components = static_cast<std::size_t>(volume.valuesPerVoxel);
  auto* to = static_cast<std::uint8_t*>(buffer);
  for (std::size_t c = 0; c < components; ++c) {
    const std::uint8_t* frame = volume.values.data() + c * voxels * width;
    for (std::size_t v = 0; v < voxels; ++v) {
      std::memcpy(to + (v * components + c) * width, frame + v * width, width);
    }
  }
}

bool MghImageIO::CanWriteFile(const char* name) {
  return endsLikeMgh(name);
}

void MghImageIO::Write(const void* buffer) {
  VolumeToWrite volume;
  bool known = false;
  for (const TypeRow& row : kTypes) {
    if (row.itk != GetComponentType()) continue;
    volume.type = row.stored;
    known = true;
  }
  if (!known || GetNumberOfDimensions() < 2 || GetNumberOfDimensions() > 3) {
    itkExceptionMacro("MGH holds 3D images of uchar, short, ushort, int or float: "
                      << GetFileName() << " would be "
                      << GetComponentTypeAsString(GetComponentType()) << " in "
                      << GetNumberOfDimensions() << "D");
  }
  Eigen::Matrix3d direction = Eigen::Matrix3d::Identity();
  for (unsigned axis = 0; axis < GetNumberOfDimensions(); ++axis) {
    volume.grid.size[axis] = static_cast<int>(GetDimensions(axis));
    volume.grid.spacing[axis] = GetSpacing(axis);
    volume.grid.origin[axis] = GetOrigin(axis);
    const std::vector<double> column = GetDirection(axis);
    for (std::size_t row = 0; row < column.size() && row < 3; ++row)
      direction(row, axis) = column[row];
  }
  if (GetNumberOfDimensions() == 2) volume.grid.size[2] = 1;
  volume.grid.direction = lpsOfRas() * direction;
  volume.grid.origin = lpsOfRas() * volume.grid.origin;
  volume.valuesPerVoxel = static_cast<int>(GetNumberOfComponents());

  const std::size_t width = widthOf(volume.type);
  const std::size_t voxels = volume.grid.voxelCount();
  const auto components = static_cast<std::size_t>(volume.valuesPerVoxel);
  const auto* from = static_cast<const std::uint8_t*>(buffer);
  Content content;
  content.head = mghHeader(volume);
  content.tail = mghFooter();
  content.bodySize = voxels * components * width;
  content.body = [&](std::size_t begin, std::uint8_t* to, std::size_t count) {
    for (std::size_t i = 0; i < count / width; ++i) {
      const std::size_t at = begin / width + i;
      const std::size_t source = at % voxels * components + at / voxels;
      std::memcpy(to + i * width, from + source * width, width);
    }
    swapBytes(to, count / width, width);
  };
  const std::string name = GetFileName();
  WholeFile file(name);
  if (name.ends_with(".mgh")) {
    writePlain(file, content);
  } else {
    writeGzip(file, content);
  }
  file.commit();
}

MghImageIOFactory::MghImageIOFactory() {
  RegisterOverride("itkImageIOBase", "explicaMghImageIO", "FreeSurfer MGH and MGZ", true,
                   itk::CreateObjectFunction<MghImageIO>::New());
}

const char* MghImageIOFactory::GetITKSourceVersion() const {
  return ITK_SOURCE_VERSION;
}

void registerMghWithItk() {
  static const bool registered = [] {
    itk::ObjectFactoryBase::RegisterFactory(MghImageIOFactory::New());
    return true;
  }();
  static_cast<void>(registered);
}

}  // namespace explica::io
