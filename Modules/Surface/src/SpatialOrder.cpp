// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "SpatialOrder.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <vector>

namespace explica::surface {
namespace {

constexpr int kBitsPerAxis = 21;  // three times 21 fit into 64

/// Puts two zeros before each of the lowest 21 bits.
std::uint64_t spreadBits(std::uint64_t x) {
  x &= (1ULL << kBitsPerAxis) - 1;
  x = (x | x << 32) & 0x1f00000000ffffULL;
  x = (x | x << 16) & 0x1f0000ff0000ffULL;
  x = (x | x << 8) & 0x100f00f00f00f00fULL;
  x = (x | x << 4) & 0x10c30c30c30c30c3ULL;
  x = (x | x << 2) & 0x1249249249249249ULL;
  return x;
}

std::vector<std::uint64_t> codesOf(const Positions& positions, double block) {
  const Eigen::RowVector3d low = positions.colwise().minCoeff();
  constexpr double kLast = (1 << kBitsPerAxis) - 1;
  std::vector<std::uint64_t> codes(positions.rows(), 0);
  for (Eigen::Index v = 0; v < positions.rows(); ++v) {
    for (int a = 0; a < 3; ++a) {
      const double at = std::clamp(std::floor((positions(v, a) - low[a]) / block), 0.0, kLast);
      codes[v] |= spreadBits(static_cast<std::uint64_t>(at)) << a;
    }
  }
  return codes;
}

template <class Key>
std::vector<std::int32_t> orderBy(const std::vector<Key>& keys) {
  std::vector<std::int32_t> order(keys.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::int32_t a, std::int32_t b) { return keys[a] < keys[b]; });
  return order;
}

}  // namespace

TriangleMesh inSpatialOrder(const TriangleMesh& mesh, double block) {
  if (mesh.vertexCount() == 0) return mesh;
  const std::vector<std::int32_t> vertices = orderBy(codesOf(mesh.positions, block));
  TriangleMesh ordered;
  ordered.positions.resize(mesh.vertexCount(), 3);
  std::vector<std::int32_t> numberOf(vertices.size());
  for (std::size_t v = 0; v < vertices.size(); ++v) {
    ordered.positions.row(v) = mesh.positions.row(vertices[v]);
    numberOf[vertices[v]] = static_cast<std::int32_t>(v);
  }
  std::vector<std::int32_t> firstOf(mesh.faceCount());
  for (Eigen::Index f = 0; f < mesh.faceCount(); ++f) {
    firstOf[f] = std::min(
        {numberOf[mesh.faces(f, 0)], numberOf[mesh.faces(f, 1)], numberOf[mesh.faces(f, 2)]});
  }
  const std::vector<std::int32_t> faces = orderBy(firstOf);
  ordered.faces.resize(mesh.faceCount(), 3);
  for (std::size_t f = 0; f < faces.size(); ++f) {
    for (int c = 0; c < 3; ++c) ordered.faces(f, c) = numberOf[mesh.faces(faces[f], c)];
  }
  return ordered;
}

}  // namespace explica::surface
