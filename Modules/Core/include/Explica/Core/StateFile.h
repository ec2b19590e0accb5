// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <type_traits>
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

/// Takes a run's numbers to a file.  With StateReading in its place the same list of members, a
/// template, reads them; whole numbers are -1 at least.
struct StateWriting {
  StateWriter& file;
  template <class Number>
  requires std::is_arithmetic_v<Number> || std::is_enum_v<Number>
  void operator()(const Number& value) const {
    if constexpr (std::is_floating_point_v<Number>) {
      file.number(value);
    } else {
      file.count(static_cast<std::int64_t>(value) + 1);
    }
  }
  template <class Derived>
  void operator()(const Eigen::PlainObjectBase<Derived>& rows) const {
    file.rows(rows);
  }
  void operator()(const std::uint64_t& sum) const { file.raw(&sum, sizeof sum); }
  void operator()(const std::vector<std::int32_t>& list) const { file.indices(list); }
  void operator()(const std::vector<double>& list) const { file.numbers(list); }
  template <class Item>
  void size(const std::vector<Item>& list) const {
    file.count(static_cast<std::int64_t>(list.size()));
  }
};

/// Takes a run's numbers from a file.
struct StateReading {
  StateReader& file;
  template <class Number>
  requires std::is_arithmetic_v<Number> || std::is_enum_v<Number>
  void operator()(Number& value) const {
    if constexpr (std::is_floating_point_v<Number>) {
      value = file.number();
    } else {
      value = static_cast<Number>(file.count() - 1);
    }
  }
  template <class Derived>
  void operator()(Eigen::PlainObjectBase<Derived>& rows) const {
    rows.derived() = file.rows<Derived>();
  }
  void operator()(std::uint64_t& sum) const { file.raw(&sum, sizeof sum); }
  void operator()(std::vector<std::int32_t>& list) const { list = file.indices(); }
  void operator()(std::vector<double>& list) const { list = file.numbers(); }
  template <class Item>
  void size(std::vector<Item>& list) const {
    list.resize(static_cast<std::size_t>(file.count()));
  }
};

}  // namespace explica
