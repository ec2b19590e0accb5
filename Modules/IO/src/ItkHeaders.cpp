// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "ItkHeaders.h"

#include <array>

namespace explica::io {
namespace {

std::string joined(const std::array<double, 3>& values, char separator) {
  std::string text;
  for (const double value : values) {
    if (!text.empty()) text += separator;
    appendNumber(text, value);
  }
  return text;
}

std::array<double, 3> components(const Vector& v) {
  return {v[0], v[1], v[2]};
}

Bytes bytesOf(const std::string& text) {
  return Bytes(text.begin(), text.end());
}

const char* nrrdNameOf(StoredType type) {
  switch (type) {
    case StoredType::UInt8:
      return "uint8";
    case StoredType::Int16:
      return "int16";
    case StoredType::Int32:
      return "int32";
    default:
      return "float";
  }
}

}  // namespace

Bytes nrrdHeader(const VolumeToWrite& volume) {
  const Grid& grid = volume.grid;
  const bool vectors = volume.valuesPerVoxel > 1;
  std::string text = "NRRD0004\n# written by Explica\ntype: ";
  text += nrrdNameOf(volume.type);
  text += vectors ? "\ndimension: 4" : "\ndimension: 3";
  text += "\nspace: right-anterior-superior\nsizes:";
  if (vectors) text += " " + std::to_string(volume.valuesPerVoxel);
  for (const int n : grid.size) text += " " + std::to_string(n);
  text += "\nspace directions:";
  if (vectors) text += " none";
  for (int axis = 0; axis < 3; ++axis) {
    const Vector column = grid.direction.col(axis) * grid.spacing[axis];
    text += " (" + joined(components(column), ',') + ")";
  }
  text += vectors ? "\nkinds: vector domain domain domain" : "\nkinds: domain domain domain";
  text += "\nendian: little\nencoding: gzip\nspace origin: (" +
          joined(components(grid.origin), ',') + ")\n\n";
  return bytesOf(text);
}

namespace {

const char* metaNameOf(StoredType type) {
  switch (type) {
    case StoredType::UInt8:
      return "MET_UCHAR";
    case StoredType::Int16:
      return "MET_SHORT";
    case StoredType::Int32:
      return "MET_INT";
    default:
      return "MET_FLOAT";
  }
}

}  // namespace

Bytes metaHeader(const VolumeToWrite& volume) {
  const Grid& grid = volume.grid;
  const Eigen::Matrix3d lps = Vector(-1, -1, 1).asDiagonal();
  std::string text =
      "ObjectType = Image\nNDims = 3\nBinaryData = True\nBinaryDataByteOrderMSB = False\n"
      "CompressedData = False\nTransformMatrix =";
  for (int axis = 0; axis < 3; ++axis) {
    text += " " + joined(components(lps * grid.direction.col(axis)), ' ');
  }
  text += "\nOffset = " + joined(components(lps * grid.origin), ' ');
  text += "\nCenterOfRotation = 0 0 0\nAnatomicalOrientation = ";
  for (int axis = 0; axis < 3; ++axis) {  // the letters from which an axis runs
    int along = 0;
    grid.direction.col(axis).cwiseAbs().maxCoeff(&along);
    text += grid.direction(along, axis) > 0 ? "LPI"[along] : "RAS"[along];
  }
  text += "\nElementSpacing = " + joined(components(grid.spacing), ' ') + "\nDimSize =";
  for (const int n : grid.size) text += " " + std::to_string(n);
  if (volume.valuesPerVoxel > 1) {
    text += "\nElementNumberOfChannels = " + std::to_string(volume.valuesPerVoxel);
  }
  text += std::string("\nElementType = ") + metaNameOf(volume.type) + "\nElementDataFile = LOCAL\n";
  return bytesOf(text);
}

}  // namespace explica::io
