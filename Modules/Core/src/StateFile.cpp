// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Core/StateFile.h"
#include "Explica/Core/FileText.h"

#include "Explica/Core/Errors.h"
#include "Explica/Core/Folders.h"
#include "Explica/Core/WholeFile.h"

#include <cstring>
#include <iterator>

namespace explica {

static_assert(sizeof(std::int64_t) == 8 && sizeof(double) == 8);

std::uint64_t checkSum(std::string_view bytes, std::uint64_t before) {
  for (const char c : bytes) before = (before ^ static_cast<unsigned char>(c)) * 1099511628211u;
  return before;
}

void StateWriter::numbers(const std::vector<double>& list) {
  count(static_cast<std::int64_t>(list.size()));
  raw(list.data(), list.size() * sizeof(double));
}

void StateWriter::indices(const std::vector<std::int32_t>& list) {
  count(static_cast<std::int64_t>(list.size()));
  raw(list.data(), list.size() * sizeof(std::int32_t));
}

void StateWriter::commit(const std::filesystem::path& path, std::string_view magic) const {
  const std::uint64_t sum = checkSum(bytes_);
  WholeFile file(path);
  file.write(magic);
  file.write(&sum, sizeof sum);
  file.write(bytes_);
  file.commit();
}

constexpr std::size_t kMostState = std::size_t{16} << 30;  // bytes: of the largest surfaces

StateReader::StateReader(const std::filesystem::path& path, std::string_view magic,
                         std::string what)
    : name_(path.string()), what_(std::move(what)) {
  if (!isThere(path)) {
    throw IOError(name_ + " cannot be read; nothing was left to resume from");
  }
  const std::string all = fileText(path, kMostState);
  std::uint64_t sum = 0;
  if (!std::string_view(all).starts_with(magic) || all.size() < magic.size() + sizeof sum) {
    fail("has another format");
  }
  std::memcpy(&sum, all.data() + magic.size(), sizeof sum);
  bytes_ = all.substr(magic.size() + sizeof sum);
  if (sum != checkSum(bytes_)) fail("is damaged");
}

double StateReader::number() {
  double value = 0;
  raw(&value, sizeof value);
  return value;
}

std::int64_t StateReader::count() {
  std::int64_t value = 0;
  raw(&value, sizeof value);
  if (value < 0 || static_cast<std::size_t>(value) > bytes_.size()) fail("is damaged");
  return value;
}

std::vector<double> StateReader::numbers() {
  std::vector<double> list(static_cast<std::size_t>(count()));
  raw(list.data(), list.size() * sizeof(double));
  return list;
}

std::vector<std::int32_t> StateReader::indices() {
  std::vector<std::int32_t> list(static_cast<std::size_t>(count()));
  raw(list.data(), list.size() * sizeof(std::int32_t));
  return list;
}

void StateReader::raw(void* data, std::size_t size) {
  if (at_ + size > bytes_.size()) fail("is truncated");
  std::memcpy(data, bytes_.data() + at_, size);
  at_ += size;
}

void StateReader::fail(const std::string& cause) const {
  throw IOError(name_ + " " + cause + "; it is not a complete state of " + what_);
}

}  // namespace explica
