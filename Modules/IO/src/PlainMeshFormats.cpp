// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "PlainMeshFormats.h"

#include "MeshBuilder.h"
#include "StoredVolume.h"

#include "Explica/Core/WholeFile.h"

#include <Eigen/Geometry>

#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

namespace explica::io {
namespace {

/// Says what a file holds beyond the faces that its header announces, blank space and comments
/// aside.
void noteRest(ByteCursor& cursor, LoadedSurface& surface) {
  while (cursor.left() > 0) {
    const std::size_t left = cursor.left();
    const std::string_view line = cursor.line();
    if (line.substr(0, line.find('#')).find_first_not_of(" \t") == std::string_view::npos) continue;
    surface.origin.notes.push_back(std::to_string(left) +
                                   " bytes after the last face are not used");
    return;
  }
}

StoredType plyTypeOf(const std::filesystem::path& path, std::string_view word) {
  static constexpr std::pair<std::string_view, StoredType> kTypes[] = {
      {"char", StoredType::Int8},      {"int8", StoredType::Int8},
      {"uchar", StoredType::UInt8},    {"uint8", StoredType::UInt8},
      {"short", StoredType::Int16},    {"int16", StoredType::Int16},
      {"ushort", StoredType::UInt16},  {"uint16", StoredType::UInt16},
      {"int", StoredType::Int32},      {"int32", StoredType::Int32},
      {"uint", StoredType::UInt32},    {"uint32", StoredType::UInt32},
      {"float", StoredType::Float32},  {"float32", StoredType::Float32},
      {"double", StoredType::Float64}, {"float64", StoredType::Float64}};
  for (const auto& [name, type] : kTypes) {
    if (name == word) return type;
  }
  failToRead(path, "has the unknown PLY type '" + std::string(word) + "'");
}

struct PlyProperty {
  std::string name;
  StoredType type = StoredType::Float32;
  bool list = false;
  StoredType countType = StoredType::UInt8;
};

struct PlyElement {
  std::string name;
  std::int64_t count = 0;
  std::vector<PlyProperty> properties;
};

class PlyValues {
 public:
  PlyValues(const std::filesystem::path& path, ByteCursor& cursor, bool text)
      : path_(path), cursor_(cursor), text_(text) {}
  double take(StoredType type) {
    if (text_) return parseNumber<double>(path_, cursor_.word());
    double value = 0;
    withType(type, [&]<class In>(const In*) { value = static_cast<double>(cursor_.take<In>()); });
    return value;
  }
  std::int64_t takeWhole(StoredType type) { return wholeNumber(path_, take(type)); }

