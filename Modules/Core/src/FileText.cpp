// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Core/FileText.h"

#include "Explica/Core/Errors.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

namespace explica {
namespace {

/// Ends with the file's use.
class Descriptor {
 public:
  explicit Descriptor(const std::filesystem::path& path)
      : number_(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK)) {}
  ~Descriptor() {
    if (number_ >= 0) ::close(number_);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  [[nodiscard]] int number() const { return number_; }

 private:
  int number_;
};

}  // namespace

std::string fileText(const std::filesystem::path& path, std::size_t most) {
  const auto refuse = [&](const std::string& what) { throw IOError(path.string() + what); };
  const Descriptor file(path);
  struct stat status {};
  if (file.number() < 0 || ::fstat(file.number(), &status) != 0) {
    refuse(std::string(": cannot be read (") + std::strerror(errno) + ")");
  }
  if (S_ISDIR(status.st_mode)) refuse(": cannot be read (it is a folder)");
  if (!S_ISREG(status.st_mode)) refuse(": is not a regular file");
  const auto size = static_cast<std::size_t>(status.st_size);
  if (size > most) {
    refuse(": has " + std::to_string(size) + " bytes; a file of this kind has " +
           std::to_string(most) + " at most");
  }
  std::string text(size, '\0');
  std::size_t filled = 0;
  while (filled < size) {
    const ssize_t got = ::read(file.number(), text.data() + filled, size - filled);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) refuse(std::string(": cannot be read (") + std::strerror(errno) + ")");
    if (got == 0) break;
    filled += static_cast<std::size_t>(got);
  }
  text.resize(filled);
  return text;
}

}  // namespace explica
