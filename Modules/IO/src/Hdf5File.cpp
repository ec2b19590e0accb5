// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Hdf5File.h"

namespace explica::io {
namespace {

/// Kinds of messages in an object's header.
enum MessageType {
  kDataspace = 0x1,
  kLinkInfo = 0x2,
  kDatatype = 0x3,
  kLink = 0x6,
  kLayout = 0x8,
  kFilters = 0xB,
  kContinuation = 0x10,
  kSymbolTable = 0x11
};

enum FilterNumber { kDeflate = 1, kShuffle = 2, kChecksum = 3 };

constexpr std::uint64_t kNowhere = ~std::uint64_t{0};  // address of what is not there
constexpr int kMostDimensions = 32;                    // HDF5's own limit
constexpr std::size_t kNodeHead = 24;                  // bytes before a node's entries
constexpr std::size_t kGroupEntry = 16;                // bytes: name and place
constexpr std::size_t kChunkEntry = 24;                // bytes at least: sizes and place

/// Values of an element's type.
struct ElementType {
  enum class Class { Number, Text, Other } kind = Class::Other;
  StoredType number = StoredType::Float64;
  bool bigEndian = false;
  std::size_t width = 0;
};

[[noreturn]] void failAsUnknown(const std::filesystem::path& path, const std::string& what) {
  failToRead(
      path,
      "is HDF5 with " + what +
          ", which is not read here; write it anew with the program that made it, or h5repack");
}

std::vector<std::int64_t> dataspaceOf(const std::filesystem::path& path, ByteView message) {
  ByteCursor cursor(path, message, false);
  const auto version = cursor.take<std::uint8_t>();
  const auto rank = cursor.take<std::uint8_t>();
  static_cast<void>(cursor.take<std::uint8_t>());  // flags: largest sizes follow
  static_cast<void>(cursor.take<std::uint8_t>());
  if (version == 1) static_cast<void>(cursor.take<std::uint32_t>());
  if (version != 1 && version != 2) failAsUnknown(path, "an unknown dataspace");
  if (rank > kMostDimensions) failToRead(path, "is damaged: an array has too many dimensions");
  std::vector<std::int64_t> size;
  for (int d = 0; d < rank; ++d) {
    const auto n = cursor.take<std::int64_t>();
    if (n < 0) failToRead(path, "is damaged: an array has a negative size");
    size.push_back(n);
  }
  return size;
}

ElementType elementOf(const std::filesystem::path& path, ByteView message) {
  ByteCursor cursor(path, message, false);
  const int kind = cursor.take<std::uint8_t>() & 0xF;
  const auto bits = cursor.take<std::uint8_t>();
  static_cast<void>(cursor.take<std::uint16_t>());
  ElementType element{.bigEndian = (bits & 1) != 0, .width = cursor.take<std::uint32_t>()};
  constexpr int kWhole = 0, kReal = 1, kText = 3;  // HDF5's numbers of classes
  const bool isSigned = (bits & 8) != 0;
  element.kind = ElementType::Class::Number;
  if (kind == kReal && element.width == 4) {
    element.number = StoredType::Float32;
  } else if (kind == kReal && element.width == 8) {
    element.number = StoredType::Float64;
  } else if (kind == kWhole && element.width == 1) {
    element.number = isSigned ? StoredType::Int8 : StoredType::UInt8;
  } else if (kind == kWhole && element.width == 2) {
    element.number = isSigned ? StoredType::Int16 : StoredType::UInt16;
  } else if (kind == kWhole && element.width == 4) {
    element.number = isSigned ? StoredType::Int32 : StoredType::UInt32;
  } else if (kind == kWhole && element.width == 8) {
    element.number = isSigned ? StoredType::Int64 : StoredType::UInt64;
  } else {
    element.kind = kind == kText ? ElementType::Class::Text : ElementType::Class::Other;
  }
  return element;
}

/// Bytes of so many values; more than any file here holds are refused.
std::uint64_t byteCountOf(const std::filesystem::path& path, const std::vector<std::int64_t>& size,
                          std::size_t width) {
  if (std::ranges::find(size, 0) != size.end()) return 0;
  return static_cast<std::uint64_t>(size.empty() ? 1 : checkedProduct(path, size)) * width;
}

/// Bytes of a value stand apart, first all first bytes, after HDF5's shuffle.
Bytes unshuffled(const Bytes& bytes, std::size_t width) {
  const std::size_t count = bytes.size() / width;
  Bytes result = bytes;
  for (std::size_t v = 0; v < count; ++v) {
    for (std::size_t b = 0; b < width; ++b) result[v * width + b] = bytes[b * count + v];
  }
  return result;
}

}  // namespace

/// A block of an array's values.
struct Hdf5File::Chunk {
  std::uint64_t address = 0;
  std::uint32_t storedSize = 0;
  std::uint32_t skipped = 0;  ///< a bit for each filter that was not applied
  std::vector<std::int64_t> first;
};

Hdf5File::Hdf5File(std::filesystem::path path, ByteView bytes)
    : path_(std::move(path)), bytes_(bytes) {
  readSuperblock();
}

ByteCursor Hdf5File::at(std::uint64_t address) const {
  ByteCursor cursor(path_, bytes_, false);
  if (address > bytes_.size() || base_ > bytes_.size() - address) {
    failTruncated(path_, "the file ends before an address that it names");
  }
  cursor.moveTo(base_ + address);
  return cursor;
}

void Hdf5File::readSuperblock() {
  ByteCursor cursor(path_, bytes_, false);
  static_cast<void>(cursor.view(8));
  const auto version = cursor.take<std::uint8_t>();
  const bool old = version < 2;
  if (version > 3) failAsUnknown(path_, "an unknown superblock");
  if (old) static_cast<void>(cursor.view(4));
  const auto offsetSize = cursor.take<std::uint8_t>(), lengthSize = cursor.take<std::uint8_t>();
  if (offsetSize != 8 || lengthSize != 8) failAsUnknown(path_, "addresses of other than 8 bytes");
  if (!old) {
    static_cast<void>(cursor.view(1));
    base_ = cursor.take<std::uint64_t>();
    static_cast<void>(cursor.view(16));
    root_ = cursor.take<std::uint64_t>();
    return;
  }
  static_cast<void>(cursor.view(version == 1 ? 13 : 9));
  base_ = cursor.take<std::uint64_t>();
  static_cast<void>(cursor.view(24 + 8));  // other addresses, offset of the root's name
  root_ = cursor.take<std::uint64_t>();
}

void Hdf5File::addMessages(ByteView block, bool old, bool ordered, std::vector<Message>& messages,
                           std::vector<ByteView>& blocks) const {
  const std::size_t head = old ? 8 : ordered ? 6 : 4;  // bytes
  ByteCursor cursor(path_, block, false);
  while (cursor.left() >= head) {
    Message message;
    message.type = old ? cursor.take<std::uint16_t>() : cursor.take<std::uint8_t>();
    const auto size = cursor.take<std::uint16_t>();
    message.flags = cursor.take<std::uint8_t>();
    static_cast<void>(cursor.view(old ? 3 : ordered ? 2 : 0));
    message.data = cursor.view(size);
    if (message.type == kContinuation) {
      ByteCursor where(path_, message.data, false);
      const auto address = where.take<std::uint64_t>();
      const auto length = where.take<std::uint64_t>();
      const std::size_t around = old ? 0 : 8;  // bytes: "OCHK" and a checksum
      const ByteView whole = at(address).view(length);
      if (length < around) failToRead(path_, "is damaged: a part of a header is too short");
      blocks.push_back(whole.subspan(around / 2, length - around));
    }
    messages.push_back(message);
  }
}

std::vector<Hdf5File::Message> Hdf5File::messagesOf(std::uint64_t address) const {
  ByteCursor cursor = at(address);
  std::vector<Message> messages;
  std::vector<ByteView> blocks;
  bool old = true, ordered = false;
  const std::size_t begin = cursor.position();
  if (textOf(cursor.view(4)) == "OHDR") {
    old = false;
    static_cast<void>(cursor.take<std::uint8_t>());
    const auto flags = cursor.take<std::uint8_t>();
    ordered = (flags & 4) != 0;
    if ((flags & 0x20) != 0) static_cast<void>(cursor.view(16));  // times
    if ((flags & 0x10) != 0) static_cast<void>(cursor.view(4));
    std::uint64_t size = 0;
    const ByteView written = cursor.view(std::size_t{1} << (flags & 3));
    for (std::size_t b = written.size(); b-- > 0;) size = size << 8 | written[b];
    blocks.push_back(cursor.view(size));
  } else {
    cursor.moveTo(begin);
    if (cursor.take<std::uint8_t>() != 1) {
      failToRead(path_, "is damaged: there is no header where one is announced");
    }
    static_cast<void>(cursor.view(7));  // counts
    const auto size = cursor.take<std::uint32_t>();
    static_cast<void>(cursor.view(4));
    blocks.push_back(cursor.view(size));
  }
  std::size_t taken = 0;  // bytes; blocks that are read twice end it
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    const ByteView block = blocks[b];
    taken += block.size() + 1;
    if (taken > bytes_.size()) failToRead(path_, "is damaged: a header does not end");
    addMessages(block, old, ordered, messages, blocks);
  }
  return messages;
}