 private:
  const std::filesystem::path& path_;
  ByteCursor& cursor_;
  bool text_;
};

struct PlyHeader {
  bool text = false;
  bool bigEndian = false;
  std::vector<PlyElement> elements;
  std::size_t size = 0;
};

constexpr std::size_t kMostElements = 64;     // kinds in a header
constexpr std::size_t kMostProperties = 256;  // of each

PlyHeader plyHeaderOf(const std::filesystem::path& path, ByteView bytes) {
  PlyHeader header;
  ByteCursor cursor(path, bytes, false);
  static_cast<void>(cursor.line());
  bool formatGiven = false;
  while (true) {
    if (cursor.left() == 0) failTruncated(path, "its PLY header does not end");
    const std::string_view line = cursor.line();
    ByteCursor words(path, line);
    const std::string_view word = words.word();
    if (word == "end_header") break;
    if (word == "format") {
      const std::string_view kind = words.word();
      header.text = kind == "ascii";
      header.bigEndian = kind == "binary_big_endian";
      formatGiven = header.text || header.bigEndian || kind == "binary_little_endian";
    } else if (word == "element") {
      PlyElement element;
      element.name = words.word();
      element.count = parseNumber<std::int64_t>(path, words.word());
      if (header.elements.size() == kMostElements) {
        failToRead(path,
                   "has more than " + std::to_string(kMostElements) + " kinds of PLY elements");
      }
      header.elements.push_back(element);
    } else if (word == "property") {
      if (header.elements.empty()) failToRead(path, "has a PLY property before any element");
      PlyProperty property;
      std::string_view type = words.word();
      if (type == "list") {
        property.list = true;
        property.countType = plyTypeOf(path, words.word());
        type = words.word();
      }
      property.type = plyTypeOf(path, type);
      property.name = words.word();
      if (header.elements.back().properties.size() == kMostProperties) {
        failToRead(path, "has PLY elements of more than " + std::to_string(kMostProperties) +
                             " properties");
      }
      header.elements.back().properties.push_back(property);
    }
  }
  if (!formatGiven) failToRead(path, "has a PLY header without a known format");
  header.size = cursor.position();
  return header;
}

}  // namespace

LoadedSurface readPly(const std::filesystem::path& path, ByteView bytes) {
  const PlyHeader header = plyHeaderOf(path, bytes);
  ByteCursor cursor(path, bytes, header.bigEndian);
  cursor.moveTo(header.size);
  PlyValues values(path, cursor, header.text);
  MeshBuilder builder;
  std::vector<VertexMap> maps;
  std::vector<std::int64_t> corners;
  for (const PlyElement& element : header.elements) {
    const bool vertices = element.name == "vertex";
    const std::size_t count =
        checkedCount(path, element.count, cursor.left(),
                     std::max<std::size_t>(1, element.properties.size()), "elements");
    std::vector<int> axisOf(element.properties.size(), -1);
    std::vector<std::size_t> mapOf(element.properties.size());
    if (vertices) {
      builder.coordinates.assign(3 * count, 0);
      int axes = 0;
      for (std::size_t p = 0; p < element.properties.size(); ++p) {
        const std::string& name = element.properties[p].name;
        if (name == "x" || name == "y" || name == "z") {
          axisOf[p] = name[0] - 'x';
          ++axes;
        } else {
          mapOf[p] = maps.size();
          maps.push_back({name, "", Eigen::VectorXd::Zero(static_cast<Eigen::Index>(count))});
        }
      }
      if (axes != 3) failToRead(path, "has PLY vertices without x, y and z");
    }
    for (std::size_t i = 0; i < count; ++i) {
      for (std::size_t p = 0; p < element.properties.size(); ++p) {
        const PlyProperty& property = element.properties[p];
        if (!property.list) {
          const double value = values.take(property.type);
          if (axisOf[p] >= 0) {
            builder.coordinates[3 * i + axisOf[p]] = value;
          } else if (vertices) {
            maps[mapOf[p]].values[i] = value;
          }
          continue;
        }
        const std::size_t length =
            checkedCount(path, values.takeWhole(property.countType), cursor.left(), 1, "corners");
        corners.resize(length);
        for (std::int64_t& corner : corners) corner = values.takeWhole(property.type);
        if (element.name == "face" &&
            (property.name == "vertex_indices" || property.name == "vertex_index")) {
          builder.addPolygon(path, corners.data(), corners.size());
        }
      }
    }
  }
  LoadedSurface surface = builder.finish(path, "PLY");
  noteRest(cursor, surface);
  surface.maps = std::move(maps);
  return surface;
}

void writePly(const std::filesystem::path& path, const TriangleMesh& mesh) {
  const std::string header =
      "ply\nformat binary_little_endian 1.0\ncomment RAS mm, written by Explica\nelement vertex " +
      std::to_string(mesh.vertexCount()) +
      "\nproperty double x\nproperty double y\nproperty double z\nelement face " +
      std::to_string(mesh.faceCount()) + "\nproperty list uchar int vertex_indices\nend_header\n";
  constexpr std::size_t kFace = 13;  // bytes: a count and three corners
  Bytes faces(kFace * static_cast<std::size_t>(mesh.faceCount()));
  for (Eigen::Index f = 0; f < mesh.faceCount(); ++f) {
    std::uint8_t* to = faces.data() + kFace * static_cast<std::size_t>(f);
    *to = 3;
    std::memcpy(to + 1, mesh.faces.data() + 3 * f, 12);
  }
  WholeFile file(path);
  file.write(header);
  file.write(mesh.positions.data(),
             sizeof(double) * static_cast<std::size_t>(mesh.positions.size()));
  file.write(faces.data(), faces.size());
  file.commit();
}

LoadedSurface readObj(const std::filesystem::path& path, ByteView bytes) {
  if (textOf(bytes).starts_with("P ")) {
    refuse(path, "is an MNI object file (CIVET), which is not read; convert it to GIFTI");
  }
  ByteCursor cursor(path, bytes, false);
  MeshBuilder builder;
  std::vector<std::int64_t> corners;
  while (cursor.left() > 0) {
    const std::string_view line = cursor.line();
    ByteCursor words(path, line);
    const std::string_view kind = words.word();
    if (kind == "v") {
      for (int k = 0; k < 3; ++k) {
        builder.coordinates.push_back(parseNumber<double>(path, words.word()));
      }
    } else if (kind == "f") {
      corners.clear();
      for (std::string_view word = words.word(); !word.empty(); word = words.word()) {
        const auto number = parseNumber<std::int64_t>(path, word.substr(0, word.find('/')));
        const auto vertices = static_cast<std::int64_t>(builder.coordinates.size() / 3);
        // Counted from 1, or backwards from the last vertex so far.
        corners.push_back(number > 0 ? number - 1 : number < 0 ? vertices + number : -1);
      }
      builder.addPolygon(path, corners.data(), corners.size());
    }
  }
  return builder.finish(path, "OBJ");
}

void writeObj(const std::filesystem::path& path, const TriangleMesh& mesh) {
  std::string text = "# RAS mm, written by Explica\n";
  for (const auto& point : mesh.positions.rowwise()) appendRow(text, "v ", point);
  for (const auto& face : mesh.faces.rowwise()) {
    appendRow(text, "f ", Eigen::RowVector3i(face.array() + 1));
  }
  writeTextFile(path, text);
}

bool looksLikePly(ByteView bytes) {
  return textOf(bytes).starts_with("ply\n") || textOf(bytes).starts_with("ply\r\n");
}

bool looksLikeOff(ByteView bytes) {
  const std::string_view text = textOf(bytes);
  for (const std::string_view start : {"OFF", "COFF", "NOFF", "CNOFF"}) {
    if (text.starts_with(start) && text.size() > start.size() &&
        (text[start.size()] == '\n' || text[start.size()] == '\r' || text[start.size()] == ' ')) {
      return true;
    }
  }
  return false;
}

LoadedSurface readOff(const std::filesystem::path& path, ByteView bytes) {
  ByteCursor cursor(path, bytes, false);
  static_cast<void>(cursor.word());
  // The rest of a line, without its comment, that is not blank.
  const auto nextLine = [&]() -> std::string_view {
    while (cursor.left() > 0) {
      std::string_view line = cursor.line();
      line = line.substr(0, line.find('#'));
      if (line.find_first_not_of(" \t") != std::string_view::npos) return line;
    }
    failTruncated(path, "the file ends too early");
  };
  const auto wordsOf = [&path](std::string_view line) { return ByteCursor(path, line); };
  ByteCursor counts = wordsOf(nextLine());
  const auto announcedVertices = parseNumber<std::int64_t>(path, counts.word());
  const auto announcedFaces = parseNumber<std::int64_t>(path, counts.word());
  const std::size_t vertices = checkedCount(path, announcedVertices, cursor.left(), 6, "vertices");
  const std::size_t faces = checkedCount(path, announcedFaces, cursor.left(), 4, "faces");
  MeshBuilder builder;
  builder.coordinates.reserve(3 * vertices);
  for (std::size_t v = 0; v < vertices; ++v) {
    ByteCursor words = wordsOf(nextLine());
    for (int k = 0; k < 3; ++k) {
      builder.coordinates.push_back(parseNumber<double>(path, words.word()));
    }
  }
  std::vector<std::int64_t> corners;
  for (std::size_t f = 0; f < faces; ++f) {
    ByteCursor words = wordsOf(nextLine());
    const std::size_t count = checkedCount(path, parseNumber<std::int64_t>(path, words.word()),
                                           words.left(), 1, "corners");
    corners.resize(count);
    for (std::int64_t& corner : corners) corner = parseNumber<std::int64_t>(path, words.word());
    builder.addPolygon(path, corners.data(), corners.size());
  }
  LoadedSurface surface = builder.finish(path, "OFF");
  noteRest(cursor, surface);
  return surface;
}

void writeOff(const std::filesystem::path& path, const TriangleMesh& mesh) {
  std::string text = "OFF\n" + std::to_string(mesh.vertexCount()) + " " +
                     std::to_string(mesh.faceCount()) + " 0\n";
  for (const auto& point : mesh.positions.rowwise()) appendRow(text, "", point);
  for (const auto& face : mesh.faces.rowwise()) appendRow(text, "3 ", face);
  writeTextFile(path, text);
}

namespace {

constexpr std::size_t kStlHeader = 84;  // bytes: a text and the count of facets
constexpr std::size_t kStlFacet = 50;   // bytes: normal, three corners, attributes

bool isBinaryStl(ByteView bytes) {
  return bytes.size() >= kStlHeader &&
         bytes.size() == kStlHeader + kStlFacet * static_cast<std::size_t>(load<std::uint32_t>(
                                                      bytes.data() + 80, false));
}

template <class Real>
using Corners = std::vector<std::array<Real, 3>>;

/// Numbers equal corners alike, in the order of their first appearance.
template <class Real>
void mergeCorners(const Corners<Real>& corners, MeshBuilder& builder) {
  std::vector<std::int32_t> order(corners.size());
  std::iota(order.begin(), order.end(), 0);
  std::ranges::sort(order, [&corners](std::int32_t a, std::int32_t b) {
    return corners[a] != corners[b] ? corners[a] < corners[b] : a < b;
  });
  std::vector<std::int32_t>& vertex = builder.triangles;  // at first the first corner of that place
  vertex.resize(corners.size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    const bool same = i > 0 && corners[order[i]] == corners[order[i - 1]];
    vertex[order[i]] = same ? vertex[order[i - 1]] : order[i];
  }
  std::vector<std::int32_t>().swap(order);
  std::size_t different = 0;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    different += vertex[i] == static_cast<std::int32_t>(i);
  }
  builder.coordinates.reserve(3 * different);
  // A corner's own number comes before all that refer to it.
  for (std::size_t i = 0; i < corners.size(); ++i) {
    if (vertex[i] != static_cast<std::int32_t>(i)) {
      vertex[i] = vertex[vertex[i]];
      continue;
    }
    vertex[i] = static_cast<std::int32_t>(builder.coordinates.size() / 3);
    builder.coordinates.insert(builder.coordinates.end(), corners[i].begin(), corners[i].end());
  }
}

Corners<float> binaryCorners(ByteView bytes) {
  Corners<float> corners;
  corners.reserve((bytes.size() - kStlHeader) / kStlFacet * 3);
  for (std::size_t facet = kStlHeader; facet < bytes.size(); facet += kStlFacet) {
    for (std::size_t k = 0; k < 3; ++k) {
      auto& corner = corners.emplace_back();
      for (std::size_t c = 0; c < 3; ++c) {
        corner[c] = load<float>(bytes.data() + facet + 12 + 12 * k + 4 * c, false);
      }
    }
  }
  return corners;
}

Corners<double> textCorners(const std::filesystem::path& path, ByteView bytes) {
  if (!textOf(bytes).starts_with("solid")) {
    failTruncated(path, "its length does not fit the facets that it announces");
  }
  Corners<double> corners;
  ByteCursor cursor(path, bytes, false);
  bool ended = false;
  while (cursor.left() > 0) {
    const std::string_view line = cursor.line();
    ByteCursor words(path, line);
    const std::string_view word = words.word();
    if (word == "endsolid") ended = true;
    if (word != "vertex") continue;
    for (double& c : corners.emplace_back()) c = parseNumber<double>(path, words.word());
  }
  if (!ended || corners.size() % 3 != 0) failTruncated(path, "the file ends too early");
  return corners;
}

template <class Real>
LoadedSurface mergedSurface(const std::filesystem::path& path, Corners<Real> corners) {
  if (corners.size() > std::numeric_limits<std::int32_t>::max()) {
    refuse(path, "has more corners than 32-bit indices count");
  }
  for (auto& corner : corners) {
    for (Real& c : corner) {
      if (!std::isfinite(c)) refuse(path, "has a coordinate that is not finite");
      c += Real{0};  // negative zero equals zero
    }
  }
  const std::size_t count = corners.size();
  MeshBuilder builder;
  mergeCorners(corners, builder);
  Corners<Real>().swap(corners);
  LoadedSurface surface = builder.finish(path, "STL");
  surface.origin.notes.push_back(std::to_string(count) + " corners merged to " +
                                 std::to_string(surface.mesh.vertexCount()) + " vertices");
  return surface;
}

}  // namespace

