// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "MniObjFormat.h"

#include "MeshBuilder.h"
#include "SurfaceFrame.h"

#include "Explica/Core/WholeFile.h"

#include <Eigen/Geometry>

#include <cctype>

// P ambient diffuse specular shininess opacity POINTS
// x y z                  a line a point
// nx ny nz               a line a point
// ITEMS
// KIND r g b a ...       one colour (0), one an item (1) or one a point (2)
// end indices            one an item: where its corners end in the list that follows
// corners                counted from 0

namespace explica::io {
namespace {

/// Colours carry nothing that a surface keeps.
void skipColours(const std::filesystem::path& path, ByteCursor& cursor, std::size_t points,
                 std::size_t items) {
  const int kind = parseNumber<int>(path, cursor.word());
  if (kind < 0 || kind > 2) {
    failToRead(path, "has colours of the unknown kind " + std::to_string(kind));
  }
  const std::size_t colours = kind == 0 ? 1 : kind == 1 ? items : points;
  for (std::size_t n = 0; n < 4 * colours; ++n) {
    static_cast<void>(parseNumber<double>(path, cursor.word()));
  }
}

}  // namespace

bool looksLikeMniObj(ByteView bytes) {
  // Wavefront's lines begin with lower-case words; MNI's kinds of objects are one letter.
  if (bytes.size() < 2) return false;
  const auto kind = static_cast<char>(bytes[0]);
  if (kind == 'P' || kind == 'L') {
    const std::string_view rest = textOf(bytes).substr(1, 20);
    const std::size_t digit = rest.find_first_not_of(" \t");
    return digit > 0 && digit != std::string_view::npos &&
           (std::isdigit(static_cast<unsigned char>(rest[digit])) != 0 || rest[digit] == '.');
  }
  // Binary: float32 of surface properties follow at once.
  constexpr std::size_t kProperties = 20;
  if ((kind != 'p' && kind != 'l') || bytes.size() < kProperties) return false;
  return textOf(bytes).substr(0, kProperties).find('\0') != std::string_view::npos;
}

LoadedSurface readMniObj(const std::filesystem::path& path, ByteView bytes,
                         const SurfaceReadOptions& options) {
  ByteCursor cursor(path, bytes, false);
  const std::string_view kind = cursor.word();
  if (kind.starts_with('p') || kind.starts_with('l')) {
    failToRead(path, "is a binary MNI object file; text is read: `ascii_binary FILE OUT ascii`");
  }
  if (kind != "P") refuse(path, "holds lines, no polygons; a surface is needed");
  constexpr int kSurfaceProperties = 5;  // numbers before the count of points
  for (int n = 0; n < kSurfaceProperties; ++n) {
    static_cast<void>(parseNumber<double>(path, cursor.word()));
  }
  constexpr std::size_t kLeast = 6;  // bytes of three numbers
  const std::size_t points = checkedCount(path, parseNumber<std::int64_t>(path, cursor.word()),
                                          cursor.left(), kLeast, "points");
  MeshBuilder builder;
  builder.coordinates.reserve(3 * points);
  for (std::size_t n = 0; n < 3 * points; ++n) {
    builder.coordinates.push_back(parseNumber<double>(path, cursor.word()));
  }
  for (std::size_t n = 0; n < 3 * points; ++n) static_cast<void>(cursor.word());  // normals
  const std::size_t items = checkedCount(path, parseNumber<std::int64_t>(path, cursor.word()),
                                         cursor.left(), 2, "polygons");
  skipColours(path, cursor, points, items);
  std::vector<std::size_t> ends;
  ends.reserve(items);
  for (std::size_t n = 0; n < items; ++n) {
    ends.push_back(checkedCount(path, parseNumber<std::int64_t>(path, cursor.word()), bytes.size(),
                                2, "corners"));
    if (n > 0 && ends[n] < ends[n - 1]) failToRead(path, "has polygons whose ends go backwards");
  }
  std::vector<std::int64_t> corners;
  for (std::size_t n = 0; n < items; ++n) {
    corners.resize(ends[n] - (n > 0 ? ends[n - 1] : 0));
    for (std::int64_t& corner : corners) corner = parseNumber<std::int64_t>(path, cursor.word());
    builder.addPolygon(path, corners.data(), corners.size());
  }
  if (!cursor.word().empty()) refuse(path, "holds more than one object; one surface is needed");
  LoadedSurface surface;
  surface.origin.path = path;
  surface.origin.format = "MNI obj";
  surface.metadata.structure = structureFromName(path);
  surface.mesh = builder.finish(path, surface.origin.notes);
  FrameInFile frame;
  frame.stated = "MINC world";
  moveToScanner(surface, frame, options);
  return surface;
}

void writeMniObj(const std::filesystem::path& path, const TriangleMesh& mesh) {
  Positions normals = Positions::Zero(mesh.vertexCount(), 3);
  for (Eigen::Index f = 0; f < mesh.faceCount(); ++f) {
    const Vector a = mesh.corner(f, 0), b = mesh.corner(f, 1), c = mesh.corner(f, 2);
    const Vector weighed = (b - a).cross(c - a);
    for (int k = 0; k < 3; ++k) normals.row(mesh.faces(f, k)) += weighed.transpose();
  }
  std::string text = "P 0.3 0.7 0.5 100 1 " + std::to_string(mesh.vertexCount()) + "\n";
  const auto addRow = [&text](const auto& row) {
    for (int k = 0; k < 3; ++k) {
      text += k > 0 ? " " : "";
      appendNumber(text, row[k]);
    }
    text += '\n';
  };
  for (Eigen::Index v = 0; v < mesh.vertexCount(); ++v) addRow(mesh.positions.row(v));
  text += '\n';
  for (Eigen::Index v = 0; v < mesh.vertexCount(); ++v) {
    const double length = normals.row(v).norm();
    const Eigen::RowVector3d unit =
        length > 0 ? Eigen::RowVector3d(normals.row(v) / length) : Eigen::RowVector3d(0, 0, 1);
    addRow(unit);
  }
  text += "\n" + std::to_string(mesh.faceCount()) + "\n0 1 1 1 1\n\n";
  for (Eigen::Index f = 0; f < mesh.faceCount(); ++f) text += std::to_string(3 * (f + 1)) + "\n";
  text += '\n';
  for (Eigen::Index f = 0; f < mesh.faceCount(); ++f) addRow(mesh.faces.row(f));
  writeTextFile(path, text);
}

}  // namespace explica::io
