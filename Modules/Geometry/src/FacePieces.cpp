// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Geometry/FacePieces.h"

#include "Explica/Geometry/MeshMeasures.h"

#include <algorithm>
#include <iterator>

namespace explica::geometry {

std::vector<std::vector<std::int32_t>> fansAt(const Faces& faces, std::int32_t vertex,
                                              std::span<const std::int32_t> around,
                                              const std::function<bool(std::int32_t)>& isCut) {
  const auto areJoined = [&](std::int32_t f, std::int32_t g) {
    for (const std::int32_t v : faces.row(f)) {
      const bool isShared = v == faces(g, 0) || v == faces(g, 1) || v == faces(g, 2);
      if (isShared && v != vertex && !(isCut && isCut(v))) return true;
    }
    return false;
  };
  std::vector<std::vector<std::int32_t>> fans;
  std::vector<std::int32_t> left(around.begin(), around.end());
  while (!left.empty()) {
    std::vector<std::int32_t>& fan = fans.emplace_back(1, left.front());
    left.erase(left.begin());
    for (std::size_t at = 0; at < fan.size(); ++at) {
      const auto isNext = [&](std::int32_t f) { return areJoined(fan[at], f); };
      std::ranges::copy_if(left, std::back_inserter(fan), isNext);
      std::erase_if(left, isNext);
    }
  }
  return fans;
}

std::vector<double> pieceAreas(const TriangleMesh& mesh, const std::vector<std::int32_t>& piece) {
  const Eigen::VectorXd areas = faceAreas(mesh);
  std::vector<double> sums;
  for (std::size_t f = 0; f < piece.size(); ++f) {
    if (piece[f] < 0) continue;
    if (piece[f] >= static_cast<std::int32_t>(sums.size())) sums.resize(piece[f] + 1, 0.0);
    sums[piece[f]] += areas[static_cast<Eigen::Index>(f)];
  }
  return sums;
}

}  // namespace explica::geometry