std::optional<std::uint64_t> Hdf5File::inSymbolTable(ByteView message,
                                                     std::string_view name) const {
  ByteCursor cursor(path_, message, false);
  const auto tree = cursor.take<std::uint64_t>();
  ByteCursor heap = at(cursor.take<std::uint64_t>());
  if (textOf(heap.view(4)) != "HEAP") failToRead(path_, "is damaged: a group has no names");
  static_cast<void>(heap.view(4));
  const auto heapSize = heap.take<std::uint64_t>();
  static_cast<void>(heap.view(8));
  const std::string_view names = textOf(at(heap.take<std::uint64_t>()).view(heapSize));
  std::vector<std::uint64_t> nodes = {tree};
  std::size_t taken = 0;  // bytes; nodes that are read twice end it
  while (!nodes.empty()) {
    if (taken > bytes_.size()) failToRead(path_, "is damaged: a group is a loop");
    ByteCursor node = at(nodes.back());
    nodes.pop_back();
    const std::string_view kind = textOf(node.view(4));
    if (kind == "TREE") {
      static_cast<void>(node.view(2));
      const auto entries = node.take<std::uint16_t>();
      static_cast<void>(node.view(16));
      taken += kNodeHead + kGroupEntry * entries;
      for (int n = 0; n < entries; ++n) {
        static_cast<void>(node.view(8));  // key
        nodes.push_back(node.take<std::uint64_t>());
      }
      continue;
    }
    if (kind != "SNOD") failToRead(path_, "is damaged: a group has no entries where it names them");
    static_cast<void>(node.view(2));
    const auto entries = node.take<std::uint16_t>();
    taken += kNodeHead;
    for (int n = 0; n < entries; ++n) {
      const auto offset = node.take<std::uint64_t>();
      const auto address = node.take<std::uint64_t>();
      static_cast<void>(node.view(24));
      if (offset >= names.size()) failToRead(path_, "is damaged: an entry of a group has no name");
      const std::string_view rest = names.substr(offset);
      if (rest.substr(0, rest.find('\0')) == name) return address;
    }
  }
  return {};
}

