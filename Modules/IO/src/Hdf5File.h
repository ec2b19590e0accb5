// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Bytes.h"
#include "StoredVolume.h"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace explica::io {

/// An array of an HDF5 file: what it is and where its values stand.
struct Hdf5Array {
  std::vector<std::int64_t> size;  ///< slowest dimension first; empty: one value
  StoredType type = StoredType::Float64;
  bool bigEndian = false;

  enum class Layout { Compact, Contiguous, Chunked };
  Layout layout = Layout::Contiguous;
  std::uint64_t address = 0;        ///< of the values, or of the tree of chunks
  std::uint64_t byteCount = 0;      ///< of compact or contiguous values
  std::vector<std::int64_t> chunk;  ///< size of a chunk
  std::vector<int> filters;         ///< by HDF5's numbers, as they were applied
};

/// Numeric arrays and texts from an HDF5 file, as far as ITK and h5py by default write them:
/// superblocks 0 to 3, groups as symbol tables, contiguous or chunked values, packed by deflate
/// with or without shuffle and checksum [HDF5 file format specification, version 3].  Every address
/// and size is checked against the file; HDF5's own library (1.10) does not: it reads beyond packed
/// blocks and its heap of texts, and ends the program within some hundred files of which bytes were
/// changed.
class Hdf5File {
 public:
  /// @param bytes  the whole file; must outlive this object
  /// @throws IOError  damaged, or of a kind beyond the above: names it
  Hdf5File(std::filesystem::path path, ByteView bytes);

  /// The array at "/group/.../name"; nothing if there is none.
  [[nodiscard]] std::optional<Hdf5Array> find(const std::string& place) const;
  /// The text at "/group/.../name", of fixed or variable length; nothing if there is none.
  [[nodiscard]] std::optional<std::string> textAt(const std::string& place) const;
  /// Values in native byte order, last dimension fastest.
  [[nodiscard]] Bytes valuesOf(const Hdf5Array& array) const;

 private:
  /// A message of an object's header.
  struct Message {
    int type = 0;
    std::uint8_t flags = 0;
    ByteView data;
  };

  [[nodiscard]] ByteCursor at(std::uint64_t address) const;
  void readSuperblock();
  [[nodiscard]] std::vector<Message> messagesOf(std::uint64_t address) const;
  void addMessages(ByteView block, bool old, bool ordered, std::vector<Message>& messages,
                   std::vector<ByteView>& blocks) const;
  [[nodiscard]] std::optional<std::uint64_t> addressOf(const std::string& place) const;
  [[nodiscard]] std::string inGlobalHeap(std::uint64_t address, std::uint32_t index,
                                         std::uint32_t length) const;
  [[nodiscard]] std::optional<std::uint64_t> childOf(std::uint64_t group,
                                                     std::string_view name) const;
  [[nodiscard]] std::optional<std::uint64_t> inSymbolTable(ByteView message,
                                                           std::string_view name) const;
  [[nodiscard]] std::optional<std::uint64_t> inLink(ByteView message, std::string_view name) const;
  void readLayout(ByteView message, Hdf5Array& array) const;
  void readFilters(ByteView message, Hdf5Array& array) const;
  struct Chunk;
  [[nodiscard]] std::vector<Chunk> chunksOf(const Hdf5Array& array) const;
  [[nodiscard]] Bytes unpacked(const Hdf5Array& array, const Chunk& chunk,
                               std::size_t wanted) const;
  [[nodiscard]] Bytes chunkedValues(const Hdf5Array& array, std::uint64_t byteCount) const;

  std::filesystem::path path_;
  ByteView bytes_;
  std::uint64_t base_ = 0;
  std::uint64_t root_ = 0;  ///< address of the root group's header
};

[[nodiscard]] bool looksLikeHdf5(ByteView bytes);

}  // namespace explica::io
