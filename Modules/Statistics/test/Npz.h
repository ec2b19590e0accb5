// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <zlib.h>
#include <Eigen/Core>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

namespace explica::statistics::testing {

/// An array of numpy as doubles, in C order.
struct Array {
  std::vector<Eigen::Index> shape;
  std::vector<double> values;

  [[nodiscard]] Eigen::Index extent(std::size_t axis) const {
    return axis < shape.size() ? shape[axis] : 1;
  }
  /// As a matrix of `rows` rows, in C order.
  [[nodiscard]] Eigen::MatrixXd matrix(Eigen::Index rows) const {
    return Eigen::Map<const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>(
        values.data(), rows, static_cast<Eigen::Index>(values.size()) / rows);
  }
  [[nodiscard]] Eigen::MatrixXd matrix() const { return matrix(extent(0)); }
  [[nodiscard]] Eigen::VectorXd vector() const {
    return Eigen::Map<const Eigen::VectorXd>(values.data(),
                                             static_cast<Eigen::Index>(values.size()));
  }
  [[nodiscard]] double scalar() const { return values.at(0); }
};

template <class T>
T read(const std::string& bytes, std::size_t at) {
  T value;
  std::memcpy(&value, bytes.data() + at, sizeof value);
  return value;
}

template <class T>
std::vector<double> numbers(const std::string& bytes) {
  std::vector<double> values;
  for (std::size_t at = 0; at < bytes.size(); at += sizeof(T)) {
    values.push_back(static_cast<double>(read<T>(bytes, at)));
  }
  return values;
}

inline std::string inflated(const std::string& packed, std::size_t size) {
  std::string bytes(size, '\0');
  z_stream stream{};
  inflateInit2(&stream, -MAX_WBITS);
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(packed.data()));
  stream.avail_in = static_cast<uInt>(packed.size());
  stream.next_out = reinterpret_cast<Bytef*>(bytes.data());
  stream.avail_out = static_cast<uInt>(size);
  const int state = inflate(&stream, Z_FINISH);
  inflateEnd(&stream);
  if (state != Z_STREAM_END) throw std::runtime_error("npz: cannot be unpacked");
  return bytes;
}

inline Array parseNpy(const std::string& bytes) {
  const std::size_t length = read<std::uint16_t>(bytes, 8);
  const std::string header = bytes.substr(10, length), data = bytes.substr(10 + length);
  Array array;
  const std::size_t open = header.find('('), close = header.find(')');
  std::istringstream shape(header.substr(open + 1, close - open - 1));
  for (std::string part; std::getline(shape, part, ',');) {
    if (part.find_first_of("0123456789") != part.npos) array.shape.push_back(std::stol(part));
  }
  const auto is = [&](const char* type) { return header.find(type) != header.npos; };
  if (is("'<f8'"))
    array.values = numbers<double>(data);
  else if (is("'<i8'"))
    array.values = numbers<std::int64_t>(data);
  else if (is("'<i4'"))
    array.values = numbers<std::int32_t>(data);
  else if (is("'<u2'"))
    array.values = numbers<std::uint16_t>(data);
  else if (is("'|b1'"))
    array.values = numbers<std::uint8_t>(data);
  else
    throw std::runtime_error("npz: type of " + header);
  if (is("'fortran_order': True") && array.shape.size() > 1) {
    if (array.shape.size() > 2 && array.extent(2) > 1) throw std::runtime_error("npz: order");
    const Eigen::MatrixXd turned =
        Eigen::Map<const Eigen::MatrixXd>(array.values.data(), array.extent(0), array.extent(1))
            .transpose();
    array.values.assign(turned.data(), turned.data() + turned.size());
  }
  return array;
}

/// Reads numpy's .npz: a zip archive of .npy files, as np.savez and np.savez_compressed write it.
inline std::map<std::string, Array> readNpz(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::stringstream all;
  all << file.rdbuf();
  const std::string bytes = all.str();
  std::map<std::string, Array> arrays;
  const std::size_t end = bytes.rfind("PK\5\6");
  std::size_t at = read<std::uint32_t>(bytes, end + 16);
  for (int count = read<std::uint16_t>(bytes, end + 10); count > 0; --count) {
    const auto method = read<std::uint16_t>(bytes, at + 10);
    const auto packed = read<std::uint32_t>(bytes, at + 20),
               size = read<std::uint32_t>(bytes, at + 24);
    const auto name = read<std::uint16_t>(bytes, at + 28),
               extra = read<std::uint16_t>(bytes, at + 30),
               comment = read<std::uint16_t>(bytes, at + 32);
    const auto local = read<std::uint32_t>(bytes, at + 42);
    const std::size_t begin = local + 30U + read<std::uint16_t>(bytes, local + 26) +
                              read<std::uint16_t>(bytes, local + 28);
    const std::string content = bytes.substr(begin, packed);
    const std::string key = bytes.substr(at + 46, name);
    arrays[key.substr(0, key.size() - 4)] =
        parseNpy(method == 0 ? content : inflated(content, size));
    at += 46U + name + extra + comment;
  }
  return arrays;
}

}  // namespace explica::statistics::testing