std::optional<std::uint64_t> Hdf5File::inLink(ByteView message, std::string_view name) const {
  ByteCursor cursor(path_, message, false);
  static_cast<void>(cursor.take<std::uint8_t>());
  const auto flags = cursor.take<std::uint8_t>();
  const int kind = (flags & 8) != 0 ? cursor.take<std::uint8_t>() : 0;
  if ((flags & 4) != 0) static_cast<void>(cursor.view(8));
  if ((flags & 16) != 0) static_cast<void>(cursor.view(1));
  std::uint64_t length = 0;
  const ByteView written = cursor.view(std::size_t{1} << (flags & 3));
  for (std::size_t b = written.size(); b-- > 0;) length = length << 8 | written[b];
  if (textOf(cursor.view(length)) != name) return {};
  if (kind != 0) failAsUnknown(path_, "links to other places");
  return cursor.take<std::uint64_t>();
}

std::optional<std::uint64_t> Hdf5File::childOf(std::uint64_t group, std::string_view name) const {
  for (const Message& message : messagesOf(group)) {
    std::optional<std::uint64_t> found;
    if (message.type == kSymbolTable) found = inSymbolTable(message.data, name);
    if (message.type == kLink) found = inLink(message.data, name);
    if (message.type == kLinkInfo) {
      constexpr std::size_t kLargestOrder = 8, kHeapAddress = 8;  // bytes
      ByteCursor cursor(path_, message.data, false);
      static_cast<void>(cursor.take<std::uint8_t>());
      if ((cursor.take<std::uint8_t>() & 1) != 0) static_cast<void>(cursor.view(kLargestOrder));
      if (cursor.left() >= kHeapAddress && cursor.take<std::uint64_t>() != kNowhere) {
        failAsUnknown(path_, "groups of many members");
      }
    }
    if (found) return found;
  }
  return {};
}

