// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Geometry/SelfIntersection.h"

#include "Explica/Core/Parallel.h"
#include "Explica/Geometry/BoundsSearch.h"
#include "Explica/Geometry/FaceTree.h"
#include "Explica/Geometry/TriangleIntersection.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <iterator>

namespace explica::geometry {
namespace {

/// True if the points lie clearly, beyond rounding, on one side of the triangle's plane.
template <std::size_t N>
bool clearlyBeside(const Point& a, const Point& b, const Point& c,
                   const std::array<Point, N>& points) {
  const Vector ab = b - a, ac = c - a;
  const Vector normal = ab.cross(ac);
  const double size = kBesideRounding * ab.lpNorm<1>() * ac.lpNorm<1>();
  int above = 0, below = 0;
  for (const Point& p : points) {
    const Vector way = p - a;
    const double height = normal.dot(way), least = size * way.lpNorm<1>();
    above += height > least;
    below += height < -least;
  }
  return above == static_cast<int>(N) || below == static_cast<int>(N);
}

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
  // Most pairs are clearly apart but for what they share; the rest is decided exactly.
  const std::array<Point, 3> pf = {mesh.corner(f, ofF[0]), mesh.corner(f, ofF[1]),
                                   mesh.corner(f, ofF[2])};
  const std::array<Point, 3> pg = {mesh.corner(g, ofG[0]), mesh.corner(g, ofG[1]),
                                   mesh.corner(g, ofG[2])};
  using Two = std::array<Point, 2>;
  switch (shared) {
    case 0:
      return !clearlyBeside(pf[0], pf[1], pf[2], pg) && !clearlyBeside(pg[0], pg[1], pg[2], pf) &&
             trianglesIntersect(pf, pg);
    case 1:
      return !clearlyBeside(pf[0], pf[1], pf[2], Two{pg[1], pg[2]}) &&
             !clearlyBeside(pg[0], pg[1], pg[2], Two{pf[1], pf[2]}) &&
             trianglesSharingVertexIntersect(pf[0], pf[1], pf[2], pg[1], pg[2]);
    case 2:
      return trianglesSharingEdgeIntersect(pf[0], pf[1], pf[2], pg[2]);
    default:
      return true;
  }
}

/// Bounds that hold a face's corners, about an origin in the middle of the mesh.
std::vector<MotionBounds> boundsOfFaces(const TriangleMesh& mesh,
                                        const std::vector<std::int32_t>& faces,
                                        const Point& origin) {
  std::vector<MotionBounds> bounds(faces.size());
  parallelFor(faces.size(), [&](std::size_t n) {
    const auto corner = [&](int k) {
      return MotionBounds::ofPoint(mesh.corner(faces[n], k) - origin, Vector::Zero());
    };
    bounds[n] = corner(0);
    bounds[n].extend(corner(1));
    bounds[n].extend(corner(2));
  });
  return bounds;
}

/// Appends the wanted pairs of faces of two lists, or of one with itself, that intersect.
template <class Wanted>
void intersect(const TriangleMesh& mesh, const BoundsSearch& search,
               const std::vector<std::int32_t>& first, const std::vector<std::int32_t>& second,
               std::vector<FacePair>& pairs, const Wanted& wanted) {
  const std::vector<BlockPair> blocks = blocksToShareOut(search);
  std::vector<std::vector<FacePair>> found(blocks.size());
  parallelFor(blocks.size(), 4, [&](std::size_t n) {
    visitItems(search, blocks[n], [&](std::int32_t i, std::int32_t j) {
      if (!wanted(first[i], second[j])) return;
      const std::int32_t f = std::min(first[i], second[j]), g = std::max(first[i], second[j]);
      if (facesIntersect(mesh, f, g)) found[n].push_back({f, g});
    });
  });
  for (const auto& part : found) pairs.insert(pairs.end(), part.begin(), part.end());
}

bool any(std::int32_t /*f*/, std::int32_t /*g*/) {
  return true;
}

/// Pairs among the marked faces, and of these with the others.
std::vector<FacePair> intersectingPairs(const TriangleMesh& mesh,
                                        const std::vector<std::int32_t>& marked,
                                        const std::vector<std::int32_t>& others) {
  if (marked.empty()) return {};
  const Point origin = mesh.corner(marked[0], 0);
  const BoundsPyramid own(boundsOfFaces(mesh, marked, origin));
  const BoundsPyramid rest(boundsOfFaces(mesh, others, origin));
  std::vector<FacePair> pairs;
  intersect(mesh, {&own, &own, 0}, marked, marked, pairs, any);
  intersect(mesh, {&own, &rest, 0}, marked, others, pairs, any);
  std::ranges::sort(pairs);
  return pairs;
}

}  // namespace

