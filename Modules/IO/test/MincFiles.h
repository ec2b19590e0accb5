// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <hdf5.h>

#include <array>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <string>
#include <vector>

// Small MINC files: version 1 byte by byte as netCDF's specification has it, version 2 by HDF5's
// own library.  Both hold 2 x 3 x 4 (z, y, x) values n = 0 to 23 as int16, scaled slice by slice:
// slice 0 to n / 2, slice 1 to 10 + n, by a valid range of 0 to 100.

/// Bytes of a classic netCDF file, big-endian.
class NetcdfBytes {
 public:
  void number(std::uint32_t value) {
    for (int shift = 24; shift >= 0; shift -= 8) bytes += static_cast<char>(value >> shift & 0xFF);
  }
  void real(double value) {
    std::uint64_t bits = 0;
    std::memcpy(&bits, &value, sizeof bits);
    number(static_cast<std::uint32_t>(bits >> 32));
    number(static_cast<std::uint32_t>(bits));
  }
  void text(const std::string& value) {
    number(static_cast<std::uint32_t>(value.size()));
    bytes += value + std::string((4 - value.size() % 4) % 4, '\0');
  }
  void list(std::uint32_t tag, std::uint32_t count) {
    number(count == 0 ? 0 : tag);
    number(count);
  }
  void numbers(const std::string& name, const std::vector<double>& values) {
    text(name);
    number(6);
    number(static_cast<std::uint32_t>(values.size()));
    for (const double value : values) real(value);
  }
  void words(const std::string& name, const std::string& value) {
    text(name);
    number(2);
    text(value);
  }

  std::string bytes;
};

/// Slices, rows, columns.
using MincSize = std::array<std::uint32_t, 3>;
constexpr MincSize kSmallMinc = {2, 3, 4};

/// @param spacing  MINC's word for how a dimension is divided
/// @param size  others hold the same values again and again
inline std::string minc1Bytes(const std::string& spacing = "regular__",
                              const MincSize& size = kSmallMinc) {
  const std::uint32_t count = size[0] * size[1] * size[2];
  NetcdfBytes out;
  constexpr std::uint32_t kDimensions = 10, kVariables = 11, kAttributes = 12;
  constexpr std::uint32_t kShort = 3, kInt = 4, kDouble = 6;
  // The values' places follow the header, whose length does not depend on them.
  std::uint32_t begin = 0;
  for (int pass = 0; pass < 2; ++pass) {
    out.bytes = std::string("CDF\1", 4);
    out.number(0);
    out.list(kDimensions, 3);
    for (const auto& [name, axis] : {std::pair{"zspace", 0}, {"yspace", 1}, {"xspace", 2}}) {
      out.text(name);
      out.number(size[axis]);
    }
    out.list(kAttributes, 0);
    out.list(kVariables, 6);
    const auto variable = [&](const std::string& name, const std::vector<std::uint32_t>& over) {
      out.text(name);
      out.number(static_cast<std::uint32_t>(over.size()));
      for (const std::uint32_t dimension : over) out.number(dimension);
    };
    const auto place = [&](std::uint32_t type, std::uint32_t bytes, std::uint32_t offset) {
      out.number(type);
      out.number(bytes);
      out.number(begin + offset);
    };
    const auto dimension = [&](const std::string& name, double start, double step,
                               const std::vector<double>& cosines) {
      variable(name, {});
      out.list(kAttributes, 4);
      out.numbers("start", {start});
      out.numbers("step", {step});
      out.numbers("direction_cosines", cosines);
      out.words("spacing", spacing);
      place(kInt, 4, 0);
    };
    dimension("zspace", -20, 3, {0, 0, 1});
    dimension("yspace", 5, -2, {-0.6, 0.8, 0});
    dimension("xspace", 30, 1.5, {0.8, 0.6, 0});
    variable("image-max", {0});
    out.list(kAttributes, 0);
    place(kDouble, 8 * size[0], 8);
    variable("image-min", {0});
    out.list(kAttributes, 0);
    place(kDouble, 8 * size[0], 8 + 8 * size[0]);
    variable("image", {0, 1, 2});
    out.list(kAttributes, 2);
    out.numbers("valid_range", {0, 100});
    out.words("signtype", "signed__");
    place(kShort, 2 * count, 8 + 16 * size[0]);
    begin = static_cast<std::uint32_t>(out.bytes.size());
  }
  out.bytes += std::string(8, '\0');
  for (std::uint32_t z = 0; z < size[0]; ++z) out.real(z % 2 == 0 ? 50 : 110);
  for (std::uint32_t z = 0; z < size[0]; ++z) out.real(z % 2 == 0 ? 0 : 10);
  for (std::uint32_t n = 0; n < count; ++n) out.bytes += {'\0', static_cast<char>(n % 24)};
  return out.bytes;
}