void Hdf5File::readLayout(ByteView message, Hdf5Array& array) const {
  ByteCursor cursor(path_, message, false);
  if (cursor.take<std::uint8_t>() != 3) failAsUnknown(path_, "values laid out in another way");
  switch (cursor.take<std::uint8_t>()) {
    case 0:
      array.layout = Hdf5Array::Layout::Compact;
      array.byteCount = cursor.take<std::uint16_t>();
      array.address =
          static_cast<std::uint64_t>(cursor.view(array.byteCount).data() - bytes_.data());
      return;
    case 1:
      array.layout = Hdf5Array::Layout::Contiguous;
      array.address = cursor.take<std::uint64_t>();
      array.byteCount = cursor.take<std::uint64_t>();
      return;
    case 2: {
      array.layout = Hdf5Array::Layout::Chunked;
      const auto rank = cursor.take<std::uint8_t>();
      array.address = cursor.take<std::uint64_t>();
      for (int d = 0; d + 1 < rank; ++d) array.chunk.push_back(cursor.take<std::uint32_t>());
      return;
    }
    default:
      failAsUnknown(path_, "values laid out in another way");
  }
}

void Hdf5File::readFilters(ByteView message, Hdf5Array& array) const {
  ByteCursor cursor(path_, message, false);
  const auto version = cursor.take<std::uint8_t>();
  const auto count = cursor.take<std::uint8_t>();
  if (version == 1) static_cast<void>(cursor.view(6));
  if (version != 1 && version != 2) failAsUnknown(path_, "an unknown list of filters");
  constexpr int kFirstNamed = 256;  // filters from this number on are registered by name
  for (int n = 0; n < count; ++n) {
    const auto number = cursor.take<std::uint16_t>();
    const bool named = version == 1 || number >= kFirstNamed;
    const auto nameLength = named ? cursor.take<std::uint16_t>() : std::uint16_t{0};
    static_cast<void>(cursor.take<std::uint16_t>());  // flags
    const auto values = cursor.take<std::uint16_t>();
    static_cast<void>(cursor.view(nameLength));
    static_cast<void>(cursor.view(std::size_t{4} * values));
    if (version == 1 && values % 2 == 1) static_cast<void>(cursor.view(4));
    if (number != kDeflate && number != kShuffle && number != kChecksum) {
      failAsUnknown(path_, "the filter " + std::to_string(number));
    }
    array.filters.push_back(number);
  }
}

std::optional<std::uint64_t> Hdf5File::addressOf(const std::string& place) const {
  std::uint64_t address = root_;
  for (std::size_t begin = 1; begin < place.size();) {
    const std::size_t end = std::min(place.find('/', begin), place.size());
    const auto child = childOf(address, std::string_view(place).substr(begin, end - begin));
    if (!child) return {};
    address = *child;
    begin = end + 1;
  }
  return address;
}

std::string Hdf5File::inGlobalHeap(std::uint64_t address, std::uint32_t index,
                                   std::uint32_t length) const {
  ByteCursor heap = at(address);
  const std::size_t begin = heap.position();
  if (textOf(heap.view(4)) != "GCOL")
    failToRead(path_, "is damaged: a text is not where it should");
  static_cast<void>(heap.view(4));
  const auto size = heap.take<std::uint64_t>();
  while (heap.position() - begin < size) {
    const auto number = heap.take<std::uint16_t>();
    static_cast<void>(heap.view(6));
    const auto bytes = heap.take<std::uint64_t>();
    if (number == index && length <= bytes) return std::string(textOf(heap.view(length)));
    if (number == 0) break;  // what is free
    static_cast<void>(heap.view(bytes));
    static_cast<void>(heap.view((8 - bytes % 8) % 8));
  }
  failToRead(path_, "is damaged: a text is not where it should");
}

