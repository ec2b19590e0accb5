// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Geometry/SelfIntersection.h"

#include "Explica/Core/Parallel.h"
#include "Explica/Geometry/FaceTree.h"
#include "Explica/Geometry/TriangleIntersection.h"

#include <algorithm>

namespace explica::geometry {
namespace {

bool facesIntersect(const TriangleMesh& mesh, std::int32_t f, std::int32_t g) {
  // Corners of f and g, the shared ones first and in the same order.
  std::array<int, 3> ofF = {0, 1, 2};
  std::array<int, 3> ofG = {0, 1, 2};
  int shared = 0;
  for (int i = 0; i < 3; ++i) {
    for (int j = shared; j < 3; ++j) {
      if (mesh.faces(f, ofF[i]) == mesh.faces(g, ofG[j])) {
        std::swap(ofF[i], ofF[shared]);
        std::swap(ofG[j], ofG[shared]);
        ++shared;
        break;
      }
    }
  }
  const auto pf = [&](int k) { return mesh.corner(f, ofF[k]); };
  const auto pg = [&](int k) { return mesh.corner(g, ofG[k]); };
  switch (shared) {
    case 0:
      return trianglesIntersect({pf(0), pf(1), pf(2)}, {pg(0), pg(1), pg(2)});
    case 1:
      return trianglesSharingVertexIntersect(pf(0), pf(1), pf(2), pg(1), pg(2));
    case 2:
      return trianglesSharingEdgeIntersect(pf(0), pf(1), pf(2), pg(2));
    default:
      return true;
  }
}

template <class Wanted>
std::vector<FacePair> intersectingPairs(const TriangleMesh& mesh, const Wanted& wanted) {
  const BoxTree tree(faceBoxes(mesh));
  constexpr std::size_t kGrain = 512;
  const std::size_t count = static_cast<std::size_t>(mesh.faceCount());
  std::vector<std::vector<FacePair>> found((count + kGrain - 1) / kGrain);
  parallelForBlocks(count, kGrain, [&](std::size_t begin, std::size_t end) {
    auto& mine = found[begin / kGrain];
    for (std::size_t f = begin; f < end; ++f) {
      const auto first = static_cast<std::int32_t>(f);
      tree.forOverlaps(tree.boxes()[f], [&](std::int32_t second) {
        if (second > first && wanted(first, second) && facesIntersect(mesh, first, second)) {
          mine.push_back({first, second});
        }
      });
    }
  });
  std::vector<FacePair> pairs;
  for (const auto& block : found) pairs.insert(pairs.end(), block.begin(), block.end());
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

}  // namespace

std::vector<FacePair> findSelfIntersections(const TriangleMesh& mesh) {
  return intersectingPairs(mesh, [](std::int32_t, std::int32_t) { return true; });
}

std::vector<FacePair> findSelfIntersections(const TriangleMesh& mesh,
                                            const std::vector<bool>& faceMarked) {
  return intersectingPairs(
      mesh, [&](std::int32_t f, std::int32_t g) { return faceMarked[f] || faceMarked[g]; });
}

}  // namespace explica::geometry
