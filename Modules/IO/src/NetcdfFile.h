// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "MincStore.h"

namespace explica::io {

/// Arrays of a netCDF file in its classic form (CDF-1, or CDF-2 with offsets of 64 bits), as MINC 1
/// has them [netCDF file format specification].
class NetcdfFile : public MincStore {
 public:
  /// @param bytes  the whole file; must outlive this object
  /// @throws IOError  damaged
  NetcdfFile(const std::filesystem::path& path, ByteView bytes);
  [[nodiscard]] const MincArray* find(const std::string& name) const override;
  [[nodiscard]] Bytes valuesOf(const std::string& name) const override;

 private:
  struct Placed {
    MincArray array;
    std::uint64_t begin = 0;
    bool grows = false;  ///< along the unlimited dimension
  };
  class Header;

  std::filesystem::path path_;
  ByteView bytes_;
  std::map<std::string, Placed> arrays_;
};

[[nodiscard]] bool looksLikeNetcdf(ByteView bytes);

}  // namespace explica::io
