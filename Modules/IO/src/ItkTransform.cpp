// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "ItkTransform.h"

#include "ByteSource.h"
#include "Hdf5Transform.h"
#include "MeshBuilder.h"

#include "Explica/IO/TransformFile.h"

#include <itkAffineTransform.h>
#include <itkCompositeTransform.h>
#include <itkDisplacementFieldTransform.h>
#include <itkTransformFactoryBase.h>

#include <cmath>
#include <mutex>

namespace explica::io {
namespace {

using Path = std::filesystem::path;
using Composite = itk::CompositeTransform<double, 3>;
using Linear = itk::MatrixOffsetTransformBase<double, 3, 3>;
using Warp = itk::DisplacementFieldTransform<double, 3>;
using Transform = itk::Transform<double, 3, 3>;

void add(const Path& path, std::vector<TransformEntry>& entries, TransformEntry entry) {
  if (entries.size() == kMostTransforms) {
    refuse(path, "holds more than " + std::to_string(kMostTransforms) + " transforms");
  }
  entries.push_back(std::move(entry));
}

/// `Transform:`, `Parameters:` and `FixedParameters:`, a line each.
std::vector<TransformEntry> entriesOfText(const Path& path, ByteView bytes) {
  std::vector<TransformEntry> entries;
  ByteCursor lines(path, bytes, false);
  while (lines.left() > 0) {
    const std::string_view line = lines.line();
    ByteCursor words(path, line);
    const std::string_view key = words.word();
    if (key == "Transform:") {
      add(path, entries, {std::string(words.word()), {}, {}});
    } else if (key == "Parameters:" || key == "FixedParameters:") {
      if (entries.empty()) failToRead(path, "has parameters before any transform");
      std::vector<double>& to =
          key == "Parameters:" ? entries.back().parameters : entries.back().fixed;
      for (std::string_view word = words.word(); !word.empty(); word = words.word()) {
        to.push_back(parseNumber<double>(path, word));
      }
    }
  }
  return entries;
}

/// Matrices of Matlab's level 4, two for each transform: one of its type's name, one called
/// "fixed".
std::vector<TransformEntry> entriesOfMatlab(const Path& path, ByteView bytes) {
  std::vector<TransformEntry> entries;
  ByteCursor cursor(path, bytes, false);
  while (cursor.left() > 0) {
    constexpr std::int32_t kDouble = 0, kFloat = 10;  // little-endian, full
    const auto type = cursor.take<std::int32_t>();
    if (type != kDouble && type != kFloat) {
      failToRead(path, "is not a transform as ITK writes it (a matrix of the type " +
                           std::to_string(type) + ")");
    }
    const std::size_t width = type == kDouble ? 8 : 4;
    const std::size_t rows =
        checkedCount(path, cursor.take<std::int32_t>(), cursor.left(), width, "rows");
    const std::size_t columns = checkedCount(path, cursor.take<std::int32_t>(), cursor.left(),
                                             width * std::max<std::size_t>(rows, 1), "columns");
    static_cast<void>(cursor.take<std::int32_t>());  // whether there is an imaginary part
    const ByteView name = cursor.view(
        checkedCount(path, cursor.take<std::int32_t>(), cursor.left(), 1, "characters"));
    std::string word(name.begin(), name.end());
    word.resize(std::min(word.find('\0'), word.size()));
    std::vector<double> values;
    values.reserve(rows * columns);
    for (std::size_t n = 0; n < rows * columns; ++n) {
      values.push_back(type == kDouble ? cursor.take<double>() : cursor.take<float>());
    }
    if (word != "fixed") {
      add(path, entries, {word, std::move(values), {}});
    } else if (!entries.empty()) {
      entries.back().fixed = std::move(values);
    }
  }
  return entries;
}

/// Refuses numbers that ITK would take memory for, or divide by, before it asks.
void checkLattice(const Path& path, const TransformEntry& entry) {
  constexpr std::size_t kFixed = 18;  // size, origin, spacing and direction of a lattice
  if (entry.fixed.size() != kFixed) {
    failToRead(path, "has a lattice of " + std::to_string(entry.fixed.size()) +
                         " numbers; those of three dimensions have 18");
  }
  std::vector<std::int64_t> size;
  for (int axis = 0; axis < 3; ++axis) {
    constexpr double kMostAlong = 1e6;  // places along an axis of a lattice
    const double n = entry.fixed[axis];
    if (!(n >= 1 && n <= kMostAlong && n == std::trunc(n))) {
      failToRead(path, "has a lattice of no whole number of places");
    }
    if (!(entry.fixed[6 + axis] > 0)) failToRead(path, "has a lattice without spacing");
    size.push_back(static_cast<std::int64_t>(n));
  }
  if (3 * checkedProduct(path, size) != static_cast<std::int64_t>(entry.parameters.size())) {
    failTruncated(path, "its lattice has not three numbers a place");
  }
}

Transform::Pointer transformOf(const Path& path, TransformEntry entry) {
  constexpr double kLargest = 1e9;  // mm or of a matrix; beyond it sums lose their digits
  for (const std::vector<double>* numbers : {&entry.parameters, &entry.fixed}) {
    for (const double number : *numbers) {
      if (!(std::abs(number) <= kLargest)) {
        refuse(path, "has a number that is not finite, or too large for a transform in mm");
      }
    }
  }
  const std::string given = entry.type;
  if (const auto at = entry.type.find("_float_"); at != std::string::npos) {
    entry.type.replace(at, 7, "_double_");
  }
  if (!entry.type.ends_with("_double_3_3")) {
    refuse(path, "holds '" + given.substr(0, 60) + "', which is no transform of three dimensions");
  }
  const auto made = itk::ObjectFactoryBase::CreateInstance(entry.type.c_str());
  if (made.IsNotNull()) made->UnRegister();  // CreateInstance counts a reference too many
  auto* transform = dynamic_cast<Transform*>(made.GetPointer());
  if (transform == nullptr) {
    refuse(path, "holds '" + given.substr(0, 60) + "', which ITK does not know");
  }
  if (entry.type.find("Field") != std::string::npos ||
      entry.type.find("BSpline") != std::string::npos) {
    checkLattice(path, entry);
  } else if (entry.parameters.size() != transform->GetNumberOfParameters() ||
             entry.fixed.size() != transform->GetNumberOfFixedParameters()) {
    failToRead(path, "has " + std::to_string(entry.parameters.size()) + " and " +
                         std::to_string(entry.fixed.size()) + " parameters for " + given + "; " +
                         std::to_string(transform->GetNumberOfParameters()) + " and " +
                         std::to_string(transform->GetNumberOfFixedParameters()) + " are needed");
  }
  Transform::FixedParametersType fixed(entry.fixed.size());
  std::ranges::copy(entry.fixed, fixed.begin());
  Transform::ParametersType parameters;  // ITK takes a copy
  parameters.SetData(entry.parameters.data(), entry.parameters.size());
  transform->SetFixedParameters(fixed);
  transform->SetParametersByValue(parameters);
  return transform;
}

std::vector<TransformEntry> entriesOf(const Path& path) {
  const Bytes bytes = ByteSource(path).rest();
  const std::string_view text = textOf(bytes);
  if (looksLikeHdf5(bytes)) return readHdf5Transform(path, bytes);
  if (text.starts_with("#Insight")) return entriesOfText(path, bytes);
  return entriesOfMatlab(path, bytes);
}

Composite::Pointer compositeOf(const Path& path) {
  static std::once_flag once;
  std::call_once(once, [] { itk::TransformFactoryBase::RegisterDefaultTransforms(); });
  const Composite::Pointer composite = Composite::New();
  std::vector<TransformEntry> entries = entriesOf(path);
  for (TransformEntry& entry : entries) {
    if (entry.type.starts_with("CompositeTransform")) continue;  // of those that follow
    composite->AddTransform(transformOf(path, std::move(entry)));
  }
  if (composite->GetNumberOfTransforms() == 0) refuse(path, "holds no transform");
  return composite;
}

/// RAS to LPS and back.
const Eigen::Vector3d kTurned(-1, -1, 1);

TransformEntry affineInLps(const Eigen::Affine3d& affine) {
  TransformEntry entry{"AffineTransform_double_3_3", {}, {0, 0, 0}};  // fixed: its centre
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) {
      entry.parameters.push_back(kTurned[row] * affine.linear()(row, column) * kTurned[column]);
    }
  }
  for (int row = 0; row < 3; ++row) {
    entry.parameters.push_back(kTurned[row] * affine.translation()[row]);
  }
  return entry;
}

