// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Bytes.h"
#include "StoredVolume.h"

#include <map>
#include <string>
#include <vector>

namespace explica::io {

/// An attribute: text or numbers.
struct MincAttribute {
  std::string text;
  std::vector<double> numbers;
};

/// An array of a MINC file, without its values.
struct MincArray {
  std::vector<std::string> dimensions;  ///< slowest first
  std::vector<std::int64_t> size;
  StoredType type = StoredType::Float64;
  std::map<std::string, MincAttribute> attributes;
};

/// The arrays of a MINC file, in whichever container they stand.
class MincStore {
 public:
  virtual ~MincStore() = default;
  /// The array of that name, or nullptr.
  [[nodiscard]] virtual const MincArray* find(const std::string& name) const = 0;
  /// Its values in native byte order, last dimension fastest.
  /// @throws IOError  the file is too short for them or damaged
  [[nodiscard]] virtual Bytes valuesOf(const std::string& name) const = 0;
};

/// Number of values of an array.
[[nodiscard]] std::int64_t valueCount(const std::filesystem::path& path, const MincArray& array);

}  // namespace explica::io