/// @param packed  in chunks, by deflate after a shuffle; else one piece
inline void writeMinc2(const std::filesystem::path& path, bool packed = true,
                       const MincSize& dimensions = kSmallMinc) {
  const hid_t file = H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
  const auto group = [&](const char* name) {
    H5Gclose(H5Gcreate2(file, name, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
  };
  for (const char* name :
       {"/minc-2.0", "/minc-2.0/dimensions", "/minc-2.0/image", "/minc-2.0/image/0"}) {
    group(name);
  }
  const auto numbers = [](hid_t object, const char* name, const std::vector<double>& values) {
    const hsize_t count = values.size();
    const hid_t space = H5Screate_simple(1, &count, nullptr);
    const hid_t attribute =
        H5Acreate2(object, name, H5T_IEEE_F64LE, space, H5P_DEFAULT, H5P_DEFAULT);
    H5Awrite(attribute, H5T_NATIVE_DOUBLE, values.data());
    H5Aclose(attribute);
    H5Sclose(space);
  };
  const auto words = [](hid_t object, const char* name, const std::string& value) {
    const hid_t type = H5Tcopy(H5T_C_S1), space = H5Screate(H5S_SCALAR);
    H5Tset_size(type, value.size() + 1);
    const hid_t attribute = H5Acreate2(object, name, type, space, H5P_DEFAULT, H5P_DEFAULT);
    H5Awrite(attribute, type, value.c_str());
    H5Aclose(attribute);
    H5Sclose(space);
    H5Tclose(type);
  };
  const auto dimension = [&](const std::string& name, double start, double step,
                             const std::vector<double>& cosines) {
    const hid_t space = H5Screate(H5S_SCALAR);
    const hid_t set = H5Dcreate2(file, ("/minc-2.0/dimensions/" + name).c_str(), H5T_STD_I32LE,
                                 space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    numbers(set, "start", {start});
    numbers(set, "step", {step});
    numbers(set, "direction_cosines", cosines);
    words(set, "spacing", "regular__");
    H5Dclose(set);
    H5Sclose(space);
  };
  dimension("zspace", -20, 3, {0, 0, 1});
  dimension("yspace", 5, -2, {-0.6, 0.8, 0});
  dimension("xspace", 30, 1.5, {0.8, 0.6, 0});
  const auto array = [&](const char* name, hid_t stored, hid_t given, const void* values,
                         const std::vector<hsize_t>& size, const std::vector<hsize_t>& chunk) {
    const hid_t space = H5Screate_simple(static_cast<int>(size.size()), size.data(), nullptr);
    const hid_t how = H5Pcreate(H5P_DATASET_CREATE);
    if (!chunk.empty()) {
      H5Pset_chunk(how, static_cast<int>(chunk.size()), chunk.data());
      H5Pset_shuffle(how);
      H5Pset_deflate(how, 4);
    }
    const hid_t set = H5Dcreate2(file, name, stored, space, H5P_DEFAULT, how, H5P_DEFAULT);
    H5Dwrite(set, given, H5S_ALL, H5S_ALL, H5P_DEFAULT, values);
    words(set, "dimorder", size.size() == 1 ? "zspace" : "zspace,yspace,xspace");
    if (size.size() == 3) numbers(set, "valid_range", {0, 100});
    H5Dclose(set);
    H5Pclose(how);
    H5Sclose(space);
  };
  const hsize_t slices = dimensions[0], rows = dimensions[1], columns = dimensions[2];
  std::vector<std::int16_t> image(slices * rows * columns);
  for (std::size_t n = 0; n < image.size(); ++n) image[n] = static_cast<std::int16_t>(n % 24);
  std::vector<double> most(slices), least(slices);
  for (std::size_t z = 0; z < slices; ++z) {
    most[z] = z % 2 == 0 ? 50 : 110;
    least[z] = z % 2 == 0 ? 0 : 10;
  }
  // Chunks of other lengths than the image's: the last ones run over its edge.
  const std::vector<hsize_t> chunk = {slices / 2, rows * 2 / 3, columns * 3 / 4};
  array("/minc-2.0/image/0/image", H5T_STD_I16LE, H5T_NATIVE_SHORT, image.data(),
        {slices, rows, columns}, packed ? chunk : std::vector<hsize_t>{});
  array("/minc-2.0/image/0/image-max", H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, most.data(), {slices},
        {});
  array("/minc-2.0/image/0/image-min", H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, least.data(), {slices},
        {});
  H5Fclose(file);
}
