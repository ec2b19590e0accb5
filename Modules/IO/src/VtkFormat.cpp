// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "VtkFormat.h"

#include "ByteSource.h"
#include "MeshBuilder.h"
#include "StoredVolume.h"
#include "SurfaceFrame.h"
#include "Xml.h"

namespace explica::io {
namespace {

// Names in legacy files.
constexpr std::pair<std::string_view, StoredType> kLegacyTypes[] = {
    {"float", StoredType::Float32},       {"double", StoredType::Float64},
    {"int", StoredType::Int32},           {"vtktypeint64", StoredType::Int64},
    {"vtkIdType", StoredType::Int32},     {"long", StoredType::Int64},
    {"unsigned_int", StoredType::UInt32}, {"unsigned_long", StoredType::UInt64},
    {"short", StoredType::Int16},         {"unsigned_short", StoredType::UInt16},
    {"char", StoredType::Int8},           {"signed_char", StoredType::Int8},
    {"unsigned_char", StoredType::UInt8}, {"vtktypeuint64", StoredType::UInt64}};

std::vector<std::int64_t> wholeOf(const std::filesystem::path& path, std::vector<double> values) {
  std::vector<std::int64_t> whole;
  whole.reserve(values.size());
  for (const double value : values) whole.push_back(wholeNumber(path, value));
  return whole;
}

/// Checks that the offsets rise from 0 to the length of the connectivity.
void checkCells(const std::filesystem::path& path, const CellList& cells) {
  bool rising = !cells.offsets.empty() && cells.offsets.front() == 0 &&
                cells.offsets.back() == static_cast<std::int64_t>(cells.connectivity.size());
  for (std::size_t c = 1; c < cells.offsets.size(); ++c) {
    rising = rising && cells.offsets[c] >= cells.offsets[c - 1];
  }
  if (!rising) failToRead(path, "has cells whose offsets do not fit; it is damaged");
}

/// The legacy format: keywords and values, text or big-endian binary.
class LegacyReader {
 public:
  LegacyReader(const std::filesystem::path& path, ByteView bytes)
      : path_(path), cursor_(path, bytes, true) {}

  PolyData read() {
    static_cast<void>(cursor_.line());  // version
    static_cast<void>(cursor_.line());  // title
    const std::string_view encoding = cursor_.word();
    if (encoding != "ASCII" && encoding != "BINARY") {
      failToRead(path_, "is neither ASCII nor BINARY, as VTK files are");
    }
    text_ = encoding == "ASCII";
    if (cursor_.word() != "DATASET") failToRead(path_, "names no VTK dataset");
    const std::string_view dataset = cursor_.word();
    if (dataset != "POLYDATA") {
      refuse(path_, "is a VTK " + std::string(dataset.substr(0, 40)) + "; POLYDATA is needed");
    }
    while (true) {
      const std::string_view keyword = cursor_.word();
      if (keyword.empty()) break;
      section(keyword);
    }
    return std::move(data_);
  }

 private:
  void section(std::string_view keyword) {
    if (keyword == "POINTS") {
      const std::int64_t count = whole();
      data_.coordinates = values(count, 3, typeOf(cursor_.word()));
    } else if (keyword == "LINES") {
      data_.lines = cells();
    } else if (keyword == "POLYGONS") {
      data_.polygons = cells();
    } else if (keyword == "TRIANGLE_STRIPS") {
      data_.strips = cells();
    } else if (keyword == "VERTICES") {
      static_cast<void>(cells());
    } else if (keyword == "POINT_DATA" || keyword == "CELL_DATA") {
      rows_ = whole();
      ofPoints_ = keyword == "POINT_DATA";
    } else if (keyword == "SCALARS") {
      scalars();
    } else if (keyword == "COLOR_SCALARS") {
      const std::string name(cursor_.word());
      const std::int64_t components = whole();
      keep(name, values(rows_, components, typeOf(text_ ? "float" : "unsigned_char")), components);
    } else if (keyword == "LOOKUP_TABLE") {
      static_cast<void>(cursor_.word());
      const std::int64_t entries = whole();
      static_cast<void>(values(entries, 4, typeOf(text_ ? "float" : "unsigned_char")));
    } else if (keyword == "VECTORS" || keyword == "NORMALS" || keyword == "TENSORS" ||
               keyword == "TEXTURE_COORDINATES") {
      const std::string name(cursor_.word());
      const std::int64_t components = keyword == "TEXTURE_COORDINATES" ? whole()
                                      : keyword == "TENSORS"           ? 9
                                                                       : 3;
      keep(name, values(rows_, components, typeOf(cursor_.word())), components);
    } else if (keyword == "FIELD") {
      field();
    } else if (keyword == "METADATA") {
      skipMetadata();
    } else {
      failToRead(path_, "has the unknown VTK section '" + std::string(keyword.substr(0, 40)) + "'");
    }
  }

