// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Bytes.h"

#include "Explica/Core/Types.h"
#include "Explica/IO/VertexDataFile.h"

#include <filesystem>
#include <string>
#include <vector>

namespace explica::io {

/// Collects the arrays of a VTK XML file that stand raw behind the document.
class AppendedArrays {
 public:
  /// Keeps an array of `size` bytes and returns the element that points to it.
  std::string add(const std::string& name, const char* type, int components, const void* values,
                  std::size_t size, const char* more = "");
  [[nodiscard]] const Bytes& bytes() const { return bytes_; }

 private:
  Bytes bytes_;
};

/// XML polydata whose cells, all "Polys" or all "Lines", have the same length.
void writePolyData(const std::filesystem::path& path, const Positions& points, const char* cellName,
                   const std::int32_t* connectivity, Eigen::Index cellCount, int cellLength,
                   const std::vector<VertexMap>& pointMaps, const std::vector<VertexMap>& cellMaps);

}  // namespace explica::io