std::optional<std::string> Hdf5File::textAt(const std::string& place) const {
  const std::optional<std::uint64_t> address = addressOf(place);
  if (!address) return {};
  constexpr int kText = 3, kVariable = 9;  // HDF5's numbers of classes
  int kind = 0;
  std::size_t width = 0;
  Hdf5Array array;
  for (const Message& message : messagesOf(*address)) {
    if (message.type == kDatatype) {
      ByteCursor cursor(path_, message.data, false);
      kind = cursor.take<std::uint8_t>() & 0xF;
      static_cast<void>(cursor.view(3));
      width = cursor.take<std::uint32_t>();
    }
    if (message.type == kLayout) readLayout(message.data, array);
  }
  constexpr std::size_t kReference = 16;  // bytes: length, address and number of what varies
  const bool proper = kind == kText || (kind == kVariable && width == kReference);
  if (!proper || array.layout != Hdf5Array::Layout::Contiguous || array.address == kNowhere) {
    failAsUnknown(path_, "'" + place + "' that is no text");
  }
  ByteCursor cursor = at(array.address);
  std::string text;
  if (kind == kText) {
    text = textOf(cursor.view(width));
  } else {
    const auto length = cursor.take<std::uint32_t>();
    const auto heap = cursor.take<std::uint64_t>();
    text = inGlobalHeap(heap, cursor.take<std::uint32_t>(), length);
  }
  return text.substr(0, text.find('\0'));
}

std::optional<Hdf5Array> Hdf5File::find(const std::string& place) const {
  const std::optional<std::uint64_t> address = addressOf(place);
  if (!address) return {};
  Hdf5Array array;
  bool hasType = false, hasLayout = false;
  for (const Message& message : messagesOf(*address)) {
    constexpr int kShared = 2;  // bit: the message stands elsewhere
    const bool shared = (message.flags & kShared) != 0;
    switch (message.type) {
      case kDataspace:
        array.size = dataspaceOf(path_, message.data);
        break;
      case kDatatype: {
        if (shared) failAsUnknown(path_, "types that arrays share");
        const ElementType element = elementOf(path_, message.data);
        if (element.kind != ElementType::Class::Number) break;
        array.type = element.number;
        array.bigEndian = element.bigEndian;
        hasType = true;
        break;
      }
      case kLayout:
        readLayout(message.data, array);
        hasLayout = true;
        break;
      case kFilters:
        readFilters(message.data, array);
        break;
      default:
        break;
    }
  }
  if (!hasType || !hasLayout) failAsUnknown(path_, "'" + place + "' that is no array of numbers");
  return array;
}

std::vector<Hdf5File::Chunk> Hdf5File::chunksOf(const Hdf5Array& array) const {
  const std::size_t rank = array.size.size();
  std::vector<Chunk> chunks;
  std::vector<std::uint64_t> nodes;
  if (array.address != kNowhere) nodes.push_back(array.address);
  std::size_t taken = 0;  // bytes; nodes that are read twice end it
  while (!nodes.empty()) {
    if (taken > bytes_.size()) failToRead(path_, "is damaged: a tree is a loop");
    ByteCursor node = at(nodes.back());
    nodes.pop_back();
    if (textOf(node.view(4)) != "TREE" || node.take<std::uint8_t>() != 1) {
      failToRead(path_, "is damaged: an array has no chunks where it names them");
    }
    const auto level = node.take<std::uint8_t>();
    const auto entries = node.take<std::uint16_t>();
    static_cast<void>(node.view(16));
    taken += kNodeHead + kChunkEntry * entries;
    for (int n = 0; n < entries; ++n) {
      Chunk chunk;
      chunk.storedSize = node.take<std::uint32_t>();
      chunk.skipped = node.take<std::uint32_t>();
      for (std::size_t d = 0; d < rank; ++d) {
        chunk.first.push_back(node.take<std::int64_t>());
        if (chunk.first[d] < 0 || chunk.first[d] >= array.size[d]) {
          failToRead(path_, "is damaged: a chunk lies outside of its array");
        }
      }
      static_cast<void>(node.view(8));
      chunk.address = node.take<std::uint64_t>();
      if (level > 0) {
        nodes.push_back(chunk.address);
      } else {
        chunks.push_back(std::move(chunk));
      }
    }
  }
  return chunks;
}

