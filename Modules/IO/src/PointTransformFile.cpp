// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/IO/PointTransformFile.h"

#include "ByteSource.h"
#include "FreeSurferFormat.h"
#include "ItkTransform.h"
#include "SurfaceFrame.h"

#include "Explica/Core/Parallel.h"
#include "Explica/IO/SurfaceFile.h"

#include <Eigen/LU>

#include <cmath>
#include <map>

namespace explica::io {
namespace {

constexpr std::size_t kLargestText = 1 << 20;  // bytes: matrices are small

Eigen::Matrix4d checked(const std::filesystem::path& path, const Eigen::Matrix4d& matrix) {
  const bool affine =
      matrix.allFinite() && (matrix.row(3) - Eigen::RowVector4d(0, 0, 0, 1)).norm() < 1e-6;
  if (!affine) refuse(path, "its matrix is not affine: the last row must be 0 0 0 1");
  const Eigen::Matrix3d linear = matrix.topLeftCorner<3, 3>();
  if (!(std::abs(linear.determinant()) > 1e-9 * std::pow(linear.norm(), 3))) {
    refuse(path, "its matrix cannot be inverted: it takes space to a plane");
  }
  return matrix;
}

PointTransform affine(std::string format, std::string sense, const Eigen::Matrix4d& matrix) {
  PointTransform transform;
  transform.format = std::move(format);
  transform.sense = std::move(sense);
  transform.matrix = matrix;
  transform.map = [matrix](const Point& x) -> Point {
    return matrix.topLeftCorner<3, 3>() * x + matrix.topRightCorner<3, 1>();
  };
  return transform;
}

std::string wordFor(bool inverse) {
  return inverse ? "volume to surface, inverted" : "surface to volume, as it stands";
}

/// All numbers of a text; empty if there is anything else.
std::vector<double> allNumbersIn(std::string_view text) {
  std::vector<double> numbers;
  const std::filesystem::path none;
  ByteCursor lines(none, text);
  while (lines.left() > 0) {
    const std::string_view whole = lines.line();
    std::string line(whole.substr(0, whole.find('#')));
    for (char& c : line) {
      if (c == ',' || c == ';') c = ' ';
    }
    ByteCursor words(none, line);
    for (std::string_view word = words.word(); !word.empty(); word = words.word()) {
      double value = 0;
      if (word.starts_with('+')) word.remove_prefix(1);
      const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
      if (error != std::errc{} || end != word.data() + word.size()) return {};
      numbers.push_back(value);
    }
  }
  return numbers;
}

Eigen::Matrix4d matrixOf(const std::filesystem::path& path, const std::vector<double>& numbers) {
  if (numbers.size() < 16) failTruncated(path, "it has fewer than the 16 numbers of a matrix");
  Eigen::Matrix4d matrix;
  for (int i = 0; i < 16; ++i) matrix(i / 4, i % 4) = numbers[i];
  return checked(path, matrix);
}

PointTransform plainMatrix(const std::filesystem::path& path, const std::vector<double>& numbers,
                           TransformSense sense) {
  Eigen::Matrix4d matrix = matrixOf(path, numbers);
  const bool inverse = sense == TransformSense::Inverse;
  if (inverse) matrix = matrix.inverse().eval();
  return affine("matrix", wordFor(inverse), matrix);
}

/// `"coord": [[16 numbers in 4 rows]]` of a JSON object.
PointTransform pycortex(const std::filesystem::path& path, std::string_view text,
                        const TransformSides& sides) {
  const std::size_t key = text.find("\"coord\"");
  if (key == std::string_view::npos) {
    failToRead(path, "is JSON without \"coord\"; pycortex's matrices.xfm has it");
  }
  std::string rows;
  int depth = 0;
  for (const char c : text.substr(key + 7)) {
    rows += c;
    depth += c == '[' ? 1 : c == ']' ? -1 : 0;
    if (c == ']' && depth == 0) break;
  }
  for (char& c : rows) {
    if (c == '[' || c == ']' || c == ':' || c == ',') c = ' ';
  }
  const std::vector<double> numbers = allNumbersIn(rows);
  if (numbers.size() != 16) failToRead(path, "its \"coord\" is not a matrix of 4 x 4 numbers");
  const Eigen::Matrix4d toIndex = matrixOf(path, numbers);
  if (sides.sense == TransformSense::Inverse) {
    refuse(path, "pycortex's transforms map the surface to voxels; they are not inverted");
  }
  return affine("pycortex", "coordinates of the surface's file to voxels, as it stands",
                sides.volume.affine() * toIndex * sides.scannerFromFile.inverse());
}

PointTransform registerDat(const std::filesystem::path& path, std::string_view text,
                           const TransformSides& sides) {
  ByteCursor cursor(path, text);
  for (int line = 0; line < 4; ++line)
    static_cast<void>(cursor.line());  // subject, voxels, intensity
  std::vector<double> numbers;
  for (int i = 0; i < 16; ++i) numbers.push_back(parseNumber<double>(path, cursor.word()));
  Eigen::Matrix4d tkr = matrixOf(path, numbers);
  if (!sides.scannerFromTkr) {
    refuse(path,
           "maps FreeSurfer's surface RAS, and the surface's file does not tell the volume that "
           "these belong to; name it with --fs-volume orig.mgz");
  }
  const bool inverse = sides.sense == TransformSense::Inverse;
  if (inverse) tkr = tkr.inverse().eval();
  return affine("register.dat",
                inverse ? "surface RAS of the volume to that of the anatomy, inverted"
                        : "surface RAS of the anatomy to that of the volume, as it stands",
                scannerFromTkr(sides.volume) * tkr * sides.scannerFromTkr->inverse());
}

/// One side of an LTA: the volume after "src volume info" or "dst volume info".
std::optional<Grid> sideOf(const std::filesystem::path& path, std::string_view text,
                           std::string_view title) {
  const std::size_t begin = text.find(title);
  if (begin == std::string_view::npos) return {};
  ByteCursor lines(path, text.substr(begin));
  static_cast<void>(lines.line());
  return volumeInWords(path, lines);
}

PointTransform lta(const std::filesystem::path& path, std::string_view text,
                   const TransformSides& sides) {
  const auto after = [&](std::string_view key) {
    const std::size_t at = text.find(key);
    const std::size_t mark = at == std::string_view::npos ? at : text.find('=', at);
    if (mark == std::string_view::npos)
      failToRead(path, "is an LTA without '" + std::string(key) + "'");
    ByteCursor cursor(path, text.substr(mark + 1));
    return parseNumber<int>(path, cursor.word());
  };
  constexpr int kVoxelToVoxel = 0, kRasToRas = 1;  // FreeSurfer's numbers of types
  const int type = after("type");
  if (type != kVoxelToVoxel && type != kRasToRas) {
    refuse(path, "is an LTA of type " + std::to_string(type) +
                     "; 0 (voxel to voxel) and 1 (RAS to RAS) are understood: convert it with "
                     "lta_convert --ltavox2vox");
  }
  const std::size_t head = text.find("1 4 4");
  if (head == std::string_view::npos) failToRead(path, "is an LTA without a 4 x 4 matrix");
  ByteCursor cursor(path, text.substr(head + 5));
  std::vector<double> numbers;
  for (int i = 0; i < 16; ++i) numbers.push_back(parseNumber<double>(path, cursor.word()));
  Eigen::Matrix4d matrix = matrixOf(path, numbers);
  const std::optional<Grid> source = sideOf(path, text, "src volume info"),
                            target = sideOf(path, text, "dst volume info");
  if (!source || !target) refuse(path, "does not tell the geometry of both its volumes");
  if (type == kVoxelToVoxel) matrix = target->affine() * matrix * source->affine().inverse();
  const bool isSource = sameGrid(*source, sides.volume, 0.01),
             isTarget = sameGrid(*target, sides.volume, 0.01);
  bool inverse = sides.sense == TransformSense::Inverse;
  if (sides.sense == TransformSense::Auto) {
    if (isSource == isTarget) {
      refuse(path, std::string("the volume lies on the grid of ") +
                       (isSource ? "both its source and its target"
                                 : "neither its source nor its target") +
                       "; say with --to-volume-sense forward or inverse which way it goes");
    }
    inverse = isSource;
  }
  if (inverse) matrix = matrix.inverse().eval();
  return affine(
      "LTA",
      inverse ? "the volume is its source, inverted" : "the volume is its target, as it stands",
      matrix);
}

}  // namespace

Positions PointTransform::operator()(const Positions& points) const {
  Positions moved(points.rows(), 3);
  parallelFor(static_cast<std::size_t>(points.rows()), [&](std::size_t p) {
    const auto row = static_cast<Eigen::Index>(p);
    moved.row(row) = map(points.row(row).transpose()).transpose();
  });
  return moved;
}

PointTransform readPointTransform(const std::filesystem::path& path, const TransformSides& sides) {
  ByteSource source(path);
  const ByteView first = source.peek(8);
  const std::string_view magic = textOf(first);
  const bool inverse = sides.sense == TransformSense::Inverse;
  const auto itk = [&] {
    PointTransform transform;
    transform.format = "ITK";
    transform.sense = inverse ? "moving to fixed, inverted" : "fixed to moving, as it stands";
    transform.map = readItkTransform(path, inverse);
    return transform;
  };
  // Matlab's level 4 files, which ANTs writes, begin with the type and the size of a matrix.
  const std::string extension = path.extension().string();
  if (magic.starts_with("\x89HDF\r\n") || magic.starts_with("#Insight")) return itk();
  if (source.leftAtMost() > kLargestText) {
    failToRead(path, "is not a transform of a known format (it is too long for a matrix as text)");
  }
  const Bytes bytes = source.rest();
  const std::string_view text = textOf(bytes);
  if (text.find('\0') != std::string_view::npos) {
    if (extension == ".mat" || extension == ".h5" || extension == ".hdf5") return itk();
    failToRead(path, "is not a transform of a known format");
  }
  const std::size_t start = text.find_first_not_of(" \t\r\n");
  if (start != std::string_view::npos && text[start] == '{') return pycortex(path, text, sides);
  if (text.find("src volume info") != std::string_view::npos) return lta(path, text, sides);
  const std::vector<double> numbers = allNumbersIn(text);
  if (numbers.size() == 16) return plainMatrix(path, numbers, sides.sense);
  if (numbers.empty() &&
      (text.find("round") != std::string_view::npos ||
       text.find("tkregister") != std::string_view::npos ||
       text.find("trunc") != std::string_view::npos || path.extension() == ".dat")) {
    return registerDat(path, text, sides);
  }
  failToRead(path,
             "is not a transform of a known format (4 x 4 matrix as text, ITK text, .mat or .h5, "
             "FreeSurfer LTA or register.dat, pycortex xfm)");
}

}  // namespace explica::io
