// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "MoveTogether.h"

#include "Explica/Core/IndicesWhere.h"
#include "Explica/Core/Parallel.h"

#include <algorithm>

namespace explica::surface {
namespace {

/// The faces that have a corner among the marked vertices.
std::vector<std::int32_t> facesAt(const TriangleMesh& mesh,
                                  const std::vector<std::uint8_t>& isMarked) {
  std::vector<std::uint8_t> has(static_cast<std::size_t>(mesh.faceCount()));
  parallelFor(has.size(), 1 << 14, [&](std::size_t f) {
    const auto row = static_cast<Eigen::Index>(f);
    has[f] =
        isMarked[mesh.faces(row, 0)] | isMarked[mesh.faces(row, 1)] | isMarked[mesh.faces(row, 2)];
  });
  return indicesWhere(has.size(), [&](std::size_t f) { return has[f] != 0; });
}

}  // namespace

Point asStored(const Point& p) {
  Point stored;
  for (int a = 0; a < 3; ++a) {
    // Volatile: GCC 12 at -O3 takes the way to float and back for nothing when it joins two
    // components into one vector.
    const volatile float rounded = static_cast<float>(p[a]);
    stored[a] = rounded;
  }
  return stored;
}

std::vector<std::uint8_t> moveTogether(TriangleMesh& mesh, geometry::SelfIntersectionSearch& search,
                                       const std::vector<std::int32_t>& vertices, int attempts,
                                       const Attempts& to) {
  constexpr std::int32_t kStays = -1;
  std::vector<std::uint8_t> attempt(vertices.size(), 0);
  std::vector<std::int32_t> listed(static_cast<std::size_t>(mesh.vertexCount()), kStays);
  std::vector<std::uint8_t> changed(listed.size(), 0);
  Positions start(static_cast<Eigen::Index>(vertices.size()), 3);
  parallelFor(vertices.size(), 1024, [&](std::size_t n) {
    const std::int32_t v = vertices[n];
    listed[v] = static_cast<std::int32_t>(n);
    start.row(static_cast<Eigen::Index>(n)) = mesh.positions.row(v);
    const Point goal = asStored(to(v, 0));
    changed[v] = goal != Point(mesh.positions.row(v));
    mesh.positions.row(v) = goal;
  });
  for (;;) {
    const auto pairs = search.find(mesh, facesAt(mesh, changed));
    if (pairs.empty()) return attempt;
    std::fill(changed.begin(), changed.end(), std::uint8_t{0});
    std::vector<std::int32_t> retreating;
    for (const geometry::FacePair& pair : pairs) {
      for (const std::int32_t face : pair) {
        for (int k = 0; k < 3; ++k) {
          const std::int32_t v = mesh.faces(face, k);
          if (changed[v] || listed[v] == kStays || attempt[listed[v]] == attempts) continue;
          changed[v] = 1;
          retreating.push_back(v);
        }
      }
    }
    parallelFor(retreating.size(), 256, [&](std::size_t n) {
      const std::int32_t v = retreating[n], row = listed[v];
      const int next = ++attempt[row];
      if (next == attempts) {
        mesh.positions.row(v) = start.row(row);
      } else {
        mesh.positions.row(v) = asStored(to(v, next));
      }
    });
  }
}

}  // namespace explica::surface