/// Fixed parameters are the lattice's size, origin, spacing and direction (by rows).
TransformEntry fieldInLps(const Volume<Eigen::Vector3f>& displacement) {
  const Grid& grid = displacement.grid;
  TransformEntry entry{"DisplacementFieldTransform_double_3_3", {}, {}};
  for (int a = 0; a < 3; ++a) entry.fixed.push_back(grid.size[a]);
  for (int a = 0; a < 3; ++a) entry.fixed.push_back(kTurned[a] * grid.origin[a]);
  for (int a = 0; a < 3; ++a) entry.fixed.push_back(grid.spacing[a]);
  for (int a = 0; a < 3; ++a) {
    for (int b = 0; b < 3; ++b) entry.fixed.push_back(kTurned[a] * grid.direction(a, b));
  }
  entry.parameters.reserve(3 * displacement.size());
  for (std::size_t v = 0; v < displacement.size(); ++v) {
    for (int a = 0; a < 3; ++a) entry.parameters.push_back(kTurned[a] * displacement[v][a]);
  }
  return entry;
}

Eigen::Affine3d affineInRas(const Path& path, const Linear& lps) {
  Eigen::Affine3d affine;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) {
      affine.linear()(row, column) = kTurned[row] * lps.GetMatrix()(row, column) * kTurned[column];
    }
    affine.translation()[row] = kTurned[row] * lps.GetOffset()[row];
  }
  const double size = affine.linear().norm();
  if (!(std::abs(affine.linear().determinant()) > 1e-9 * size * size * size)) {
    refuse(path, "its affine part cannot be inverted: it takes space to a plane");
  }
  return affine;
}