  std::int64_t whole() { return parseNumber<std::int64_t>(path_, cursor_.word()); }

  StoredType typeOf(std::string_view word) const {
    for (const auto& [name, type] : kLegacyTypes) {
      if (name == word) return type;
    }
    failToRead(path_, "has the unknown VTK type '" + std::string(word.substr(0, 40)) + "'");
  }

  std::vector<double> values(std::int64_t rows, std::int64_t columns, StoredType type) {
    constexpr std::int64_t kMostColumns = 1024;  // of a map; beyond it a header is damaged
    if (columns < 1 || columns > kMostColumns) failToRead(path_, "has arrays of no sensible width");
    if (!text_) static_cast<void>(cursor_.line());
    const std::size_t each = static_cast<std::size_t>(columns) * (text_ ? 2 : widthOf(type));
    const std::size_t count = checkedCount(path_, rows, cursor_.left() + 1, each, "values") *
                              static_cast<std::size_t>(columns);
    if (!text_) return realsOf(cursor_.view(count * widthOf(type)), type, true);
    std::vector<double> result(count);
    for (double& value : result) {
      const std::string_view word = cursor_.word();
      value = parseNumber<double>(path_, word == "NaN" ? "nan" : word);
    }
    return result;
  }

  CellList cells() {
    const std::int64_t first = whole();
    const std::int64_t second = whole();
    CellList list;
    const std::size_t before = cursor_.position();
    if (cursor_.word() == "OFFSETS") {  // version 5: offsets, then connectivity
      list.offsets = wholeOf(path_, values(first, 1, typeOf(cursor_.word())));
      if (list.offsets.empty()) list.offsets = {0};
      if (cursor_.word() != "CONNECTIVITY") failToRead(path_, "has cells without connectivity");
      list.connectivity = wholeOf(path_, values(second, 1, typeOf(cursor_.word())));
    } else {  // each cell: its length and its vertices
      cursor_.moveTo(before);
      const std::vector<std::int64_t> all = wholeOf(path_, values(second, 1, typeOf("int")));
      std::size_t at = 0;
      for (std::int64_t c = 0; c < first; ++c) {
        if (at >= all.size() || all[at] < 0 ||
            static_cast<std::size_t>(all[at]) > all.size() - at - 1) {
          failToRead(path_, "has cells that do not fit their announced size; it is damaged");
        }
        const auto length = static_cast<std::size_t>(all[at]);
        list.connectivity.insert(list.connectivity.end(), all.begin() + at + 1,
                                 all.begin() + at + 1 + length);
        list.offsets.push_back(static_cast<std::int64_t>(list.connectivity.size()));
        at += 1 + length;
      }
    }
    checkCells(path_, list);
    return list;
  }

  void scalars() {
    const std::string name(cursor_.word());
    const StoredType type = typeOf(cursor_.word());
    std::int64_t components = 1;
    std::size_t before = cursor_.position();
    std::string_view next = cursor_.word();
    if (next != "LOOKUP_TABLE") {
      components = parseNumber<std::int64_t>(path_, next);
      before = cursor_.position();
      next = cursor_.word();
    }
    if (next == "LOOKUP_TABLE") {
      static_cast<void>(cursor_.word());
    } else {
      cursor_.moveTo(before);
    }
    keep(name, values(rows_, components, type), components);
  }

  void field() {
    static_cast<void>(cursor_.word());
    const std::int64_t arrays = whole();
    for (std::int64_t a = 0; a < arrays; ++a) {
      std::string name(cursor_.word());
      if (name == "METADATA") {
        skipMetadata();
        name = cursor_.word();
      }
      if (name.empty()) failTruncated(path_, "the file ends too early");
      const std::int64_t components = whole();
      const std::int64_t rows = whole();
      const std::string_view type = cursor_.word();
      if (type == "string") {
        static_cast<void>(cursor_.line());
        for (std::int64_t row = 0; row < rows && cursor_.left() > 0; ++row) {
          static_cast<void>(cursor_.line());
        }
        continue;
      }
      const std::vector<double> all = values(rows, components, typeOf(type));
      if (rows_ < 0) {
        data_.saysRas = data_.saysRas || (name == "SpaceRAS" && all.size() == 1 && all[0] == 1);
      } else if (rows == rows_) {
        keep(name, all, components);
      }
    }
  }

