// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Core/WholeFile.h"

#include "Explica/Core/Errors.h"
#include "Explica/Core/Folders.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <string>
#include <system_error>
#include <utility>

namespace explica {
namespace {

constexpr std::size_t kLongestWrite = std::size_t{1} << 30;  // Linux writes at most 2 GB a call

std::string reasonOf(int cause) {
  switch (cause) {
    case ENOSPC:
    case EDQUOT:
      return "no space left on the device; free some or choose another folder";
    case EFBIG:
      return "the file grows over the size that this process may write (see ulimit -f)";
    case ENOENT:
      return "its folder does not exist";
    case EACCES:
    case EPERM:
      return "permission denied";
    case EROFS:
      return "the file system is read-only";
    default:
      return std::generic_category().message(cause);
  }
}

/// A name beside `path` that no other writer of this or another process uses.
std::filesystem::path temporaryFor(const std::filesystem::path& path) {
  static std::atomic<unsigned> counter{0};
  return path.parent_path() / ("." + path.filename().string() + "." + std::to_string(::getpid()) +
                               "-" + std::to_string(counter++) + ".tmp");
}

}  // namespace

WholeFile::WholeFile(std::filesystem::path path) : path_(std::move(path)) {
  if (isFolder(path_)) {
    throw EnvironmentError("cannot write '" + path_.string() + "': it is a folder");
  }
  // A file without a name leaves no trace if the process is killed.  Not every file system has
  // them, and naming them later needs /proc.
  const std::filesystem::path folder = path_.has_parent_path() ? path_.parent_path() : ".";
  if (::access("/proc/self/fd", X_OK) == 0) {
    descriptor_ = ::open(folder.c_str(), O_TMPFILE | O_WRONLY | O_CLOEXEC, 0666);
  }
  if (descriptor_ < 0) {
    temporary_ = temporaryFor(path_);  // stays empty for a file without a name
    descriptor_ = ::open(temporary_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
  }
  if (descriptor_ < 0) fail("create", errno);
}

WholeFile::~WholeFile() {
  if (descriptor_ < 0) return;
  ::close(descriptor_);
  if (!temporary_.empty()) ::unlink(temporary_.c_str());
}

void WholeFile::write(const void* bytes, std::size_t count) {
  const char* next = static_cast<const char*>(bytes);
  while (count > 0) {
    const ssize_t written = ::write(descriptor_, next, std::min(count, kLongestWrite));
    if (written < 0) {
      if (errno == EINTR) continue;
      fail("write", errno);
    }
    next += written;
    count -= static_cast<std::size_t>(written);
  }
}

void WholeFile::commit() {
  // EINVAL: a file system that cannot flush a single file, which is no fault of the data.
  if (::fsync(descriptor_) != 0 && errno != EINVAL) fail("write", errno);
  int cause = 0;
  if (temporary_.empty()) {
    // Straight to the final name if it is free; else by way of the temporary one, as rename() alone
    // replaces.
    const std::string source = "/proc/self/fd/" + std::to_string(descriptor_);
    const auto link = [&](const std::filesystem::path& name) {
      return ::linkat(AT_FDCWD, source.c_str(), AT_FDCWD, name.c_str(), AT_SYMLINK_FOLLOW) == 0;
    };
    if (link(path_)) {
      if (::close(std::exchange(descriptor_, -1)) != 0) fail("write", errno);
      return;
    }
    cause = errno;
    temporary_ = temporaryFor(path_);
    if (cause == EEXIST) cause = link(temporary_) ? 0 : errno;
  }
  const int closed = ::close(std::exchange(descriptor_, -1));
  if (cause == 0 && closed != 0) cause = errno;
  if (cause == 0 && ::rename(temporary_.c_str(), path_.c_str()) != 0) cause = errno;
  if (cause != 0) {
    ::unlink(temporary_.c_str());
    fail("write", cause);
  }
}

void WholeFile::fail(std::string_view action, int cause) {
  throw EnvironmentError("cannot " + std::string(action) + " '" + path_.string() +
                         "': " + reasonOf(cause));
}

void writeTextFile(const std::filesystem::path& path, std::string_view text) {
  WholeFile file(path);
  file.write(text);
  file.commit();
}

}  // namespace explica
