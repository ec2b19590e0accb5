// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "FreeSurferFormat.h"

#include "ByteSource.h"
#include "MeshBuilder.h"
#include "SurfaceFrame.h"

#include "Explica/Core/Text.h"
#include "Explica/Core/WholeFile.h"

#include <Eigen/LU>

#include <cmath>
#include <map>
#include <set>
#include <sstream>

namespace explica::io {
namespace {

// Three-byte magic numbers; everything is big-endian.
constexpr int kTriangleSurface = 0xfffffe;
constexpr int kOldQuadSurface = 0xffffff;  ///< also: new curv
constexpr int kNewQuadSurface = 0xfffffd;
constexpr double kOldUnit = 0.01;  // old files hold hundredths in 16 bits

constexpr std::int32_t kMostNames = 1 << 16;  // of a colour table; atlases have some thousand

// Tags after a surface.
constexpr int kTagUseRealRas = 2;
constexpr int kTagVolumeGeometry = 20;

int take24(ByteCursor& cursor) {
  const ByteView bytes = cursor.view(3);
  return bytes[0] << 16 | bytes[1] << 8 | bytes[2];
}

FrameInFile footerOf(const std::filesystem::path& path, ByteCursor& cursor) {
  FrameInFile frame;
  while (cursor.left() >= 4) {
    const auto tag = cursor.take<std::int32_t>();
    if (tag == kTagUseRealRas && cursor.left() >= 4) {
      if (cursor.take<std::int32_t>() != 0) frame.stated = "scanner";
    } else if (tag == kTagVolumeGeometry) {
      frame.tkrVolume = volumeInWords(path, cursor);
      break;
    } else {
      break;  // other tags concern tools, not geometry
    }
  }
  return frame;
}

void takeFloats(ByteCursor& cursor, std::size_t count, std::vector<double>& to) {
  to.resize(count);
  const ByteView raw = cursor.view(count * sizeof(float));
  for (std::size_t i = 0; i < count; ++i) to[i] = load<float>(raw.data() + 4 * i, true);
}

Bytes bytesOf24(int magic) {
  return {static_cast<std::uint8_t>(magic >> 16), static_cast<std::uint8_t>(magic >> 8),
          static_cast<std::uint8_t>(magic)};
}

void appendText(Bytes& bytes, const std::string& text) {
  bytes.insert(bytes.end(), text.begin(), text.end());
}

std::uint32_t packed(const LabelEntry& entry) {
  std::uint32_t colour = 0;
  for (int c = 0; c < 3; ++c) {
    const float level = std::clamp(entry.colour[c], 0.0F, 1.0F);
    colour |= static_cast<std::uint32_t>(std::lround(255 * level)) << 8 * c;
  }
  return colour;
}

}  // namespace

std::optional<Grid> volumeInWords(const std::filesystem::path& path, ByteCursor& lines) {
  constexpr int kGeometryLines = 8;
  std::map<std::string, std::string> fields;
  for (int i = 0; i < kGeometryLines && lines.left() > 0; ++i) {
    std::string_view line = lines.line();
    line = line.substr(0, line.find('#'));
    const std::size_t mark = line.find('=');
    if (mark == std::string_view::npos) break;
    std::string key(line.substr(0, mark));
    key.erase(key.find_last_not_of(' ') + 1);
    fields[key] = std::string(line.substr(mark + 1));
  }
  const auto numbers = [&](const char* key, auto&& to) {
    std::istringstream words(fields[key]);
    for (int i = 0; i < 3; ++i) {
      if (!(words >> to[i])) return false;
    }
    return true;
  };
  if (fields["valid"].find('1') == std::string::npos) return {};
  VolumeText text;
  Vector x, y, z;
  if (!numbers("volume", text.size) || !numbers("voxelsize", text.spacing) || !numbers("xras", x) ||
      !numbers("yras", y) || !numbers("zras", z) || !numbers("cras", text.centre)) {
    return {};
  }
  text.axes << x, y, z;
  return gridOfVolumeText(path, text);
}

FreeSurferKind freeSurferKindOf(ByteView bytes) {
  if (bytes.size() < 15) return FreeSurferKind::None;
  const int magic = bytes[0] << 16 | bytes[1] << 8 | bytes[2];
  if (magic == kTriangleSurface || magic == kNewQuadSurface) return FreeSurferKind::Surface;
  if (magic != kOldQuadSurface) return FreeSurferKind::None;
  const auto vertices = load<std::int32_t>(bytes.data() + 3, true);
  const auto perVertex = load<std::int32_t>(bytes.data() + 11, true);
  const bool curv = perVertex == 1 && vertices >= 0 &&
                    bytes.size() == 15 + 4 * static_cast<std::size_t>(vertices);
  return curv ? FreeSurferKind::Curv : FreeSurferKind::Surface;
}

LoadedSurface readFreeSurferSurface(const std::filesystem::path& path, ByteView bytes,
                                    const SurfaceReadOptions& options) {
  ByteCursor cursor(path, bytes, true);
  MeshBuilder builder;
  FrameInFile frame;
  const int magic = take24(cursor);
  if (magic == kTriangleSurface) {
    static_cast<void>(cursor.line());  // who made it
    if (cursor.left() > 0 && bytes[cursor.position()] == '\n') static_cast<void>(cursor.line());
    const auto announcedVertices = cursor.take<std::int32_t>();
    const auto announcedFaces = cursor.take<std::int32_t>();
    const std::size_t vertices =
        checkedCount(path, announcedVertices, cursor.left(), 12, "vertices");
    takeFloats(cursor, 3 * vertices, builder.coordinates);
    const std::size_t faces = checkedCount(path, announcedFaces, cursor.left(), 12, "faces");
    const ByteView raw = cursor.view(12 * faces);
    builder.triangles.resize(3 * faces);
    for (std::size_t i = 0; i < builder.triangles.size(); ++i) {
      builder.triangles[i] = load<std::int32_t>(raw.data() + 4 * i, true);
    }
    frame = footerOf(path, cursor);
  } else {
    const int announcedVertices = take24(cursor);
    const int announcedQuads = take24(cursor);
    const bool old = magic == kOldQuadSurface;
    const std::size_t vertices =
        checkedCount(path, announcedVertices, cursor.left(), old ? 6 : 12, "vertices");
    if (old) {
      builder.coordinates.resize(3 * vertices);
      for (double& x : builder.coordinates) x = kOldUnit * cursor.take<std::int16_t>();
    } else {
      takeFloats(cursor, 3 * vertices, builder.coordinates);
    }
    const std::size_t quads = checkedCount(path, announcedQuads, cursor.left(), 12, "faces");
    for (std::size_t q = 0; q < quads; ++q) {
      std::int32_t corner[4];
      for (std::int32_t& c : corner) c = take24(cursor);
      // FreeSurfer alternates the diagonal with the parity of the first vertex.
      const bool even = corner[0] % 2 == 0;
      for (const int k : {0, 1, even ? 3 : 2, even ? 2 : 0, even ? 3 : 2, even ? 1 : 3}) {
        builder.triangles.push_back(corner[k]);
      }
    }
    builder.splitPolygons = static_cast<std::int64_t>(quads);
  }
  LoadedSurface surface = builder.finish(path, "FreeSurfer");
  setTypesFromName(path, surface.metadata);
  moveToScanner(surface, frame, options);
  return surface;
}

VertexMap readFreeSurferCurv(const std::filesystem::path& path, ByteView bytes) {
  ByteCursor cursor(path, bytes, true);
  VertexMap map;
  map.name = path.extension().string();
  if (map.name.size() > 1) map.name.erase(0, 1);
  const int first = take24(cursor);
  if (first == kOldQuadSurface) {
    const auto announced = cursor.take<std::int32_t>();
    static_cast<void>(cursor.take<std::int32_t>());  // number of faces
    if (cursor.take<std::int32_t>() != 1) failToRead(path, "holds several values a vertex");
    const std::size_t count = checkedCount(path, announced, cursor.left(), 4, "values");
    map.values.resize(static_cast<Eigen::Index>(count));
    for (double& value : map.values) value = cursor.take<float>();
  } else {
    static_cast<void>(take24(cursor));  // number of faces
    const std::size_t count = checkedCount(path, first, cursor.left(), 2, "values");
    map.values.resize(static_cast<Eigen::Index>(count));
    for (double& value : map.values) value = kOldUnit * cursor.take<std::int16_t>();
  }
  return map;
}

bool looksLikeOldCurv(ByteView bytes) {
  if (bytes.size() < 6) return false;
  const std::size_t count = bytes[0] << 16 | bytes[1] << 8 | bytes[2];
  return count > 0 && bytes.size() == 6 + 2 * count;
}

bool looksLikeAnnot(ByteView bytes) {
  if (bytes.size() < 4) return false;
  const auto count = load<std::int32_t>(bytes.data(), true);
  return count > 0 && static_cast<std::size_t>(count) <= (bytes.size() - 4) / 8;
}

LabelMap readFreeSurferAnnot(const std::filesystem::path& path, ByteView bytes) {
  ByteCursor cursor(path, bytes, true);
  LabelMap labels;
  labels.name = path.stem().string();
  const auto announced = cursor.take<std::int32_t>();
  const std::size_t count = checkedCount(path, announced, cursor.left(), 8, "vertices");
  std::vector<std::uint32_t> colours(count);
  for (std::size_t i = 0; i < count; ++i) {
    const auto vertex = cursor.take<std::int32_t>();
    const auto colour = cursor.take<std::uint32_t>();
    if (vertex < 0 || static_cast<std::size_t>(vertex) >= count) {
      failToRead(path, "names vertex " + std::to_string(vertex) + " of " + std::to_string(count));
    }
    colours[vertex] = colour & 0xffffffU;
  }
  if (cursor.left() < 4 || cursor.take<std::int32_t>() == 0) {
    refuse(path, "has no colour table, so that its labels have no names");
  }
  const auto text = [&cursor, &path] {
    const std::size_t length =
        checkedCount(path, cursor.take<std::int32_t>(), cursor.left(), 1, "characters");
    const ByteView raw = cursor.view(length);
    std::string word(reinterpret_cast<const char*>(raw.data()), raw.size());
    word.resize(std::min(word.find('\0'), word.size()));
    return word;
  };
  const auto version = cursor.take<std::int32_t>();
  const bool old = version > 0;
  if (!old && version != -2) {
    failToRead(path, "has a colour table of the unknown version " +
                         std::to_string(-std::int64_t{version}));
  }
  if (!old) static_cast<void>(cursor.take<std::int32_t>());  // largest structure
  static_cast<void>(text());                                 // where the table came from
  const std::int32_t entries = old ? version : cursor.take<std::int32_t>();
  static_cast<void>(checkedCount(path, entries, cursor.left(), 20, "table entries"));
  if (entries > kMostNames) {
    failToRead(path, "has a colour table of " + std::to_string(entries) + " names; up to " +
                         std::to_string(kMostNames) + " are read");
  }
  std::map<std::uint32_t, Label> keyOf;
  for (std::int32_t e = 0; e < entries; ++e) {
    LabelEntry entry{.key = old ? e : cursor.take<std::int32_t>(), .name = text()};
    for (int c = 0; c < 3; ++c) {
      entry.colour[c] = static_cast<float>(cursor.take<std::int32_t>() & 255) / 255.0F;
    }
    const auto transparency = cursor.take<std::int32_t>();
    entry.colour[3] = 1 - static_cast<float>(transparency & 255) / 255.0F;
    keyOf.emplace(packed(entry), entry.key);
    labels.table.push_back(entry);
  }
  labels.keys.resize(static_cast<Eigen::Index>(count));
  bool outside = false;
  for (std::size_t v = 0; v < count; ++v) {
    const auto found = keyOf.find(colours[v]);
    outside = outside || found == keyOf.end();
    labels.keys[v] = found == keyOf.end() ? -1 : found->second;
  }
  if (outside) labels.table.push_back({-1, "none", {0, 0, 0, 0}});
  std::ranges::sort(labels.table, {}, &LabelEntry::key);
  return labels;
}

LabelMap readFreeSurferLabel(const std::filesystem::path& path, ByteView bytes,
                             std::optional<Eigen::Index> vertexCount) {
  ByteCursor cursor(path, bytes, false);
  static_cast<void>(cursor.line());  // a comment
  const auto announced = parseNumber<std::int64_t>(path, cursor.word());
  const std::size_t count = checkedCount(path, announced, cursor.left(), 9, "vertices");
  if (!vertexCount) {
    refuse(path, "lists vertices of a surface; give the surface whose vertices they are");
  }
  LabelMap labels;
  labels.name = path.stem().string();
  labels.keys.setZero(*vertexCount);
  labels.table = {{0, "outside", {0, 0, 0, 0}}, {1, labels.name, {1, 0, 0, 1}}};
  for (std::size_t i = 0; i < count; ++i) {
    const auto vertex = parseNumber<std::int64_t>(path, cursor.word());
    if (vertex < 0 || vertex >= *vertexCount) {
      refuse(path, "names vertex " + std::to_string(vertex) + "; the surface has " +
                       std::to_string(*vertexCount) + ": is it another surface's label?");
    }
    labels.keys[vertex] = 1;
    for (int k = 0; k < 4; ++k) {
      static_cast<void>(parseNumber<double>(path, cursor.word()));  // x, y, z, value
    }
  }
  return labels;
}

void writeFreeSurferSurface(const std::filesystem::path& path, const TriangleMesh& mesh,
                            const std::optional<Grid>& volume) {
  if (mesh.vertexCount() == 0 || mesh.faceCount() == 0) {
    throw InvalidInput("surface for " + quoted(path) + ": it has no triangles");
  }
  Grid geometry;
  if (volume) {
    geometry = *volume;
  } else {  // conformed axes about 0: surface RAS and scanner RAS are the same
    geometry.size = {256, 256, 256};
    geometry.direction << -1, 0, 0, 0, 0, 1, 0, -1, 0;
    geometry.origin = -geometry.direction * Vector::Constant(128);
  }
  Positions positions = mesh.positions;
  if (volume) {
    const Eigen::Matrix4d tkr = scannerFromTkr(*volume).inverse();
    const Eigen::Matrix3d linear = tkr.topLeftCorner<3, 3>();
    const Eigen::RowVector3d shift = tkr.topRightCorner<3, 1>().transpose();
    positions = (mesh.positions * linear.transpose()).rowwise() + shift;
  }
  Bytes bytes = bytesOf24(kTriangleSurface);
  bytes.reserve(static_cast<std::size_t>(12 * (mesh.vertexCount() + mesh.faceCount())) + 1024);
  appendText(bytes, "created by Explica\n\n");
  append(bytes, static_cast<std::int32_t>(mesh.vertexCount()), true);
  append(bytes, static_cast<std::int32_t>(mesh.faceCount()), true);
  for (Eigen::Index i = 0; i < positions.size(); ++i) {
    append(bytes, static_cast<float>(positions.data()[i]), true);
  }
  for (Eigen::Index i = 0; i < mesh.faces.size(); ++i) append(bytes, mesh.faces.data()[i], true);
  append(bytes, std::int32_t{kTagUseRealRas}, true);
  append(bytes, std::int32_t{0}, true);
  append(bytes, std::int32_t{kTagVolumeGeometry}, true);
  const auto line = [&bytes](const char* key, const Vector& v) {
    appendText(bytes, printed("%s = %.15e %.15e %.15e\n", key, v[0], v[1], v[2]));
  };
  appendText(bytes, "valid = 1  # volume info valid\nfilename = \nvolume = " +
                        std::to_string(geometry.size[0]) + " " + std::to_string(geometry.size[1]) +
                        " " + std::to_string(geometry.size[2]) + "\n");
  line("voxelsize", geometry.spacing);
  line("xras  ", geometry.direction.col(0));
  line("yras  ", geometry.direction.col(1));
  line("zras  ", geometry.direction.col(2));
  line("cras  ",
       geometry.toWorld(0.5 * Vector(geometry.size[0], geometry.size[1], geometry.size[2])));
  writeTextFile(path, textOf(bytes));
}

void rewriteFreeSurferSurface(const std::filesystem::path& path,
                              const std::filesystem::path& original, const Positions& positions,
                              std::span<const std::int32_t> moved) {
  Bytes bytes = ByteSource(original).rest();
  ByteCursor cursor(original, bytes, true);
  if (take24(cursor) != kTriangleSurface) {
    refuse(original, "is no FreeSurfer surface of triangles, so that it cannot be written anew");
  }
  static_cast<void>(cursor.line());
  if (cursor.left() > 0 && bytes[cursor.position()] == '\n') static_cast<void>(cursor.line());
  const auto vertices = cursor.take<std::int32_t>();
  static_cast<void>(cursor.take<std::int32_t>());
  const std::size_t start = cursor.position();
  if (vertices != positions.rows() || cursor.left() < 12 * static_cast<std::size_t>(vertices)) {
    refuse(original, "has " + std::to_string(vertices) + " vertices where " +
                         std::to_string(positions.rows()) + " are to be written");
  }
  for (const std::int32_t v : moved) {
    for (int axis = 0; axis < 3; ++axis) {
      store(bytes.data() + start + 12 * static_cast<std::size_t>(v) + 4 * axis,
            static_cast<float>(positions(v, axis)), true);
    }
  }
  writeTextFile(path, textOf(bytes));
}

void writeFreeSurferCurv(const std::filesystem::path& path, const Eigen::VectorXd& values,
                         Eigen::Index faceCount) {
  Bytes bytes = bytesOf24(kOldQuadSurface);
  append(bytes, static_cast<std::int32_t>(values.size()), true);
  append(bytes, static_cast<std::int32_t>(faceCount), true);
  append(bytes, std::int32_t{1}, true);
  for (const double value : values) append(bytes, static_cast<float>(value), true);
  writeTextFile(path, textOf(bytes));
}

void writeFreeSurferAnnot(const std::filesystem::path& path, const LabelMap& labels) {
  std::vector<LabelEntry> table = labels.table;
  std::map<Label, std::uint32_t> colourOf;
  std::set<std::uint32_t> used;
  for (const LabelEntry& entry : table) {
    const std::uint32_t colour = packed(entry);
    if (!used.insert(colour).second) {
      throw InvalidInput(
          "labels for " + quoted(path) + ": '" + entry.name +
          "' shares its colour with another label; annot files tell labels by colour");
    }
    colourOf[entry.key] = colour;
  }
  // What a file's table lacked is without an entry again: the colour 0.
  std::erase_if(table, [](const LabelEntry& entry) { return entry.key < 0 && packed(entry) == 0; });
  Bytes bytes;
  append(bytes, static_cast<std::int32_t>(labels.keys.size()), true);
  for (Eigen::Index v = 0; v < labels.keys.size(); ++v) {
    const auto found = colourOf.find(labels.keys[v]);
    if (found == colourOf.end()) {
      throw InvalidInput("labels for " + quoted(path) + ": key " + std::to_string(labels.keys[v]) +
                         " at vertex " + std::to_string(v) + " is not in the table of names");
    }
    append(bytes, static_cast<std::int32_t>(v), true);
    append(bytes, found->second, true);
  }
  const auto text = [&bytes](const std::string& word) {
    append(bytes, static_cast<std::int32_t>(word.size() + 1), true);
    appendText(bytes, word);
    bytes.push_back(0);
  };
  const auto count = static_cast<std::int32_t>(table.size());
  append(bytes, std::int32_t{1}, true);
  append(bytes, std::int32_t{-2}, true);
  append(bytes, count, true);
  text("Explica");
  append(bytes, count, true);
  for (std::int32_t e = 0; e < count; ++e) {
    const LabelEntry& entry = table[static_cast<std::size_t>(e)];
    append(bytes, e, true);
    text(entry.name);
    const std::uint32_t colour = packed(entry);
    for (int c = 0; c < 3; ++c) {
      append(bytes, static_cast<std::int32_t>(colour >> 8 * c & 255U), true);
    }
    const float opacity = std::clamp(entry.colour[3], 0.0F, 1.0F);
    append(bytes, static_cast<std::int32_t>(std::lround(255 * (1 - opacity))), true);
  }
  writeTextFile(path, textOf(bytes));
}

}  // namespace explica::io
