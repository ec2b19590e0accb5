// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "ByteSource.h"

#include "Explica/Core/StopScope.h"
#include "VectorState.h"

#include <fcntl.h>
#include <isa-l/igzip_lib.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>

namespace explica::io {
namespace {

constexpr std::uint64_t kLargestInflation = 1032;  // deflate packs at most 258 bytes into 2 bits
constexpr std::size_t kLongestStep = std::size_t{1} << 30;  // ISA-L counts in 32 bits
constexpr std::size_t kReadAtOnce = std::size_t{1} << 26;   // bytes between checkpoints

bool isGzip(ByteView bytes) {
  return bytes.size() > 2 && bytes[0] == 0x1f && bytes[1] == 0x8b;
}

/// Unpacks one gzip member or zlib stream piece by piece; checksums are verified.
class Inflater {
 public:
  enum class Progress { Some, None, Done, Damaged };

  explicit Inflater(bool gzip) : gzip_(gzip) { begin(); }

  /// Gets ready for another member.
  void begin() {
    isal_inflate_init(&state_);
    state_.crc_flag = gzip_ ? ISAL_GZIP : ISAL_ZLIB;
  }

  /// Unpacks from `in` on to `out`, and moves both on.
  Progress step(ByteView& in, std::span<std::uint8_t>& out) {
    const auto input = static_cast<std::uint32_t>(std::min(in.size(), kLongestStep));
    const auto room = static_cast<std::uint32_t>(std::min(out.size(), kLongestStep));
    std::uint8_t none = 0;  // an address even for no room
    state_.next_in = const_cast<std::uint8_t*>(in.data());
    state_.avail_in = input;
    state_.next_out = room > 0 ? out.data() : &none;
    state_.avail_out = room;
    const int status = isal_inflate(&state_);
    endVectorCode();
    // Of damaged data ISA-L can say that it took more than there is.
    if (status < 0 || status == ISAL_NEED_DICT || state_.avail_in > input) return Progress::Damaged;
    const std::uint32_t taken = input - state_.avail_in, made = room - state_.avail_out;
    in = in.subspan(taken);
    out = out.subspan(made);
    if (state_.block_state == ISAL_BLOCK_FINISH) return Progress::Done;
    return taken > 0 || made > 0 ? Progress::Some : Progress::None;
  }

 private:
  bool gzip_;
  inflate_state state_;
};

}  // namespace

/// A regular file that is read once from its beginning on.
class ByteSource::OpenFile {
 public:
  /// @throws IOError  missing, a folder, not permitted, empty
  explicit OpenFile(const std::filesystem::path& path) : path_(path) {
    descriptor_ = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    if (descriptor_ < 0) {
      const int cause = errno;
      failToRead(path, cause == ENOENT   ? "no such file"
                       : cause == EACCES ? "permission to read it is denied"
                                         : std::generic_category().message(cause));
    }
    struct stat status {};
    std::string fault;
    if (::fstat(descriptor_, &status) != 0) {
      fault = std::generic_category().message(errno);
    } else if (S_ISDIR(status.st_mode)) {
      fault = "is a folder; a file is needed";
    } else if (!S_ISREG(status.st_mode)) {
      fault = "is not a regular file";
    } else if (status.st_size == 0) {
      fault = "is empty";
    }
    if (!fault.empty()) {
      ::close(descriptor_);
      failToRead(path, fault);
    }
    size_ = static_cast<std::uint64_t>(status.st_size);
  }
  ~OpenFile() { ::close(descriptor_); }
  OpenFile(const OpenFile&) = delete;
  OpenFile& operator=(const OpenFile&) = delete;

  /// The next bytes, fewer only at the end.
  std::size_t read(std::uint8_t* to, std::size_t count) {
    std::size_t filled = 0;
    while (filled < count) {
      checkpoint();
      const ssize_t got =
          ::read(descriptor_, to + filled, std::min<std::size_t>(count - filled, kReadAtOnce));
      if (got < 0 && errno == EINTR) continue;
      if (got < 0) failToRead(path_, std::generic_category().message(errno));
      if (got == 0) break;
      filled += static_cast<std::size_t>(got);
    }
    taken_ += filled;
    return filled;
  }
  [[nodiscard]] std::uint64_t size() const { return size_; }
  [[nodiscard]] std::uint64_t left() const { return taken_ < size_ ? size_ - taken_ : 0; }

