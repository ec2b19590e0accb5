// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <string_view>

namespace explica {

/// A file that appears under its name whole or not at all.
///
/// Bytes go to a hidden temporary name in the same folder.  commit() flushes them to the disk and
/// renames; without commit() the destructor removes the temporary, so that neither an exception nor
/// a full disk leaves a good-looking half file.  An existing file of that name stays until
/// commit().
class WholeFile {
 public:
  /// @throws EnvironmentError  the temporary cannot be created: names the path and the cause
  explicit WholeFile(std::filesystem::path path);
  ~WholeFile();
  WholeFile(const WholeFile&) = delete;
  WholeFile& operator=(const WholeFile&) = delete;

  /// Appends bytes.
  /// @throws EnvironmentError  disk full or another fault of the device: names the path
  void write(const void* bytes, std::size_t count);
  void write(std::string_view text) { write(text.data(), text.size()); }

  /// Flushes and takes the final name.
  /// @throws EnvironmentError  as write()
  void commit();

 private:
  [[noreturn]] void fail(std::string_view action, int cause);

  std::filesystem::path path_;
  std::filesystem::path temporary_;
  int descriptor_ = -1;
};

/// Writes a whole text file, or nothing.
/// @throws EnvironmentError  as WholeFile
void writeTextFile(const std::filesystem::path& path, std::string_view text);

}  // namespace explica