Bytes Hdf5File::unpacked(const Hdf5Array& array, const Chunk& chunk, std::size_t wanted) const {
  ByteView stored = at(chunk.address).view(chunk.storedSize);
  Bytes bytes;
  bool own = false;  // bytes hold what stored showed
  for (std::size_t f = array.filters.size(); f-- > 0;) {
    if ((chunk.skipped >> std::min<std::size_t>(f, 31) & 1) != 0) continue;
    const ByteView now = own ? ByteView(bytes) : stored;
    if (array.filters[f] == kChecksum) {
      constexpr std::size_t kSum = 4;  // bytes
      if (now.size() < kSum) failTruncated(path_, "a chunk is too short");
      bytes = Bytes(now.begin(), now.end() - kSum);
    } else if (array.filters[f] == kDeflate) {
      bytes = inflateExactly(path_, now, wanted);
    } else {
      if (now.size() != wanted) failTruncated(path_, "a chunk has the wrong size");
      bytes = unshuffled(Bytes(now.begin(), now.end()), widthOf(array.type));
    }
    own = true;
  }
  if (!own) bytes = Bytes(stored.begin(), stored.end());
  if (bytes.size() != wanted) failTruncated(path_, "a chunk has the wrong size");
  return bytes;
}

Bytes Hdf5File::chunkedValues(const Hdf5Array& array, std::uint64_t byteCount) const {
  const std::size_t rank = array.size.size(), width = widthOf(array.type);
  const bool proper = array.chunk.size() == rank && rank > 0 &&
                      std::ranges::all_of(array.chunk, [](std::int64_t n) { return n > 0; });
  if (!proper) failToRead(path_, "is damaged: its chunks have no size");
  const std::vector<Chunk> chunks = chunksOf(array);
  const std::uint64_t wanted = byteCountOf(path_, array.chunk, width);
  constexpr std::uint64_t kMostPacked = 1032;  // deflate packs no better
  std::uint64_t needed = 1, packed = 0;
  for (const Chunk& chunk : chunks) {
    if (wanted / kMostPacked > chunk.storedSize) {
      failTruncated(path_, "a chunk is shorter than any packing of it");
    }
    packed += chunk.storedSize;
  }
  if (packed > bytes_.size()) failToRead(path_, "is damaged: its chunks overlap");
  for (std::size_t d = 0; d < rank; ++d) {
    needed *= static_cast<std::uint64_t>((array.size[d] + array.chunk[d] - 1) / array.chunk[d]);
  }
  if (chunks.size() != needed) {
    failTruncated(path_, "there are " + std::to_string(chunks.size()) + " of the " +
                             std::to_string(needed) + " chunks of an array");
  }
  Bytes values(byteCount);
  std::vector<std::int64_t> row(rank);
  for (const Chunk& chunk : chunks) {
    const Bytes block = unpacked(array, chunk, wanted);
    const std::size_t last = rank - 1;
    const std::int64_t run = std::min(array.chunk[last], array.size[last] - chunk.first[last]);
    const auto rows = block.size() / (static_cast<std::size_t>(array.chunk[last]) * width);
    for (std::size_t r = 0; r < rows; ++r) {
      std::size_t rest = r, to = 0;
      bool inside = true;
      for (std::size_t d = last; d-- > 0;) {
        const auto n = static_cast<std::size_t>(array.chunk[d]);
        row[d] = chunk.first[d] + static_cast<std::int64_t>(rest % n);
        rest /= n;
        inside = inside && row[d] < array.size[d];
      }
      if (!inside) continue;
      row[last] = chunk.first[last];
      for (std::size_t d = 0; d < rank; ++d) {
        to = to * static_cast<std::size_t>(array.size[d]) + static_cast<std::size_t>(row[d]);
      }
      std::memcpy(values.data() + to * width,
                  block.data() + r * static_cast<std::size_t>(array.chunk[last]) * width,
                  static_cast<std::size_t>(run) * width);
    }
  }
  return values;
}

Bytes Hdf5File::valuesOf(const Hdf5Array& array) const {
  const std::size_t width = widthOf(array.type);
  const std::uint64_t byteCount = byteCountOf(path_, array.size, width);
  Bytes values;
  if (array.layout == Hdf5Array::Layout::Chunked) {
    values = chunkedValues(array, byteCount);
  } else {
    if (array.byteCount < byteCount || array.address == kNowhere) {
      failTruncated(path_, "an array is shorter than its size");
    }
    const bool inHeader = array.layout == Hdf5Array::Layout::Compact;
    ByteCursor cursor = at(inHeader ? array.address - base_ : array.address);
    const ByteView stored = cursor.view(byteCount);
    values.assign(stored.begin(), stored.end());
  }
  if (array.bigEndian) swapBytes(values.data(), values.size() / width, width);
  return values;
}

bool looksLikeHdf5(ByteView bytes) {
  constexpr std::string_view kMagic("\x89HDF\r\n\x1a\n", 8);
  return textOf(bytes).starts_with(kMagic);
}

}  // namespace explica::io