std::vector<FacePair> findSelfIntersections(const TriangleMesh& mesh) {
  return intersectingPairs(mesh, mesh.allFaces(), {});
}

std::vector<FacePair> findSelfIntersections(const TriangleMesh& mesh,
                                            const std::vector<bool>& faceMarked) {
  const auto boxOf = [&](std::int32_t f) {
    Box box(Point(mesh.corner(f, 0)));
    return box.extend(Point(mesh.corner(f, 1))).extend(Point(mesh.corner(f, 2)));
  };
  std::vector<std::int32_t> marked, others;
  Box reach;
  for (std::int32_t f = 0; f < mesh.faceCount(); ++f) {
    if (!faceMarked[f]) continue;
    marked.push_back(f);
    reach.extend(boxOf(f));
  }
  for (std::int32_t f = 0; f < mesh.faceCount(); ++f) {
    if (!faceMarked[f] && reach.intersects(boxOf(f))) others.push_back(f);
  }
  return intersectingPairs(mesh, marked, others);
}

std::vector<FacePair> findSelfIntersections(const TriangleMesh& mesh,
                                            const std::vector<bool>& faceMoved,
                                            std::span<const FacePair> before) {
  std::vector<FacePair> pairs = findSelfIntersections(mesh, faceMoved);
  std::ranges::copy_if(before, std::back_inserter(pairs), [&](const FacePair& pair) {
    return !faceMoved[pair[0]] && !faceMoved[pair[1]];
  });
  std::ranges::sort(pairs);
  return pairs;
}

void SelfIntersectionSearch::sortFaces(const TriangleMesh& mesh) {
  faces_ = mesh.allFaces();
  origin_ = mesh.corner(0, 0);
  sorted_ = BoundsPyramid(boundsOfFaces(mesh, faces_, origin_));
  astray_.clear();
  isAstray_.assign(faces_.size(), 0);
  isMoved_.resize(faces_.size(), 0);
}

std::vector<FacePair> SelfIntersectionSearch::find(const TriangleMesh& mesh,
                                                   const std::vector<std::int32_t>& moved) {
  if (moved.empty()) return {};
  constexpr double kMany = 0.25;  // share of faces beyond which all are looked through
  const auto many = static_cast<std::size_t>(kMany * static_cast<double>(mesh.faceCount()));
  if (faces_.empty() || astray_.size() + moved.size() > many) {
    sortFaces(mesh);
  }
  for (const std::int32_t f : moved) isMoved_[f] = 1;
  std::vector<FacePair> pairs;
  if (moved.size() > many) {
    intersect(mesh, {&sorted_, &sorted_, 0}, faces_, faces_, pairs,
              [&](std::int32_t f, std::int32_t g) { return (isMoved_[f] | isMoved_[g]) != 0; });
  } else {
    std::erase_if(astray_, [&](std::int32_t f) { return isMoved_[f] != 0; });
    const BoundsPyramid own(boundsOfFaces(mesh, moved, origin_));
    const BoundsPyramid astray(boundsOfFaces(mesh, astray_, origin_));
    intersect(mesh, {&own, &own, 0}, moved, moved, pairs, any);
    intersect(mesh, {&own, &astray, 0}, moved, astray_, pairs, any);
    intersect(mesh, {&own, &sorted_, 0}, moved, faces_, pairs,
              [&](std::int32_t, std::int32_t g) { return (isMoved_[g] | isAstray_[g]) == 0; });
    astray_.insert(astray_.end(), moved.begin(), moved.end());
    for (const std::int32_t f : moved) isAstray_[f] = 1;
  }
  for (const std::int32_t f : moved) isMoved_[f] = 0;
  std::ranges::sort(pairs);
  return pairs;
}

}  // namespace explica::geometry