  /// A block that ends with an empty line.
  void skipMetadata() {
    static_cast<void>(cursor_.line());
    while (cursor_.left() > 0 && !cursor_.line().empty()) {
    }
  }

  void keep(const std::string& name, const std::vector<double>& all, std::int64_t components) {
    if (ofPoints_) addColumns(data_.pointMaps, name, "", all, static_cast<std::size_t>(components));
  }

  const std::filesystem::path& path_;
  ByteCursor cursor_;
  PolyData data_;
  bool text_ = false;
  bool ofPoints_ = false;
  std::int64_t rows_ = -1;
};

/// The XML format: arrays as text, base64, or appended after the document.
class XmlReader {
 public:
  XmlReader(const std::filesystem::path& path, ByteView bytes) : path_(path) {
    // Raw appended data are no XML: cut them out before parsing.
    const std::string_view text = textOf(bytes);
    const std::size_t tag = text.find("<AppendedData");
    if (tag == std::string_view::npos) {
      root_ = parseXml(path, text);
      return;
    }
    const std::size_t end = text.find('>', tag);
    const std::size_t start = end == std::string_view::npos ? end : text.find('_', end);
    if (start == std::string_view::npos) failTruncated(path, "the file ends too early");
    appended_ = bytes.subspan(start + 1);
    const std::string_view opening = text.substr(tag, end - tag);
    appendedRaw_ = opening.find("\"raw\"") != std::string_view::npos;
    root_ = parseXml(path, std::string(text.substr(0, tag)) + "</VTKFile>");
  }

  PolyData read() {
    if (root_.name != "VTKFile") failToRead(path_, "is XML, but no VTK file");
    if (root_["type"] != "PolyData") {
      refuse(path_, "is a VTK " + root_["type"] + "; PolyData is needed");
    }
    bigEndian_ = root_["byte_order"] == "BigEndian";
    wideHeaders_ = root_["header_type"] == "UInt64";
    const std::string compressor = root_["compressor"];
    packed_ = !compressor.empty();
    if (packed_ && compressor != "vtkZLibDataCompressor") {
      refuse(path_, "is packed by " + compressor + "; save it with zlib or without compression");
    }
    const XmlElement* poly = root_.child("PolyData");
    if (poly == nullptr) failToRead(path_, "holds no PolyData");
    PolyData data;
    if (const XmlElement* fields = poly->child("FieldData")) {
      for (const XmlElement& array : fields->children) {
        if (array["Name"] != "SpaceRAS") continue;
        const std::vector<double> values = valuesOf(array);
        data.saysRas = values.size() == 1 && values[0] == 1;
      }
    }
    std::size_t pieces = 0;
    for (const XmlElement& piece : poly->children) {
      if (piece.name != "Piece") continue;
      if (++pieces > 1) {
        refuse(path_, "holds several pieces; merge them to one (ParaView: Clean)");
      }
      addPiece(piece, data);
    }
    return data;
  }

 private:
  void addPiece(const XmlElement& piece, PolyData& data) const {
    if (const XmlElement* points = piece.child("Points")) {
      const XmlElement* array = points->child("DataArray");
      if (array != nullptr) data.coordinates = valuesOf(*array);
    }
    data.lines = cellsOf(piece, "Lines");
    data.polygons = cellsOf(piece, "Polys");
    data.strips = cellsOf(piece, "Strips");
    const XmlElement* maps = piece.child("PointData");
    if (maps == nullptr) return;
    const std::size_t points = data.coordinates.size() / 3;
    for (const XmlElement& array : maps->children) {
      if (array.name != "DataArray") continue;
      const std::vector<double> values = valuesOf(array);
      const std::string components = array["NumberOfComponents"];
      const auto width = components.empty() ? 1 : parseNumber<std::int64_t>(path_, components);
      if (width < 1 || values.size() != static_cast<std::size_t>(width) * points) {
        failToRead(path_, "has a point array '" + array["Name"] + "' of the wrong length");
      }
      addColumns(data.pointMaps, array["Name"], "", values, static_cast<std::size_t>(width));
    }
  }

  CellList cellsOf(const XmlElement& piece, const char* name) const {
    CellList cells;
    const XmlElement* element = piece.child(name);
    if (element == nullptr) return cells;
    for (const XmlElement& array : element->children) {
      if (array["Name"] == "connectivity") cells.connectivity = wholesOf(array);
      if (array["Name"] == "offsets") {
        const std::vector<std::int64_t> ends = wholesOf(array);
        cells.offsets.insert(cells.offsets.end(), ends.begin(), ends.end());
      }
    }
    checkCells(path_, cells);
    return cells;
  }

