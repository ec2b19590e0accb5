// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace explica::fuzz {

/// A reader, and a name of a file by whose ending it is taken for that format.
struct Reader {
  std::string name;
  std::string file;
  void (*read)(const std::filesystem::path& path);
};

[[nodiscard]] const std::vector<Reader>& allReaders();

/// Gives bytes to a reader as a file.  A result or one of the library's own errors are right
/// answers, whatever the bytes are; anything else ends the process.
class Trial {
 public:
  explicit Trial(const Reader& reader);
  ~Trial();
  Trial(const Trial&) = delete;
  Trial& operator=(const Trial&) = delete;
  void read(const std::uint8_t* bytes, std::size_t count) const;

 private:
  const Reader& reader_;
  std::filesystem::path folder_;  ///< in memory
  int file_ = -1;                 ///< kept open: to make a file anew takes longer than to read it
};

}  // namespace explica::fuzz