Volume<Eigen::Vector3f> fieldInRas(const Path& path, const Warp::DisplacementFieldType& field) {
  Grid grid;
  for (int a = 0; a < 3; ++a) {
    grid.size[a] = static_cast<int>(field.GetLargestPossibleRegion().GetSize(a));
    grid.spacing[a] = field.GetSpacing()[a];
    grid.origin[a] = kTurned[a] * field.GetOrigin()[a];
    for (int b = 0; b < 3; ++b) grid.direction(a, b) = kTurned[a] * field.GetDirection()(a, b);
  }
  const Eigen::Matrix3d product = grid.direction.transpose() * grid.direction;
  if (!product.isIdentity(1e-6)) refuse(path, "the axes of its field are not at right angles");
  Volume<Eigen::Vector3f> displacement(grid, Eigen::Vector3f::Zero());
  const auto* voxel = field.GetBufferPointer();
  for (std::size_t v = 0; v < displacement.size(); ++v) {
    for (int a = 0; a < 3; ++a) {
      displacement[v][a] = static_cast<float>(kTurned[a] * voxel[v][a]);
    }
  }
  return displacement;
}

}  // namespace

std::function<Point(const Point&)> readItkTransform(const Path& path, bool inverse) {
  Transform::Pointer transform;
  try {
    transform = compositeOf(path).GetPointer();
    if (inverse) {
      const auto inverted = transform->GetInverseTransform();
      if (inverted.IsNull()) {
        refuse(path,
               "has no inverse; give the transform of the other direction, which ANTs writes as "
               "InverseComposite or InverseWarp");
      }
      transform = dynamic_cast<Transform*>(inverted.GetPointer());
    }
  } catch (const itk::ExceptionObject& error) {
    const std::string cause = error.GetDescription();
    failToRead(path, "ITK does not take this transform: " + cause.substr(0, cause.find('\n')));
  }
  return [transform](const Point& ras) -> Point {
    Transform::InputPointType lps;
    for (int axis = 0; axis < 3; ++axis) lps[axis] = kTurned[axis] * ras[axis];
    const auto there = transform->TransformPoint(lps);
    return {kTurned[0] * there[0], kTurned[1] * there[1], kTurned[2] * there[2]};
  };
}

StoredTransform readTransform(const Path& path) {
  try {
    const Composite::Pointer composite = compositeOf(path);
    const auto count = composite->GetNumberOfTransforms();
    const auto* linear = dynamic_cast<const Linear*>(composite->GetNthTransformConstPointer(0));
    const auto* warp =
        count == 2 ? dynamic_cast<const Warp*>(composite->GetNthTransformConstPointer(1)) : nullptr;
    if (linear == nullptr || count > 2 || (count == 2 && warp == nullptr)) {
      refuse(path,
             "is not an affine transform after at most one displacement field, as explica segment "
             "writes to_template.h5");
    }
    StoredTransform stored;
    stored.affine = affineInRas(path, *linear);
    if (warp != nullptr) stored.displacement = fieldInRas(path, *warp->GetDisplacementField());
    return stored;
  } catch (const itk::ExceptionObject& error) {
    const std::string cause = error.GetDescription();
    failToRead(path, "ITK does not take this transform: " + cause.substr(0, cause.find('\n')));
  }
}

void writeTransform(const std::filesystem::path& path, const Eigen::Affine3d& affine,
                    const Volume<Eigen::Vector3f>& displacement) {
  // The transform that stands last is applied first.
  std::vector<TransformEntry> entries = {{"CompositeTransform_double_3_3", {}, {}},
                                         affineInLps(affine)};
  if (displacement.size() != 0) entries.push_back(fieldInLps(displacement));
  writeHdf5Transform(path, entries);
}

}  // namespace explica::io
