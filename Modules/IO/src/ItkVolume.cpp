// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "VolumeFormats.h"

#include "ByteSource.h"
#include "Explica/Core/Text.h"

#include <itkMetaImageIO.h>
#include <itkNrrdImageIO.h>

#include <Eigen/Geometry>

#include <map>
#include <optional>
#include <sstream>

namespace explica::io {
namespace {

enum class ItkFormat { Nrrd, MetaImage };

constexpr std::size_t kLongestHeader = 1 << 16;  // bytes; ITK's own headers have some hundred

std::string trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(" \t\r");
  if (first == std::string_view::npos) return {};
  return std::string(text.substr(first, text.find_last_not_of(" \t\r") - first + 1));
}

/// The `key: value` or `key = value` lines of a text header; NRRD's keys in lower case.
struct TextHeader {
  std::map<std::string, std::string> fields;
  std::size_t size = 0;  ///< bytes before the data

  [[nodiscard]] std::string operator[](const std::string& key) const {
    const auto found = fields.find(key);
    return found == fields.end() ? std::string() : found->second;
  }
};

/// Of these MetaIO reads as many numbers as NDims said before, or, where it is true, the square.
const std::map<std::string, bool> kOfDimension = {
    {"DimSize", false},       {"ElementSpacing", false},   {"ElementSize", false},
    {"Offset", false},        {"Position", false},         {"Origin", false},
    {"Rotation", true},       {"CenterOfRotation", false}, {"Orientation", true},
    {"TransformMatrix", true}};

TextHeader parseHeader(const std::filesystem::path& path, ByteView bytes, ItkFormat format) {
  TextHeader header;
  ByteCursor cursor(path, bytes, false);
  while (cursor.left() > 0) {
    if (cursor.position() > kLongestHeader) failToRead(path, "its header does not end");
    const std::string_view line = cursor.line();
    header.size = cursor.position();
    if (format == ItkFormat::Nrrd && line.empty()) break;
    for (const char c : line) {
      if (static_cast<unsigned char>(c) >= 127 ||
          (static_cast<unsigned char>(c) < 32 && c != '\t')) {
        failToRead(path, "its header holds characters that are no text; it is damaged");
      }
    }
    if (line.starts_with('#')) continue;
    const std::size_t mark = line.find(format == ItkFormat::Nrrd ? ':' : '=');
    if (mark == std::string_view::npos) {
      // MetaIO takes the next lines for its value, and may look for billions of numbers there.
      if (format == ItkFormat::MetaImage && !trimmed(line).empty()) {
        failToRead(path, "its header has a line without '='");
      }
      continue;
    }
    const bool custom = format == ItkFormat::Nrrd && line.substr(mark).starts_with(":=");
    if (custom) continue;
    std::string key = trimmed(line.substr(0, mark));
    if (format == ItkFormat::Nrrd) key = lowerCase(key);
    if (format == ItkFormat::MetaImage && kOfDimension.contains(key) && header["NDims"].empty()) {
      failToRead(path, "its header states '" + key + "' before NDims");
    }
    if (!header.fields.emplace(key, trimmed(line.substr(mark + 1))).second) {
      failToRead(path, "its header states '" + key + "' twice");
    }
    if (format == ItkFormat::MetaImage && key == "ElementDataFile") break;
  }
  return header;
}

std::vector<double> numbersIn(const std::filesystem::path& path, const std::string& key,
                              const std::string& text) {
  std::vector<double> numbers;
  std::istringstream words(text);
  for (std::string word; words >> word;) {
    numbers.push_back(parseNumber<double>(path, word));
    if (!std::isfinite(numbers.back())) {
      failToRead(path, "its header has a value that is not finite in '" + key + "'");
    }
  }
  return numbers;
}

std::vector<std::int64_t> sizesIn(const std::filesystem::path& path, const std::string& text) {
  std::vector<std::int64_t> sizes;
  std::istringstream words(text);
  for (std::string word; words >> word;) sizes.push_back(parseNumber<std::int64_t>(path, word));
  return sizes;
}

void requireDimension(const std::filesystem::path& path, int dimension) {
  if (dimension < 2 || dimension > 5) {
    failToRead(path, "its header announces " + std::to_string(dimension) +
                         " dimensions; 2 to 5 are understood");
  }
}

/// How a file stores its values.
struct StoredData {
  std::string file;  ///< with the values; empty or "local": the file itself
  bool packed = false, text = false;
};

/// Bytes that the file with the data can hold at most when unpacked.
std::uint64_t dataLimit(const std::filesystem::path& path, std::uint64_t room,
                        const StoredData& data) {
  std::uint64_t size = room;
  if (!data.file.empty() && lowerCase(data.file) != "local") {
    if (data.file.find('%') != std::string::npos || lowerCase(data.file).starts_with("list")) {
      refuse(path, "spreads its data over several files; store it in one");
    }
    const std::filesystem::path beside = besideFile(path, data.file);
    std::error_code error;
    size = std::filesystem::is_regular_file(beside, error)
               ? std::filesystem::file_size(beside, error)
               : 0;
    if (error || size == 0) failToRead(path, "its data file '" + beside.string() + "' is missing");
  }
  return data.packed ? size * 1032 : size;
}

StoredData nrrdData(const TextHeader& header) {
  const std::string encoding = lowerCase(header["encoding"]);
  StoredData data{header["data file"].empty() ? header["datafile"] : header["data file"]};
  data.packed = encoding == "gzip" || encoding == "gz";
  data.text = !data.packed && encoding != "raw";
  return data;
}

/// ITK's reader looks for billions of numbers, or too few, if a header is damaged.
StoredData metaImageData(const std::filesystem::path& path, const TextHeader& header,
                         std::size_t room) {
  const std::string kind = lowerCase(header["ObjectType"]);
  if (!kind.empty() && kind != "image")
    refuse(path, "is a MetaIO " + kind + "; an image is needed");
  const auto dimension = parseNumber<std::size_t>(path, header["NDims"]);
  requireDimension(path, static_cast<int>(dimension));
  const std::vector<std::int64_t> sizes = sizesIn(path, header["DimSize"]);
  if (sizes.size() != dimension) {
    failToRead(path, "its header gives " + std::to_string(sizes.size()) + " sizes for " +
                         std::to_string(dimension) + " dimensions");
  }
  for (const auto& [key, isMatrix] : kOfDimension) {
    if (header[key].empty()) continue;
    const std::size_t length = isMatrix ? dimension * dimension : dimension;
    const std::vector<double> numbers = numbersIn(path, key, header[key]);
    if (numbers.size() != length) {
      failToRead(path, "its header gives " + std::to_string(numbers.size()) + " values for '" +
                           key + "'; " + std::to_string(length) + " are needed");
    }
  }
  if (!lowerCase(header["ElementType"]).starts_with("met_")) {
    refuse(path, "has MetaImage type '" + header["ElementType"] + "'; a type of numbers is needed");
  }
  std::int64_t channels = 1;
  if (!header["ElementNumberOfChannels"].empty()) {
    channels = parseNumber<std::int64_t>(path, header["ElementNumberOfChannels"]);
  }
  if (channels < 1 || channels > 64) {
    failToRead(path, "its header announces " + std::to_string(channels) + " channels");
  }
  if (!header["HeaderSize"].empty() && header["HeaderSize"] != "0") {
    refuse(path, "uses 'HeaderSize', which is not supported; store it anew");
  }
  const bool packed = lowerCase(header["CompressedData"]) == "true";
  if (packed && lowerCase(header["BinaryData"]) == "false") {
    failToRead(path, "its header says compressed text");
  }
  const StoredData data{header["ElementDataFile"], packed,
                        lowerCase(header["BinaryData"]) == "false"};
  if (data.file.empty()) failToRead(path, "its header does not name the data (ElementDataFile)");
  if (!header["CompressedDataSize"].empty()) {
    const auto size = parseNumber<std::int64_t>(path, header["CompressedDataSize"]);
    if (size < 1 || (lowerCase(data.file) == "local" && size > static_cast<std::int64_t>(room))) {
      failTruncated(path, "the packed data end too early");
    }
  }
  return data;
}

std::optional<StoredType> typeOf(itk::IOComponentEnum type) {
  using Itk = itk::IOComponentEnum;
  constexpr std::pair<Itk, StoredType> kTypes[] = {
      {Itk::CHAR, StoredType::Int8},      {Itk::UCHAR, StoredType::UInt8},
      {Itk::SHORT, StoredType::Int16},    {Itk::USHORT, StoredType::UInt16},
      {Itk::INT, StoredType::Int32},      {Itk::UINT, StoredType::UInt32},
      {Itk::LONG, StoredType::Int64},     {Itk::ULONG, StoredType::UInt64},
      {Itk::LONGLONG, StoredType::Int64}, {Itk::ULONGLONG, StoredType::UInt64},
      {Itk::FLOAT, StoredType::Float32},  {Itk::DOUBLE, StoredType::Float64}};
  for (const auto& [known, stored] : kTypes) {
    if (known == type) return stored;
  }
  return {};
}

/// ITK's physical space is LPS: x and y change sign.
Eigen::Matrix4d affineOf(const std::filesystem::path& path, const itk::ImageIOBase& reader) {
  const unsigned dimensions = std::min(reader.GetNumberOfDimensions(), 3U);
  Eigen::Matrix4d affine = Eigen::Matrix4d::Identity();
  for (unsigned axis = 0; axis < dimensions; ++axis) {
    const double spacing = reader.GetSpacing(axis);
    if (!(spacing > 0) || !std::isfinite(spacing)) {
      refuse(path, "its header gives a voxel size of " + std::to_string(spacing) + " along axis " +
                       std::to_string(axis) + "; correct the header");
    }
    const std::vector<double> direction = reader.GetDirection(axis);
    for (unsigned row = 0; row < dimensions; ++row) affine(row, axis) = direction[row] * spacing;
    affine(axis, 3) = reader.GetOrigin(axis);
  }
  affine.topRows<2>() *= -1;
  if (dimensions == 2) affine.block<3, 1>(0, 2) << 0, 0, 1;
  return affine;
}

/// Reads through ITK's own ImageIO of the format, and turns its LPS into RAS.  The header is
/// checked before ITK sees it, because ITK trusts the sizes it finds there.
StoredVolume readWithItk(const std::filesystem::path& path, ItkFormat format, Extent extent) {
  StoredVolume volume;
  volume.origin.path = path;
  volume.origin.placement = "header";
  volume.interleaved = true;
  const bool nrrd = format == ItkFormat::Nrrd;
  volume.origin.format = nrrd ? "NRRD" : "MetaImage";
  StoredData data;
  std::uint64_t most = 0;  // bytes of values
  {
    const Bytes bytes = readFile(path);
    const TextHeader header = parseHeader(path, bytes, format);
    const std::size_t room = bytes.size() - header.size;
    data = nrrd ? nrrdData(header) : metaImageData(path, header, room);
    most = dataLimit(path, room, data);
  }
  itk::ImageIOBase::Pointer reader;
  if (nrrd) {
    reader = itk::NrrdImageIO::New();
  } else {
    reader = itk::MetaImageIO::New();
  }
  try {
    reader->SetFileName(path.string());
    reader->ReadImageInformation();
    const std::optional<StoredType> type = typeOf(reader->GetComponentType());
    if (!type) failToRead(path, "has a voxel type that is not understood");
    volume.type = *type;
    volume.origin.storedType = nameOf(*type);
    const unsigned dimensions = reader->GetNumberOfDimensions();
    requireDimension(path, static_cast<int>(dimensions));
    std::vector<std::int64_t> sizes;
    itk::ImageIORegion region(dimensions);
    for (unsigned i = 0; i < dimensions; ++i) {
      sizes.push_back(static_cast<std::int64_t>(reader->GetDimensions(i)));
      region.SetSize(i, reader->GetDimensions(i));
      region.SetIndex(i, 0);
    }
    volume.origin.storedSize.assign(sizes.begin(), sizes.end());
    const std::int64_t components = reader->GetNumberOfComponents();
    if (components > 1) volume.origin.storedSize.push_back(static_cast<int>(components));
    std::int64_t frames = 1;
    for (std::size_t i = 3; i < sizes.size(); ++i) frames *= sizes[i];
    if (components > 1 && frames > 1) {
      refuse(path, "holds several volumes of several components each; store one of them alone");
    }
    volume.interleaved = components > 1;
    volume.valuesPerVoxel = components * frames;
    sizes.resize(3, 1);
    sizes.push_back(volume.valuesPerVoxel);
    const std::int64_t valueCount = checkedProduct(path, sizes);
    // Before room is made for them.
    const std::uint64_t needed =
        static_cast<std::uint64_t>(valueCount) * (data.text ? 2 : widthOf(volume.type)) - data.text;
    if (needed > most) failTruncated(path, "the data end too early for the sizes of the header");
    volume.origin.affine = affineOf(path, *reader);
    volume.grid = gridOf(
        path, {static_cast<int>(sizes[0]), static_cast<int>(sizes[1]), static_cast<int>(sizes[2])},
        volume.origin.affine);
    if (extent == Extent::Header) return volume;
    reader->SetIORegion(region);
    volume.values.resize(static_cast<std::size_t>(valueCount) * widthOf(volume.type));
    if (reader->GetImageSizeInBytes() !=
        static_cast<itk::ImageIOBase::SizeType>(volume.values.size())) {
      failToRead(path, "its header contradicts itself about the number of values");
    }
    reader->Read(volume.values.data());
  } catch (const itk::ExceptionObject& error) {
    const std::string cause = error.GetDescription();
    failToRead(path, "cannot be read: " + cause.substr(0, cause.find('\n')));
  }
  return volume;
}

}  // namespace

// ITK opens the files itself.
StoredVolume readNrrd(ByteSource&, const std::filesystem::path& path, const VolumeReadOptions&,
                      Extent extent) {
  return readWithItk(path, ItkFormat::Nrrd, extent);
}

StoredVolume readMetaImage(ByteSource&, const std::filesystem::path& path, const VolumeReadOptions&,
                           Extent extent) {
  return readWithItk(path, ItkFormat::MetaImage, extent);
}

}  // namespace explica::io
