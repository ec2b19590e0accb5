// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Bytes.h"

#include <filesystem>
#include <memory>

namespace explica::io {

/// The file with a part of the data that a header names: in its folder or below.
/// @throws InvalidInput  a place outside: a stranger's header must not choose what is read
[[nodiscard]] std::filesystem::path besideFile(const std::filesystem::path& header,
                                               const std::string& name);

/// Content of a regular file.
/// @throws IOError  missing, a folder, not permitted, empty
[[nodiscard]] Bytes readFile(const std::filesystem::path& path);

/// A file's content as a stream, unpacked on the way if it is gzip (one or several members).  Holds
/// a piece of the file at a time.
class ByteSource {
 public:
  class OpenFile;

  static constexpr std::uint64_t kMostUnpacked = std::uint64_t{4} << 30;  ///< bytes of any kind
  static constexpr std::uint64_t kMostText = std::uint64_t{256} << 20;    ///< bytes of a table

  explicit ByteSource(const std::filesystem::path& path);
  ~ByteSource();
  ByteSource(const ByteSource&) = delete;
  ByteSource& operator=(const ByteSource&) = delete;

  /// The first bytes of what is left, fewer only at the end; they stay to be read.
  [[nodiscard]] ByteView peek(std::size_t count);
  /// Next bytes, fewer only at the end.
  /// @throws IOError  damaged or truncated gzip data
  std::size_t read(std::uint8_t* to, std::size_t count);
  /// Exactly `count` bytes.
  /// @throws IOError  too few left, told before anything large is allocated
  [[nodiscard]] Bytes take(std::uint64_t count);
  void skip(std::uint64_t count);
  /// Reads on to the end, so that gzip's checksum is verified.
  /// @return how many bytes were left
  /// @throws IOError  packed data go on for more than 16 MB: whoever made them wants time or memory
  std::uint64_t finish();
  /// All that is left.
  /// @param mostUnpacked  bytes that packed content may grow to: what is longer is no file of a
  ///                      kind that is read as a whole.  A small file may grow to 32 MB and less
  ///                      than a hundred times its size: surfaces and tables pack to a fifth
  /// @throws IOError  it grows to more
  [[nodiscard]] Bytes rest(std::uint64_t mostUnpacked = kMostUnpacked);
  /// How many bytes can be left at most: a compressed byte gives at most 1032.
  [[nodiscard]] std::uint64_t leftAtMost() const;
  [[nodiscard]] bool compressed() const { return members_ != nullptr; }
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  struct Members;

  std::size_t readOn(std::uint8_t* to, std::size_t count);
  std::size_t unpack(std::uint8_t* to, std::size_t count);
  /// Takes more of the file in; false at its end.
  bool fetch();

  std::filesystem::path path_;
  std::unique_ptr<OpenFile> file_;
  Bytes chunk_;  ///< of the file, taken in but from `at_` on not given out
  std::size_t at_ = 0;
  Bytes peeked_;
  std::size_t peekedAt_ = 0;
  std::unique_ptr<Members> members_;
};

/// Unpacks zlib or gzip data of a known unpacked size.
/// @throws IOError  damaged, or not of that size
[[nodiscard]] Bytes inflateExactly(const std::filesystem::path& path, ByteView packed,
                                   std::uint64_t size);

/// Decodes base64, skipping blanks.
/// @throws IOError  a character that is not base64's
[[nodiscard]] Bytes decodeBase64(const std::filesystem::path& path, std::string_view text);

}  // namespace explica::io