bool looksLikeStl(ByteView bytes) {
  constexpr std::size_t kFarEnough = 1024;  // bytes in which a text names its first facet
  const std::string_view text = textOf(bytes).substr(0, kFarEnough);
  return isBinaryStl(bytes) ||
         (text.starts_with("solid") && text.find("facet") != std::string_view::npos);
}

LoadedSurface readStl(const std::filesystem::path& path, ByteView bytes) {
  return isBinaryStl(bytes) ? mergedSurface(path, binaryCorners(bytes))
                            : mergedSurface(path, textCorners(path, bytes));
}

void writeStl(const std::filesystem::path& path, const TriangleMesh& mesh) {
  Bytes bytes(kStlHeader + kStlFacet * static_cast<std::size_t>(mesh.faceCount()));
  static constexpr char kTitle[] = "RAS mm, written by Explica";
  std::memcpy(bytes.data(), kTitle, sizeof(kTitle));
  store(bytes.data() + 80, static_cast<std::uint32_t>(mesh.faceCount()), false);
  for (Eigen::Index f = 0; f < mesh.faceCount(); ++f) {
    std::uint8_t* to = bytes.data() + kStlHeader + kStlFacet * static_cast<std::size_t>(f);
    const Point a = mesh.corner(f, 0);
    const Vector normal = (mesh.corner(f, 1) - a).cross(mesh.corner(f, 2) - a).normalized();
    for (int c = 0; c < 3; ++c) {
      store(to + 4 * c, static_cast<float>(normal[c]), false);
      for (int k = 0; k < 3; ++k) {
        store(to + 12 + 12 * k + 4 * c, static_cast<float>(mesh.corner(f, k)[c]), false);
      }
    }
  }
  writeTextFile(path, textOf(bytes));
}

}  // namespace explica::io
