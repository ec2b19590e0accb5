// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "NetcdfFile.h"

#include "MeshBuilder.h"

namespace explica::io {
namespace {

constexpr std::uint32_t kDimensions = 10, kVariables = 11, kAttributes = 12;  // tags of lists

/// netCDF's types, by their numbers.
enum class Type : std::uint32_t { Byte = 1, Char, Short, Int, Float, Double };

std::size_t widthOf(Type type) {
  constexpr std::size_t kWidths[] = {0, 1, 1, 2, 4, 4, 8};
  return kWidths[static_cast<std::size_t>(type)];
}

/// Stored type of an array, which MINC's attribute `signtype` completes.
StoredType storedTypeOf(Type type, bool isSigned) {
  switch (type) {
    case Type::Byte:
    case Type::Char:
      return isSigned ? StoredType::Int8 : StoredType::UInt8;
    case Type::Short:
      return isSigned ? StoredType::Int16 : StoredType::UInt16;
    case Type::Int:
      return isSigned ? StoredType::Int32 : StoredType::UInt32;
    case Type::Float:
      return StoredType::Float32;
    case Type::Double:
      break;
  }
  return StoredType::Float64;
}

bool isSigned(Type type, const std::map<std::string, MincAttribute>& attributes) {
  const auto said = attributes.find("signtype");
  if (said == attributes.end()) return type != Type::Byte && type != Type::Char;
  return said->second.text.find("unsigned") == std::string::npos;
}

}  // namespace

/// Reads the lists at the file's beginning.
class NetcdfFile::Header {
 public:
  Header(const std::filesystem::path& path, ByteView bytes)
      : path_(path), cursor_(path, bytes, true) {}

  [[nodiscard]] std::map<std::string, Placed> read() {
    const ByteView magic = cursor_.view(4);
    wide_ = magic[3] == 2;
    static_cast<void>(cursor_.take<std::uint32_t>());  // records along the unlimited dimension
    constexpr std::size_t kLeastDimension = 8, kLeastVariable = 28;  // bytes
    for (std::size_t n = listLength(kDimensions, kLeastDimension); n > 0; --n) {
      std::string name = text();
      dimensions_.emplace_back(std::move(name), cursor_.take<std::uint32_t>());
    }
    static_cast<void>(attributes());
    std::map<std::string, Placed> arrays;
    for (std::size_t n = listLength(kVariables, kLeastVariable); n > 0; --n) {
      std::string name = text();
      arrays[std::move(name)] = variable();
    }
    return arrays;
  }

 private:
  std::size_t listLength(std::uint32_t wanted, std::size_t bytesEach) {
    const auto tag = cursor_.take<std::uint32_t>();
    const auto count = cursor_.take<std::uint32_t>();
    if (tag == 0 && count == 0) return 0;
    if (tag != wanted) failToRead(path_, "is damaged: its netCDF header has an unknown list");
    return checkedCount(path_, count, cursor_.left(), bytesEach, "entries");
  }

  /// Length, characters, and zeros up to a multiple of 4.
  std::string text() {
    const std::size_t length =
        checkedCount(path_, cursor_.take<std::uint32_t>(), cursor_.left(), 1, "characters");
    const ByteView characters = cursor_.view(length);
    static_cast<void>(cursor_.view((4 - length % 4) % 4));
    return {characters.begin(), characters.end()};
  }

  Type type() {
    const auto number = cursor_.take<std::uint32_t>();
    if (number < 1 || number > 6) {
      failToRead(path_,
                 "is damaged: its netCDF header has the unknown type " + std::to_string(number));
    }
    return static_cast<Type>(number);
  }

  double number(Type type) {
    switch (type) {
      case Type::Byte:
      case Type::Char:
        return cursor_.take<std::int8_t>();
      case Type::Short:
        return cursor_.take<std::int16_t>();
      case Type::Int:
        return cursor_.take<std::int32_t>();
      case Type::Float:
        return cursor_.take<float>();
      case Type::Double:
        break;
    }
    return cursor_.take<double>();
  }

  std::map<std::string, MincAttribute> attributes() {
    constexpr std::size_t kLeast = 12;  // bytes
    std::map<std::string, MincAttribute> all;
    for (std::size_t n = listLength(kAttributes, kLeast); n > 0; --n) {
      MincAttribute& attribute = all[text()];
      const Type kind = type();
      if (kind == Type::Char) {
        attribute.text = text();
        continue;
      }
      const std::size_t count = checkedCount(path_, cursor_.take<std::uint32_t>(), cursor_.left(),
                                             widthOf(kind), "numbers");
      for (std::size_t k = 0; k < count; ++k) attribute.numbers.push_back(number(kind));
      static_cast<void>(cursor_.view((4 - count * widthOf(kind) % 4) % 4));
    }
    return all;
  }

  Placed variable() {
    Placed placed;
    MincArray& array = placed.array;
    const std::size_t rank =
        checkedCount(path_, cursor_.take<std::uint32_t>(), cursor_.left(), 4, "dimensions");
    for (std::size_t n = 0; n < rank; ++n) {
      const auto dimension = cursor_.take<std::uint32_t>();
      if (dimension >= dimensions_.size()) {
        failToRead(path_, "is damaged: an array has a dimension that does not exist");
      }
      array.dimensions.push_back(dimensions_[dimension].first);
      array.size.push_back(dimensions_[dimension].second);
      placed.grows = placed.grows || dimensions_[dimension].second == 0;
    }
    array.attributes = attributes();
    const Type kind = type();
    array.type = storedTypeOf(kind, isSigned(kind, array.attributes));
    static_cast<void>(cursor_.take<std::uint32_t>());  // its size, which follows from the rest
    placed.begin = wide_ ? cursor_.take<std::uint64_t>() : cursor_.take<std::uint32_t>();
    return placed;
  }

  const std::filesystem::path& path_;
  ByteCursor cursor_;
  bool wide_ = false;
  std::vector<std::pair<std::string, std::uint32_t>> dimensions_;
};

NetcdfFile::NetcdfFile(const std::filesystem::path& path, ByteView bytes)
    : path_(path), bytes_(bytes), arrays_(Header(path_, bytes).read()) {}

const MincArray* NetcdfFile::find(const std::string& name) const {
  const auto found = arrays_.find(name);
  return found == arrays_.end() ? nullptr : &found->second.array;
}

Bytes NetcdfFile::valuesOf(const std::string& name) const {
  const Placed& placed = arrays_.at(name);
  if (placed.grows) {
    refuse(path_, "its array '" + name + "' grows along the unlimited dimension; MINC's do not");
  }
  const std::size_t width = io::widthOf(placed.array.type);
  const auto count = static_cast<std::uint64_t>(valueCount(path_, placed.array));
  if (placed.begin > bytes_.size() || count > (bytes_.size() - placed.begin) / width) {
    failTruncated(path_, "the file ends before the values of '" + name + "' do");
  }
  const auto values = bytes_.subspan(placed.begin, count * width);
  Bytes native(values.begin(), values.end());
  swapBytes(native.data(), count, width);
  return native;
}

bool looksLikeNetcdf(ByteView bytes) {
  return bytes.size() >= 4 && bytes[0] == 'C' && bytes[1] == 'D' && bytes[2] == 'F' &&
         (bytes[3] == 1 || bytes[3] == 2);
}

}  // namespace explica::io
