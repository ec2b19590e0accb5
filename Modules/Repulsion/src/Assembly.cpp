// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Assembly.h"

#include "Explica/Core/Parallel.h"

#include <algorithm>
#include <utility>

namespace explica::repulsion {
namespace {

/// The vertices of two faces and the integral over them.
struct PairTerm {
  std::array<std::int32_t, 3> cornersS, cornersT;
  PairIntegral integral;
};

}  // namespace

KnotValue assemble(const MovingSet& set, const Positions& positions,
                   const std::vector<FaceForce>& forces, PairAccuracy accuracy,
                   const std::vector<std::array<std::int32_t, 2>>& apart) {
  KnotValue result;
  result.gradient.setZero(positions.rows(), 3);
  for (std::size_t k = 0; k < forces.size(); ++k) {
    result.value += forces[k].value;
    for (int c = 0; c < 3; ++c) {
      result.gradient.row(set.faces(set.moving[k], c)) += forces[k].byCorner[c].transpose();
    }
  }

  const auto add = [&](std::size_t count, const auto& cornersOfPair, const auto& integrate) {
    constexpr std::size_t kAtOnce = 1 << 16;  // bounds the memory
    std::vector<PairTerm> terms;
    for (std::size_t begin = 0; begin < count; begin += kAtOnce) {
      terms.resize(std::min(kAtOnce, count - begin));
      parallelFor(terms.size(), 64, [&](std::size_t i) {
        const auto [s, t] = cornersOfPair(begin + i);
        terms[i] = {s, t, integrate(cornersOf(positions, s), cornersOf(positions, t), accuracy)};
      });
      for (const auto& [s, t, integral] : terms) {
        result.value += 2 * integral.value;
        for (int c = 0; c < 3; ++c) {
          result.gradient.row(s[c]) += 2 * integral.byS[c].transpose();
          result.gradient.row(t[c]) += 2 * integral.byT[c].transpose();
        }
      }
    }
  };
  const auto listed = [](const std::vector<AdjacentPair>& pairs) {
    return [&pairs](std::size_t i) { return std::pair(pairs[i].cornersS, pairs[i].cornersT); };
  };
  const auto ofFaces = [&](std::size_t i) {
    return std::pair(verticesOf(set.faces, apart[i][0]), verticesOf(set.faces, apart[i][1]));
  };
  add(set.edgePairs.size(), listed(set.edgePairs), integrateEdgeSharing);
  add(set.vertexPairs.size(), listed(set.vertexPairs), integrateVertexSharing);
  add(apart.size(), ofFaces, integrateApart);
  for (Eigen::Index v = 0; v < positions.rows(); ++v) {
    if (!set.vertexMoves[v]) result.gradient.row(v).setZero();
  }
  return result;
}

}  // namespace explica::repulsion