  /// Numbers of vertices or cells; as doubles they would take as much again.
  std::vector<std::int64_t> wholesOf(const XmlElement& array) const {
    if (array["type"] == "Int64" && array["format"] != "ascii" && !array["format"].empty()) {
      const Bytes raw = rawOf(array);
      std::vector<std::int64_t> values(raw.size() / sizeof(std::int64_t));
      for (std::size_t i = 0; i < values.size(); ++i) {
        values[i] = load<std::int64_t>(raw.data() + i * sizeof(std::int64_t), bigEndian_);
      }
      return values;
    }
    return wholeOf(path_, valuesOf(array));
  }

  std::vector<double> valuesOf(const XmlElement& array) const {
    const std::string format = array["format"];
    if (format == "ascii" || format.empty()) {
      std::vector<double> values;
      ByteCursor cursor(path_, array.text);
      for (std::string_view word = cursor.word(); !word.empty(); word = cursor.word()) {
        values.push_back(parseNumber<double>(path_, word));
      }
      return values;
    }
    const auto type = typeNamed(array["type"]);
    if (!type) failToRead(path_, "has the unknown VTK type '" + array["type"] + "'");
    return realsOf(rawOf(array), *type, bigEndian_);
  }

  /// The bytes of an array that is no text.
  Bytes rawOf(const XmlElement& array) const {
    const std::string format = array["format"];
    if (format == "appended") {
      const auto offset = parseNumber<std::int64_t>(path_, array["offset"]);
      if (offset < 0 || static_cast<std::size_t>(offset) >= appended_.size()) {
        failTruncated(path_, "the appended data end too early");
      }
      const ByteView from = appended_.subspan(static_cast<std::size_t>(offset));
      return appendedRaw_ ? rawBlock(from) : base64Block(textOf(from));
    }
    if (format == "binary") return base64Block(trimmedText(array.text));
    failToRead(path_, "has an array in the unknown format '" + format + "'");
  }

  [[nodiscard]] std::size_t headerWidth() const { return wideHeaders_ ? 8 : 4; }
  std::uint64_t headerNumber(ByteCursor& cursor) const {
    return wideHeaders_ ? cursor.take<std::uint64_t>() : cursor.take<std::uint32_t>();
  }

  /// A block of bytes with its header before it.
  Bytes rawBlock(ByteView from) const {
    ByteCursor cursor(path_, from, bigEndian_);
    const std::uint64_t first = headerNumber(cursor);
    if (!packed_) {
      const ByteView bytes = cursor.view(first);
      return {bytes.begin(), bytes.end()};
    }
    const std::vector<std::uint64_t> sizes = blockSizes(first, cursor);
    return unpacked(sizes, cursor);
  }

  /// Base64 encodes the header of packed data for itself; that of plain data may go with them.
  Bytes base64Block(std::string_view text) const {
    const auto charactersFor = [](std::size_t bytes) { return (bytes + 2) / 3 * 4; };
    text = text.substr(0, text.find_first_not_of(std::string(kBase64) + "="));
    // The number at the beginning of some bytes: what follows is no longer than the text.
    const auto count = [&](const Bytes& header) {
      ByteCursor cursor(path_, header, bigEndian_);
      const std::uint64_t number = headerNumber(cursor);
      if (number > text.size()) failTruncated(path_, "an array ends too early");
      return number;
    };
    if (!packed_) {
      const std::string_view start = text.substr(0, charactersFor(headerWidth()));
      const std::uint64_t size = count(decodeBase64(path_, start));
      if (start.find('=') == std::string_view::npos) {
        return rawBlock(decodeBase64(path_, text.substr(0, charactersFor(headerWidth() + size))));
      }
      Bytes body = decodeBase64(path_, text.substr(start.size(), charactersFor(size)));
      if (body.size() < size) failTruncated(path_, "an array ends too early");
      body.resize(size);
      return body;
    }
    const std::uint64_t blocks =
        count(decodeBase64(path_, text.substr(0, charactersFor(3 * headerWidth()))));
    const std::size_t whole = charactersFor((3 + blocks) * headerWidth());
    Bytes bytes = decodeBase64(path_, text.substr(0, whole));
    const Bytes body = decodeBase64(path_, text.substr(std::min(whole, text.size())));
    ByteCursor cursor(path_, bytes, bigEndian_);
    const std::vector<std::uint64_t> sizes = blockSizes(headerNumber(cursor), cursor);
    ByteCursor bodyCursor(path_, body, bigEndian_);
    return unpacked(sizes, bodyCursor);
  }