 private:
  std::filesystem::path path_;
  int descriptor_ = -1;
  std::uint64_t size_ = 0;
  std::uint64_t taken_ = 0;
};

std::filesystem::path besideFile(const std::filesystem::path& header, const std::string& name) {
  const std::filesystem::path below(name);
  const bool leaves = below.is_absolute() || std::ranges::find(below, "..") != below.end();
  if (leaves || name.empty()) {
    refuse(header, "names the file '" + name + "' for its data; one in its own folder is read");
  }
  return header.parent_path() / below;
}

Bytes readFile(const std::filesystem::path& path) {
  ByteSource::OpenFile file(path);
  Bytes bytes(file.size());
  bytes.resize(file.read(bytes.data(), bytes.size()));
  return bytes;
}

struct ByteSource::Members {
  Inflater inflater{true};
  bool memberDone = false;
  bool done = false;
};

ByteSource::ByteSource(const std::filesystem::path& path)
    : path_(path), file_(std::make_unique<OpenFile>(path)) {
  fetch();
  if (isGzip(chunk_)) members_ = std::make_unique<Members>();
}

ByteSource::~ByteSource() = default;

bool ByteSource::fetch() {
  constexpr std::size_t kChunk = std::size_t{1} << 20;  // bytes taken from the file at a time
  chunk_.erase(chunk_.begin(), chunk_.begin() + static_cast<std::ptrdiff_t>(at_));
  at_ = 0;
  const std::size_t held = chunk_.size();
  chunk_.resize(held + std::min<std::uint64_t>(kChunk, file_->left()));
  const std::size_t got = file_->read(chunk_.data() + held, chunk_.size() - held);
  chunk_.resize(held + got);
  return got > 0;
}

ByteView ByteSource::peek(std::size_t count) {
  peeked_.erase(peeked_.begin(), peeked_.begin() + static_cast<std::ptrdiff_t>(peekedAt_));
  peekedAt_ = 0;
  if (peeked_.size() < count) {
    const std::size_t held = peeked_.size();
    peeked_.resize(count);
    peeked_.resize(held + readOn(peeked_.data() + held, count - held));
  }
  return ByteView(peeked_).first(std::min(count, peeked_.size()));
}

std::size_t ByteSource::read(std::uint8_t* to, std::size_t count) {
  const std::size_t held = std::min(count, peeked_.size() - peekedAt_);
  if (held > 0) std::memcpy(to, peeked_.data() + peekedAt_, held);
  peekedAt_ += held;
  return held + (held < count ? readOn(to + held, count - held) : 0);
}

std::size_t ByteSource::readOn(std::uint8_t* to, std::size_t count) {
  if (members_) return unpack(to, count);
  const std::size_t held = std::min(count, chunk_.size() - at_);
  if (held > 0) std::memcpy(to, chunk_.data() + at_, held);
  at_ += held;
  return held + (held < count ? file_->read(to + held, count - held) : 0);
}

std::size_t ByteSource::unpack(std::uint8_t* to, std::size_t count) {
  constexpr std::size_t kLongestHeader = 64;  // enough of a member to see that it is one
  std::span<std::uint8_t> room(to, count);
  while (!members_->done) {
    if (chunk_.size() - at_ < kLongestHeader) fetch();
    ByteView left = ByteView(chunk_).subspan(at_);
    if (members_->memberDone) {
      if (!isGzip(left)) {  // padding after the last member is allowed
        members_->done = true;
        break;
      }
      members_->inflater.begin();
      members_->memberDone = false;
    }
    const auto progress = members_->inflater.step(left, room);
    at_ = chunk_.size() - left.size();
    if (progress == Inflater::Progress::Damaged) failToRead(path_, "the gzip data are damaged");
    members_->memberDone = progress == Inflater::Progress::Done;
    if (room.empty() && !members_->memberDone) break;
    if (progress == Inflater::Progress::None && !fetch()) {
      failTruncated(path_, "the gzip data end too early");
    }
  }
  return count - room.size();
}

Bytes ByteSource::take(std::uint64_t count) {
  if (count > leftAtMost()) {
    failTruncated(path_, "the file is too short for the " + std::to_string(count) +
                             " bytes that its header announces");
  }
  Bytes taken(count);
  const std::size_t got = read(taken.data(), taken.size());
  if (got < count) {
    failTruncated(path_, "the file ends " + std::to_string(count - got) + " bytes too early (" +
                             std::to_string(count) + " needed here)");
  }
  return taken;
}

void ByteSource::skip(std::uint64_t count) {
  std::array<std::uint8_t, 1 << 14> scratch;
  while (count > 0) {
    const std::size_t step = std::min<std::uint64_t>(count, scratch.size());
    const std::size_t got = read(scratch.data(), step);
    if (got < step) failTruncated(path_, "the file ends before its data");
    count -= got;
  }
}

std::uint64_t ByteSource::finish() {
  if (!members_) return leftAtMost();
  constexpr std::uint64_t kMostLeft = std::uint64_t{16}
                                      << 20;  // bytes: tags of FreeSurfer and others
  std::array<std::uint8_t, 1 << 14> scratch;
  std::uint64_t left = 0;
  while (const std::size_t got = read(scratch.data(), scratch.size())) {
    left += got;
    if (left > kMostLeft) {
      failToRead(path_,
                 "its packed data go on for more than 16 MB after the values that its header "
                 "announces; it is damaged, or made to fill memory");
    }
  }
  return left;
}

Bytes ByteSource::rest(std::uint64_t mostUnpacked) {
  constexpr std::uint64_t kSmall = std::uint64_t{32} << 20, kMostTimes = 100;
  Bytes all;
  std::size_t filled = 0;
  std::size_t room = members_ ? 4 * file_->size() + 4096 : leftAtMost();
  if (members_) mostUnpacked = std::min(mostUnpacked, std::max(kSmall, kMostTimes * file_->size()));
  while (true) {
    if (members_) room = std::min<std::size_t>(room, mostUnpacked + 1 - filled);
    all.resize(filled + room);
    const std::size_t got = read(all.data() + filled, room);
    filled += got;
    if (members_ && filled > mostUnpacked) {
      failToRead(path_, "unpacks to more than " + std::to_string(mostUnpacked >> 20) +
                            " MB, far more than such a file holds");
    }
    if (got < room || !members_) break;
    room = filled;
  }
  all.resize(filled);
  return all;
}

std::uint64_t ByteSource::leftAtMost() const {
  const std::uint64_t left = chunk_.size() - at_ + file_->left();
  const std::uint64_t held = peeked_.size() - peekedAt_;
  // What is taken in but not yet given out is bounded by two windows and a match.
  return held + (members_ ? left * kLargestInflation + (1U << 17) : left);
}

Bytes inflateExactly(const std::filesystem::path& path, ByteView packed, std::uint64_t size) {
  if (size > packed.size() * kLargestInflation + 64) {
    failToRead(path, "a packed block is too short for the values it should hold");
  }
  Bytes unpacked(size);
  Inflater inflater(isGzip(packed));
  std::span<std::uint8_t> room(unpacked);
  auto progress = Inflater::Progress::Some;
  while (progress == Inflater::Progress::Some) progress = inflater.step(packed, room);
  if (progress != Inflater::Progress::Done || !room.empty()) {
    failToRead(path, "a packed block is damaged, or holds another number of values than stated");
  }
  return unpacked;
}

Bytes decodeBase64(const std::filesystem::path& path, std::string_view text) {
  static const std::array<std::int16_t, 256> kValues = [] {
    std::array<std::int16_t, 256> values;
    values.fill(-1);
    for (std::size_t i = 0; i < kBase64.size(); ++i) {
      values[static_cast<std::uint8_t>(kBase64[i])] = static_cast<std::int16_t>(i);
    }
    for (const char blank : {' ', '\n', '\r', '\t'}) values[static_cast<std::uint8_t>(blank)] = -2;
    return values;
  }();
  Bytes decoded;
  decoded.reserve(text.size() / 4 * 3 + 3);
  std::uint32_t bits = 0;
  int held = 0;
  for (const char c : text) {
    if (c == '=') break;
    const int value = kValues[static_cast<std::uint8_t>(c)];
    if (value == -2) continue;
    if (value < 0) failToRead(path, "base64 data hold a character that is not base64's");
    bits = bits << 6 | static_cast<std::uint32_t>(value);
    held += 6;
    if (held >= 8) {
      held -= 8;
      decoded.push_back(static_cast<std::uint8_t>(bits >> held));
    }
  }
  return decoded;
}

}  // namespace explica::io
