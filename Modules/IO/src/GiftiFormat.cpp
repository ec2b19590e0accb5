// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "GiftiFormat.h"

#include "ByteSource.h"
#include "MeshBuilder.h"
#include "PackedFile.h"
#include "StoredVolume.h"
#include "SurfaceFrame.h"
#include "Xml.h"

#include "Explica/Core/WholeFile.h"

#include <Eigen/LU>

#include <cmath>
#include <limits>
#include <set>

namespace explica::io {
namespace {

Metadata metadataOf(const XmlElement& element) {
  Metadata metadata;
  const XmlElement* list = element.child("MetaData");
  if (list == nullptr) return metadata;
  for (const XmlElement& entry : list->children) {
    const XmlElement* name = entry.child("Name");
    const XmlElement* value = entry.child("Value");
    if (name == nullptr || value == nullptr) continue;
    metadata[trimmedText(name->text)] = trimmedText(value->text);
  }
  return metadata;
}

StoredType typeOf(const std::filesystem::path& path, const std::string& name) {
  constexpr std::string_view kPrefix = "NIFTI_TYPE_";
  const auto type =
      name.starts_with(kPrefix) ? typeNamed(name.substr(kPrefix.size())) : std::nullopt;
  if (!type) failToRead(path, "has a GIFTI array of the unknown type '" + name + "'");
  return *type;
}

/// One of two words, in the spelling of the standard or of the programs that write it otherwise.
bool isSecond(const std::filesystem::path& path, const std::string& attribute,
              const std::string& word, std::initializer_list<const char*> first,
              std::initializer_list<const char*> second) {
  const auto among = [&](std::initializer_list<const char*> words) {
    return std::ranges::any_of(words, [&](const char* one) { return word == one; });
  };
  if (among(second)) return true;
  if (!among(first)) {
    failToRead(path, "has a GIFTI array with the unknown " + attribute + " '" + word + "'");
  }
  return false;
}

/// From column-major to row-major order.
std::vector<double> transposed(const std::vector<double>& values, std::int64_t rows) {
  const auto columns = static_cast<std::int64_t>(values.size()) / rows;
  std::vector<double> result(values.size());
  for (std::int64_t row = 0; row < rows; ++row) {
    for (std::int64_t column = 0; column < columns; ++column) {
      result[row * columns + column] = values[column * rows + row];
    }
  }
  return result;
}

Bytes rawValues(const std::filesystem::path& path, const XmlElement& array, const std::string& text,
                std::uint64_t byteCount) {
  const std::string encoding = array["Encoding"];
  Bytes raw;
  if (encoding == "GZipBase64Binary" || encoding == "GIFTI_ENCODING_B64GZ") {
    raw = inflateExactly(path, decodeBase64(path, text), byteCount);
  } else if (encoding == "Base64Binary" || encoding == "GIFTI_ENCODING_B64BIN") {
    raw = decodeBase64(path, text);
  } else if (encoding == "ExternalFileBinary" || encoding == "GIFTI_ENCODING_EXTBIN") {
    const std::filesystem::path external = besideFile(path, array["ExternalFileName"]);
    const std::string offsetText = array["ExternalFileOffset"];
    const auto offset = offsetText.empty() ? 0 : parseNumber<std::int64_t>(path, offsetText);
    if (offset < 0) failToRead(path, "has a GIFTI array that begins before its file");
    ByteSource source(external);
    source.skip(static_cast<std::uint64_t>(offset));
    raw = source.take(byteCount);
  } else {
    failToRead(path, "has a GIFTI array in the unknown encoding '" + encoding + "'");
  }
  if (raw.size() != byteCount) {
    failToRead(path, "has a GIFTI array of " + std::to_string(raw.size()) + " bytes where " +
                         std::to_string(byteCount) + " are announced; it is damaged");
  }
  return raw;
}

GiftiArray parseArray(const std::filesystem::path& path, const XmlElement& element) {
  constexpr std::int64_t kMostValues = std::int64_t{1} << 33;
  GiftiArray array;
  array.intent = element["Intent"];
  array.metadata = metadataOf(element);
  const auto dimensions = parseNumber<int>(path, element["Dimensionality"]);
  if (dimensions < 1 || dimensions > 6) {
    failToRead(path, "has a GIFTI array of " + std::to_string(dimensions) + " dimensions");
  }
  std::int64_t count = 1;
  for (int i = 0; i < dimensions; ++i) {
    const auto size = parseNumber<std::int64_t>(path, element["Dim" + std::to_string(i)]);
    if (size < 0 || (size > 0 && count > kMostValues / size)) {
      failToRead(path, "has a GIFTI array of size " + std::to_string(size));
    }
    count *= size;
    array.size.push_back(size);
  }
  if (const XmlElement* system = element.child("CoordinateSystemTransformMatrix")) {
    if (const XmlElement* space = system->child("DataSpace")) {
      array.dataSpace = trimmedText(space->text);
    }
    if (const XmlElement* matrix = system->child("MatrixData")) {
      ByteCursor cursor(path, matrix->text);
      for (int i = 0; i < 16; ++i) {
        const std::string_view word = cursor.word();
        if (word.empty()) break;
        if (parseNumber<double>(path, word) != (i % 5 == 0 ? 1 : 0)) array.identityMatrix = false;
      }
    }
  }
  const StoredType type = typeOf(path, element["DataType"]);
  const XmlElement* data = element.child("Data");
  static const std::string kNone;
  const std::string& text = data == nullptr ? kNone : data->text;
  const std::string encoding = element["Encoding"];
  if (encoding == "ASCII" || encoding == "GIFTI_ENCODING_ASCII") {
    if (static_cast<std::uint64_t>(count) > text.size() / 2 + 1) {
      failTruncated(path, "has a GIFTI array with fewer numbers than announced");
    }
    array.values.reserve(static_cast<std::size_t>(count));
    ByteCursor cursor(path, text);
    for (std::int64_t i = 0; i < count; ++i) {
      array.values.push_back(parseNumber<double>(path, cursor.word()));
    }
  } else {
    const Bytes raw =
        rawValues(path, element, text, static_cast<std::uint64_t>(count) * widthOf(type));
    const bool bigEndian =
        isSecond(path, "Endian", element["Endian"], {"LittleEndian", "GIFTI_ENDIAN_LITTLE"},
                 {"BigEndian", "GIFTI_ENDIAN_BIG"});
    array.values = realsOf(raw, type, bigEndian);
  }
  const bool columns = isSecond(path, "ArrayIndexingOrder", element["ArrayIndexingOrder"],
                                {"RowMajorOrder", "GIFTI_IND_ORD_ROW_MAJOR", ""},
                                {"ColumnMajorOrder", "GIFTI_IND_ORD_COL_MAJOR"});
  if (columns && array.size.size() == 2 && count > 0) {
    array.values = transposed(array.values, array.size[0]);
  }
  return array;
}

std::vector<LabelEntry> tableOf(const std::filesystem::path& path, const XmlElement& root) {
  std::vector<LabelEntry> table;
  const XmlElement* list = root.child("LabelTable");
  if (list == nullptr) return table;
  for (const XmlElement& label : list->children) {
    LabelEntry entry;
    const std::string key = label["Key"].empty() ? label["Index"] : label["Key"];
    entry.key = parseNumber<Label>(path, key);
    entry.name = trimmedText(label.text);
    const char* channels[] = {"Red", "Green", "Blue", "Alpha"};
    for (std::size_t c = 0; c < 4; ++c) {
      const std::string value = label[channels[c]];
      if (!value.empty()) entry.colour[c] = parseNumber<float>(path, value);
    }
    table.push_back(entry);
  }
  std::ranges::sort(table, {}, &LabelEntry::key);
  return table;
}

GiftiArray* find(GiftiFile& file, std::string_view intent) {
  for (GiftiArray& array : file.arrays) {
    if (array.intent == intent) return &array;
  }
  return nullptr;
}

GiftiArray& needColumns(const std::filesystem::path& path, GiftiFile& file, const char* intent,
                        const char* what) {
  GiftiArray* array = find(file, intent);
  if (array == nullptr) {
    refuse(path, std::string("is GIFTI without ") + what + "; a surface (.surf.gii) is needed");
  }
  if (array->size.size() != 2 || array->size[1] != 3) {
    failToRead(path, std::string("its ") + what + " are not three a row");
  }
  return *array;
}

std::string valueOr(const Metadata& metadata, const char* key, const std::string& other = {}) {
  const auto found = metadata.find(key);
  return found == metadata.end() ? other : found->second;
}

/// The volume that mris_convert describes with a surface, if all keys are there.
std::optional<Grid> volumeOf(const std::filesystem::path& path, const Metadata& metadata) {
  VolumeText text;
  const auto read = [&](const char* key, double& to) {
    const auto found = metadata.find(key);
    if (found == metadata.end()) return false;
    to = parseNumber<double>(path, found->second);
    return true;
  };
  bool whole = read("VolGeomWidth", text.size[0]) && read("VolGeomHeight", text.size[1]) &&
               read("VolGeomDepth", text.size[2]) && read("VolGeomXsize", text.spacing[0]) &&
               read("VolGeomYsize", text.spacing[1]) && read("VolGeomZsize", text.spacing[2]);
  const char axes[] = {'X', 'Y', 'Z', 'C'};
  const char letters[] = {'R', 'A', 'S'};
  for (int axis = 0; axis < 4 && whole; ++axis) {
    for (int row = 0; row < 3; ++row) {
      const std::string key = std::string("VolGeom") + axes[axis] + "_" + letters[row];
      double& to = axis < 3 ? text.axes(row, axis) : text.centre[row];
      whole = whole && read(key.c_str(), to);
    }
  }
  if (!whole) return {};
  return gridOfVolumeText(path, text);
}

std::string spaceWord(const std::string& dataSpace) {
  constexpr std::string_view kPrefix = "NIFTI_XFORM_";  // of the names of frames
  std::string word = dataSpace.starts_with(kPrefix) ? dataSpace.substr(kPrefix.size()) : dataSpace;
  return word.empty() ? "UNKNOWN" : word;
}

void appendMetadata(std::string& text, const Metadata& metadata) {
  text += "<MetaData>";
  for (const auto& [name, value] : metadata) {
    if (value.empty()) continue;
    text +=
        "\n<MD><Name>" + escapedXml(name) + "</Name><Value>" + escapedXml(value) + "</Value></MD>";
  }
  text += "</MetaData>\n";
}

struct ArrayToWrite {
  const char* intent;
  const char* type;
  std::vector<std::int64_t> size;
  Metadata metadata;
  bool placed = false;  ///< carries the coordinate system
  ByteView bytes;
};

void appendArray(std::string& text, const ArrayToWrite& array) {
  text += std::string("<DataArray Intent=\"") + array.intent + "\" DataType=\"" + array.type +
          "\" ArrayIndexingOrder=\"RowMajorOrder\" Dimensionality=\"" +
          std::to_string(array.size.size()) + "\"";
  for (std::size_t i = 0; i < array.size.size(); ++i) {
    text += " Dim" + std::to_string(i) + "=\"" + std::to_string(array.size[i]) + "\"";
  }
  text +=
      " Encoding=\"GZipBase64Binary\" Endian=\"LittleEndian\" ExternalFileName=\"\" "
      "ExternalFileOffset=\"\">\n";
  appendMetadata(text, array.metadata);
  if (array.placed) {
    text +=
        "<CoordinateSystemTransformMatrix>\n<DataSpace>NIFTI_XFORM_SCANNER_ANAT</DataSpace>\n"
        "<TransformedSpace>NIFTI_XFORM_SCANNER_ANAT</TransformedSpace>\n<MatrixData>1 0 0 0\n0 1 0 "
        "0\n0 0 1 0\n0 0 0 1</MatrixData>\n</CoordinateSystemTransformMatrix>\n";
  }
  text += "<Data>";
  text += base64(textOf(packZlib(array.bytes)));
  text += "</Data>\n</DataArray>\n";
}

std::string opening(std::size_t arrays, const Metadata& metadata, const std::string& table) {
  std::string text =
      R"(<?xml version="1.0" encoding="UTF-8"?>
<!DOCTYPE GIFTI SYSTEM "http://www.nitrc.org/frs/download.php/115/gifti.dtd">
<GIFTI Version="1.0" NumberOfDataArrays=")" +
      std::to_string(arrays) + "\">\n";
  appendMetadata(text, metadata);
  return text + table;
}

void writeText(const std::filesystem::path& path, const std::string& text) {
  if (path.extension() != ".gz") {
    writeTextFile(path, text);
    return;
  }
  Content content;
  content.head.assign(text.begin(), text.end());
  WholeFile file(path);
  writeGzip(file, content);
  file.commit();
}

template <class T>
ByteView viewOf(std::span<const T> values) {
  return {reinterpret_cast<const std::uint8_t*>(values.data()), values.size_bytes()};
}

/// True if each side of a face is shared with a face that runs it the other way.
bool isClosed(const Faces& faces) {
  // Both ends, the lesser first, and the direction: an even number marks the falling one.
  std::vector<std::uint64_t> sides;
  sides.reserve(static_cast<std::size_t>(faces.size()));
  for (Eigen::Index f = 0; f < faces.rows(); ++f) {
    for (int k = 0; k < 3; ++k) {
      const auto [low, high] = std::minmax(faces(f, k), faces(f, (k + 1) % 3));
      sides.push_back(static_cast<std::uint64_t>(low) << 32 |
                      static_cast<std::uint64_t>(high) << 1 |
                      static_cast<std::uint64_t>(faces(f, k) < faces(f, (k + 1) % 3)));
    }
  }
  std::ranges::sort(sides);
  bool closed = sides.size() % 2 == 0;
  for (std::size_t n = 0; closed && n < sides.size(); n += 2) {
    closed = sides[n] % 2 == 0 && sides[n + 1] == sides[n] + 1;
  }
  return closed;
}

}  // namespace

bool looksLikeGifti(ByteView bytes) {
  constexpr std::size_t kFarEnough = 4096;  // bytes in which the root element begins
  const std::string_view text = textOf(bytes).substr(0, kFarEnough);
  return text.find("<GIFTI") != std::string_view::npos ||
         text.find("<!DOCTYPE GIFTI") != std::string_view::npos;
}

GiftiFile parseGifti(const std::filesystem::path& path, ByteView bytes) {
  XmlElement root = parseXml(path, textOf(bytes));
  if (root.name != "GIFTI") failToRead(path, "is XML, but not GIFTI");
  GiftiFile file;
  file.metadata = metadataOf(root);
  file.table = tableOf(path, root);
  for (XmlElement& child : root.children) {
    if (child.name == "DataArray") file.arrays.push_back(parseArray(path, child));
    child = {};  // its text is as long as its values
  }
  return file;
}

LoadedSurface readGiftiSurface(const std::filesystem::path& path, ByteView bytes,
                               const SurfaceReadOptions& options) {
  GiftiFile file = parseGifti(path, bytes);
  GiftiArray& points = needColumns(path, file, "NIFTI_INTENT_POINTSET", "points");
  GiftiArray& faces = needColumns(path, file, "NIFTI_INTENT_TRIANGLE", "triangles");
  MeshBuilder builder;
  builder.coordinates = std::move(points.values);
  builder.triangles.reserve(faces.values.size());
  for (const double corner : faces.values) {
    const bool whole = std::abs(corner) < 1e15 && std::trunc(corner) == corner;
    builder.triangles.push_back(whole ? MeshBuilder::vertexNumber(static_cast<std::int64_t>(corner))
                                      : -1);
  }
  std::vector<double>().swap(faces.values);
  LoadedSurface surface = builder.finish(path, "GIFTI");
  surface.metadata.structure =
      valueOr(points.metadata, "AnatomicalStructurePrimary",
              valueOr(file.metadata, "AnatomicalStructurePrimary", surface.metadata.structure));
  setTypesFromName(path, surface.metadata);
  surface.metadata.secondary =
      valueOr(points.metadata, "AnatomicalStructureSecondary", surface.metadata.secondary);
  surface.metadata.geometricType =
      valueOr(points.metadata, "GeometricType", surface.metadata.geometricType);
  if (surface.metadata.geometricType == "Sphere") {  // FreeSurfer's word
    surface.metadata.geometricType = "Spherical";
  }
  surface.metadata.topologicalType = valueOr(faces.metadata, "TopologicalType");
  surface.metadata.name = valueOr(points.metadata, "Name");
  surface.metadata.extra = file.metadata;
  surface.metadata.extra.erase("AnatomicalStructurePrimary");
  if (!points.identityMatrix) {
    surface.origin.notes.push_back(
        "the matrix of the file is not applied to its coordinates, as in Workbench and nibabel");
  }
  FrameInFile frame;
  const std::string space = spaceWord(points.dataSpace);
  frame.stated = space == "UNKNOWN" ? std::string() : space;
  if (frame.stated.empty()) frame.tkrVolume = volumeOf(path, points.metadata);
  moveToScanner(surface, frame, options);
  return surface;
}

std::vector<VertexMap> readGiftiMaps(const std::filesystem::path& path, ByteView bytes) {
  std::vector<VertexMap> maps;
  for (const GiftiArray& array : parseGifti(path, bytes).arrays) {
    if (array.intent == "NIFTI_INTENT_POINTSET" || array.intent == "NIFTI_INTENT_TRIANGLE")
      continue;
    const std::int64_t rows = array.size[0];
    const std::int64_t columns =
        rows == 0 ? 0 : static_cast<std::int64_t>(array.values.size()) / rows;
    addColumns(maps, valueOr(array.metadata, "Name"), valueOr(array.metadata, "Explica:Unit"),
               array.values, static_cast<std::size_t>(columns));
  }
  return maps;
}

LabelMap readGiftiLabels(const std::filesystem::path& path, ByteView bytes) {
  GiftiFile file = parseGifti(path, bytes);
  const GiftiArray* array = find(file, "NIFTI_INTENT_LABEL");
  for (const GiftiArray& candidate : file.arrays) {  // some writers give labels another intent
    const bool mesh =
        candidate.intent == "NIFTI_INTENT_POINTSET" || candidate.intent == "NIFTI_INTENT_TRIANGLE";
    if (array == nullptr && !mesh) array = &candidate;
  }
  if (array == nullptr) refuse(path, "is GIFTI without labels");
  LabelMap labels;
  labels.name = valueOr(array->metadata, "Name");
  labels.table = file.table;
  labels.keys.resize(array->size[0]);
  if (array->values.size() != static_cast<std::size_t>(labels.keys.size())) {
    refuse(path, "holds several labels a vertex; one is needed");
  }
  for (Eigen::Index v = 0; v < labels.keys.size(); ++v) {
    const double value = array->values[v];
    if (!(std::abs(value) <= std::numeric_limits<Label>::max() && std::trunc(value) == value)) {
      refuse(path, "vertex " + std::to_string(v) +
                       " has a value that is no whole number; labels are needed");
    }
    labels.keys[v] = static_cast<Label>(value);
  }
  return labels;
}

void writeGiftiSurface(const std::filesystem::path& path, const TriangleMesh& mesh,
                       const SurfaceMetadata& metadata) {
  if (mesh.vertexCount() == 0 || mesh.faceCount() == 0) {
    throw InvalidInput("surface for " + quoted(path) + ": it has no triangles");
  }
  Metadata ofFile = metadata.extra;
  ofFile["AnatomicalStructurePrimary"] = metadata.structure;
  std::string text = opening(2, ofFile, "<LabelTable/>\n");

  std::vector<float> positions(static_cast<std::size_t>(mesh.positions.size()));
  for (std::size_t i = 0; i < positions.size(); ++i) {
    positions[i] = static_cast<float>(mesh.positions.data()[i]);
  }
  appendArray(text, {"NIFTI_INTENT_POINTSET",
                     "NIFTI_TYPE_FLOAT32",
                     {mesh.vertexCount(), 3},
                     {{"AnatomicalStructurePrimary", metadata.structure},
                      {"AnatomicalStructureSecondary", metadata.secondary},
                      {"GeometricType", metadata.geometricType},
                      {"Name", metadata.name}},
                     true,
                     viewOf(std::span<const float>(positions))});
  const std::string topology = !metadata.topologicalType.empty() ? metadata.topologicalType
                               : isClosed(mesh.faces)            ? "Closed"
                                                                 : "Open";
  const std::span faces(mesh.faces.data(), static_cast<std::size_t>(mesh.faces.size()));
  appendArray(text, {"NIFTI_INTENT_TRIANGLE",
                     "NIFTI_TYPE_INT32",
                     {mesh.faceCount(), 3},
                     {{"TopologicalType", topology}},
                     false,
                     viewOf(faces)});
  writeText(path, text + "</GIFTI>\n");
}

Eigen::Index writeGiftiShape(const std::filesystem::path& path, const std::vector<VertexMap>& maps,
                             const std::string& structure) {
  if (maps.empty()) throw InvalidInput("per-vertex maps for " + quoted(path) + ": there are none");
  std::string text =
      opening(maps.size(), {{"AnatomicalStructurePrimary", structure}}, "<LabelTable/>\n");
  Eigen::Index replaced = 0;
  for (const VertexMap& map : maps) {
    if (map.values.size() != maps.front().values.size()) {
      throw InvalidInput("per-vertex maps for " + quoted(path) + ": '" + map.name + "' has " +
                         std::to_string(map.values.size()) + " values and '" + maps.front().name +
                         "' " + std::to_string(maps.front().values.size()));
    }
    std::vector<float> values(static_cast<std::size_t>(map.values.size()));
    for (Eigen::Index v = 0; v < map.values.size(); ++v) {
      const auto value = static_cast<float>(map.values[v]);
      replaced += !std::isfinite(value);
      values[v] = std::isfinite(value) ? value : 0;
    }
    appendArray(text, {"NIFTI_INTENT_SHAPE",
                       "NIFTI_TYPE_FLOAT32",
                       {map.values.size()},
                       {{"Name", map.name}, {"Explica:Unit", map.unit}},
                       false,
                       viewOf(std::span<const float>(values))});
  }
  writeText(path, text + "</GIFTI>\n");
  return replaced;
}

struct GiftiMapsWriter::State {
  std::filesystem::path path;
  WholeFile file;
  std::size_t announced = 0, added = 0;
  std::optional<double> secondsApart;
};

GiftiMapsWriter::GiftiMapsWriter(const std::filesystem::path& path, const std::string& structure,
                                 std::size_t mapCount, std::optional<double> secondsApart)
    : state_(new State{path, WholeFile(path), mapCount, 0, secondsApart}) {
  Metadata metadata = {{"AnatomicalStructurePrimary", structure}};
  if (secondsApart) {
    std::string step;
    appendNumber(step, 1000 * *secondsApart);
    metadata["TimeStep"] = step;  // milliseconds, as HCP and fMRIPrep write it
  }
  state_->file.write(opening(mapCount, metadata, "<LabelTable/>\n"));
}

GiftiMapsWriter::~GiftiMapsWriter() = default;
GiftiMapsWriter::GiftiMapsWriter(GiftiMapsWriter&&) noexcept = default;

void GiftiMapsWriter::add(const std::string& name, const std::string& unit,
                          std::span<const float> values) {
  std::string text;
  appendArray(text, {state_->secondsApart ? "NIFTI_INTENT_TIME_SERIES" : "NIFTI_INTENT_NONE",
                     "NIFTI_TYPE_FLOAT32",
                     {static_cast<std::int64_t>(values.size())},
                     {{"Name", name}, {"Explica:Unit", unit}},
                     false,
                     viewOf(values)});
  state_->file.write(text);
  ++state_->added;
}

void GiftiMapsWriter::finish() {
  if (state_->added != state_->announced) {
    throw InvalidInput("maps for " + quoted(state_->path) + ": " + std::to_string(state_->added) +
                       " were written and " + std::to_string(state_->announced) + " announced");
  }
  state_->file.write("</GIFTI>\n");
  state_->file.commit();
}

std::string labelTableXml(const std::vector<LabelEntry>& table) {
  std::string text = "<LabelTable>\n";
  for (const LabelEntry& entry : table) {
    text += "<Label Key=\"" + std::to_string(entry.key) + "\"";
    const char* channels[] = {"Red", "Green", "Blue", "Alpha"};
    for (std::size_t c = 0; c < 4; ++c) {
      text += std::string(" ") + channels[c] + "=\"";
      appendNumber(text, entry.colour[c]);
      text += "\"";
    }
    text += ">" + escapedXml(entry.name) + "</Label>\n";
  }
  return text + "</LabelTable>\n";
}

void writeGiftiLabel(const std::filesystem::path& path, const LabelMap& labels,
                     const std::string& structure) {
  std::set<Label> known;
  for (const LabelEntry& entry : labels.table) known.insert(entry.key);
  std::vector<std::int32_t> keys(static_cast<std::size_t>(labels.keys.size()));
  for (Eigen::Index v = 0; v < labels.keys.size(); ++v) {
    if (!known.contains(labels.keys[v])) {
      throw InvalidInput("labels for " + quoted(path) + ": key " + std::to_string(labels.keys[v]) +
                         " at vertex " + std::to_string(v) + " is not in the table of names");
    }
    keys[v] = labels.keys[v];
  }
  std::string text =
      opening(1, {{"AnatomicalStructurePrimary", structure}}, labelTableXml(labels.table));
  appendArray(text, {"NIFTI_INTENT_LABEL",
                     "NIFTI_TYPE_INT32",
                     {labels.keys.size()},
                     {{"Name", labels.name}},
                     false,
                     viewOf(std::span<const std::int32_t>(keys))});
  writeText(path, text + "</GIFTI>\n");
}

}  // namespace explica::io
