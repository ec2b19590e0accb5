// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace explica {

/// FNV-1a of some bytes: tells a damaged file or another surface, not a forged one.
[[nodiscard]] std::uint64_t checkSum(std::string_view bytes,
                                     std::uint64_t before = 14695981039346656037u);

/// Gathers what a run needs to go on: little-endian numbers in an order that its reader knows.
class StateWriter {
 public:
  void number(double value) { raw(&value, sizeof value); }
  void count(std::int64_t value) { raw(&value, sizeof value); }
  void numbers(const std::vector<double>& list);
  void indices(const std::vector<std::int32_t>& list);
  /// The number of rows and the elements as they are stored.
  template <class Matrix>
  void rows(const Matrix& m) {
    count(m.rows());
    raw(m.data(), static_cast<std::size_t>(m.size()) * sizeof(typename Matrix::Scalar));
  }
  void raw(const void* data, std::size_t size) {
    bytes_.append(static_cast<const char*>(data), size);
  }
  /// Writes a whole file: `magic`, a check sum, what was gathered.
  /// @throws EnvironmentError  the file cannot be written
  void commit(const std::filesystem::path& path, std::string_view magic) const;

 private:
  std::string bytes_;
};

/// Reads what StateWriter wrote.
class StateReader {
 public:
  /// @param what  "a flat map": names the run in errors
  /// @throws IOError  absent, another format, damaged
  StateReader(const std::filesystem::path& path, std::string_view magic, std::string what);

  double number();
  /// @throws IOError  negative, or larger than the file
  std::int64_t count();
  std::vector<double> numbers();
  std::vector<std::int32_t> indices();
  template <class Matrix>
  Matrix rows() {
    Matrix m(count(), Matrix::ColsAtCompileTime);
    raw(m.data(), static_cast<std::size_t>(m.size()) * sizeof(typename Matrix::Scalar));
    return m;
  }
  void raw(void* data, std::size_t size);
  [[nodiscard]] bool atEnd() const { return at_ == bytes_.size(); }
  [[noreturn]] void fail(const std::string& cause) const;

 private:
  std::string bytes_, name_, what_;
  std::size_t at_ = 0;
};

}  // namespace explica
