// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Flattening/Selection.h"

#include "Explica/Core/Errors.h"

#include <algorithm>
#include <array>
#include <string>

namespace explica::flattening {
namespace {

std::array<std::int32_t, 3> sortedCorners(const Faces& faces, Eigen::Index f) {
  std::array<std::int32_t, 3> corners = {faces(f, 0), faces(f, 1), faces(f, 2)};
  std::ranges::sort(corners);
  return corners;
}

}  // namespace

std::vector<std::int32_t> facesAlsoIn(const Faces& faces, std::span<const std::int32_t> listed,
                                      const Faces& others) {
  std::vector<std::array<std::int32_t, 3>> known;
  for (Eigen::Index f = 0; f < others.rows(); ++f) known.push_back(sortedCorners(others, f));
  std::ranges::sort(known);
  std::vector<std::int32_t> kept;
  for (const std::int32_t f : listed) {
    if (std::ranges::binary_search(known, sortedCorners(faces, f))) kept.push_back(f);
  }
  return kept;
}

std::vector<std::int32_t> facesWithin(const Faces& faces, std::span<const std::int32_t> listed,
                                      const VertexKeys& keys, std::optional<Label> key) {
  std::vector<std::int32_t> kept;
  for (const std::int32_t f : listed) {
    bool all = true;
    for (int k = 0; k < 3; ++k) {
      const Label at = keys[faces(f, k)];
      all = all && (key ? at == *key : at != 0);
    }
    if (all) kept.push_back(f);
  }
  if (kept.empty()) {
    throw InvalidInput(key ? "label: no face has key " + std::to_string(*key) + " at its vertices"
                           : "label: it is 0 at every face, so that nothing is left");
  }
  return kept;
}

}  // namespace explica::flattening