  /// Unpacked and packed sizes of blocks: u0, p0, u1, p1, ...
  std::vector<std::uint64_t> blockSizes(std::uint64_t blocks, ByteCursor& cursor) const {
    const std::uint64_t size = headerNumber(cursor);
    const std::uint64_t lastSize = headerNumber(cursor);
    const std::size_t count = checkedCount(path_, static_cast<std::int64_t>(blocks), cursor.left(),
                                           headerWidth(), "blocks");
    std::vector<std::uint64_t> sizes;
    for (std::size_t b = 0; b < count; ++b) {
      sizes.push_back(b + 1 == count && lastSize > 0 ? lastSize : size);
      sizes.push_back(headerNumber(cursor));
    }
    return sizes;
  }

  Bytes unpacked(const std::vector<std::uint64_t>& sizes, ByteCursor& cursor) const {
    Bytes all;
    for (std::size_t b = 0; b < sizes.size(); b += 2) {
      const Bytes block = inflateExactly(path_, cursor.view(sizes[b + 1]), sizes[b]);
      all.insert(all.end(), block.begin(), block.end());
    }
    return all;
  }

  const std::filesystem::path& path_;
  XmlElement root_;
  ByteView appended_;
  bool appendedRaw_ = false;
  bool bigEndian_ = false;
  bool wideHeaders_ = false;
  bool packed_ = false;
};

}  // namespace

bool looksLikeVtkLegacy(ByteView bytes) {
  return textOf(bytes).starts_with("# vtk DataFile") || textOf(bytes).starts_with("#vtk DataFile");
}

bool looksLikeVtkXml(ByteView bytes) {
  constexpr std::size_t kFarEnough = 1024;  // bytes in which the root element begins
  return textOf(bytes).substr(0, kFarEnough).find("<VTKFile") != std::string_view::npos;
}

PolyData readPolyData(const std::filesystem::path& path, ByteView bytes) {
  PolyData data =
      looksLikeVtkLegacy(bytes) ? LegacyReader(path, bytes).read() : XmlReader(path, bytes).read();
  if (data.coordinates.size() % 3 != 0) failToRead(path, "has points of fewer than 3 coordinates");
  const std::size_t points = data.coordinates.size() / 3;
  for (const VertexMap& map : data.pointMaps) {
    if (static_cast<std::size_t>(map.values.size()) != points) {
      failToRead(path, "has a point array '" + map.name + "' of the wrong length");
    }
  }
  return data;
}

bool looksLikeVtk(ByteView bytes) {
  return looksLikeVtkLegacy(bytes) || looksLikeVtkXml(bytes);
}

LoadedSurface readVtkSurface(const std::filesystem::path& path, ByteView bytes,
                             const SurfaceReadOptions& options) {
  PolyData data = readPolyData(path, bytes);
  MeshBuilder builder;
  builder.coordinates = std::move(data.coordinates);
  const std::size_t corners = data.polygons.connectivity.size();
  builder.triangles.reserve(3 * (corners - std::min(corners, 2 * data.polygons.count())));
  for (std::size_t c = 0; c < data.polygons.count(); ++c) {
    const std::int64_t begin = data.polygons.offsets[c];
    builder.addPolygon(path, data.polygons.connectivity.data() + begin,
                       static_cast<std::size_t>(data.polygons.offsets[c + 1] - begin));
  }
  for (std::size_t c = 0; c < data.strips.count(); ++c) {
    // Every other triangle of a strip runs backwards.
    for (std::int64_t i = data.strips.offsets[c]; i + 2 < data.strips.offsets[c + 1]; ++i) {
      const std::int64_t* at = data.strips.connectivity.data() + i;
      const bool odd = (i - data.strips.offsets[c]) % 2 != 0;
      for (const int k : {0, odd ? 2 : 1, odd ? 1 : 2}) {
        builder.triangles.push_back(MeshBuilder::vertexNumber(at[k]));
      }
    }
  }
  data.polygons = {};
  data.strips = {};
  LoadedSurface surface = builder.finish(path, looksLikeVtkLegacy(bytes) ? "VTK" : "VTP");
  surface.maps = std::move(data.pointMaps);
  FrameInFile frame;
  if (data.saysRas) frame.stated = "scanner";
  moveToScanner(surface, frame, options);
  return surface;
}

}  // namespace explica::io
