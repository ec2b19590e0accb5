// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Encoding.h"

#include <zlib.h>

#include <algorithm>
#include <array>

namespace explica::report {

std::string deflated(std::string_view bytes) {
  uLongf size = compressBound(static_cast<uLong>(bytes.size()));
  std::string packed(size, '\0');
  compress2(reinterpret_cast<Bytef*>(packed.data()), &size,
            reinterpret_cast<const Bytef*>(bytes.data()), static_cast<uLong>(bytes.size()), 9);
  packed.resize(size);
  return packed;
}

nlohmann::ordered_json packIntegers(const std::vector<std::int32_t>& values, int stride) {
  std::vector<std::uint32_t> folded(values.size());
  std::uint32_t most = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const std::int32_t before =
        stride > 0 && i >= static_cast<std::size_t>(stride) ? values[i - stride] : 0;
    const std::int32_t difference = values[i] - before;
    folded[i] =
        static_cast<std::uint32_t>(difference) << 1 ^ static_cast<std::uint32_t>(difference >> 31);
    most = std::max(most, folded[i]);
  }
  int planes = 1;
  while (planes < 4 && most >> (8 * planes) != 0) ++planes;
  std::string bytes;
  bytes.reserve(values.size() * planes);
  for (int p = 0; p < planes; ++p) {
    for (const std::uint32_t value : folded) bytes.push_back(static_cast<char>(value >> (8 * p)));
  }
  return {{"n", values.size()}, {"s", stride}, {"p", planes}, {"d", base64(deflated(bytes))}};
}

std::vector<std::int32_t> facesInOrder(const Faces& faces) {
  std::vector<std::array<std::int32_t, 3>> sorted;
  for (Eigen::Index f = 0; f < faces.rows(); ++f) {
    std::array<std::int32_t, 3> face = {faces(f, 0), faces(f, 1), faces(f, 2)};
    std::rotate(face.begin(), std::ranges::min_element(face), face.end());
    sorted.push_back(face);
  }
  std::ranges::sort(sorted);
  std::vector<std::int32_t> corners;
  for (const auto& face : sorted) corners.insert(corners.end(), face.begin(), face.end());
  return corners;
}

}  // namespace explica::report
