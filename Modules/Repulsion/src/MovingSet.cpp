// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "MovingSet.h"

#include "Explica/Core/Errors.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <string>

namespace explica::repulsion {
namespace {

bool contains(const std::array<std::int32_t, 3>& corners, std::int32_t v) {
  return corners[0] == v || corners[1] == v || corners[2] == v;
}

void requireValid(const TriangleMesh& mesh, const std::vector<bool>& vertexMoves) {
  if (static_cast<Eigen::Index>(vertexMoves.size()) != mesh.vertexCount()) {
    throw InvalidInput("knot energy: " + std::to_string(vertexMoves.size()) +
                       " flags of moving vertices for a surface of " +
                       std::to_string(mesh.vertexCount()) + " vertices");
  }
  for (Eigen::Index f = 0; f < mesh.faceCount(); ++f) {
    for (int k = 0; k < 3; ++k) {
      const std::int32_t v = mesh.faces(f, k);
      if (v < 0 || v >= mesh.vertexCount()) {
        throw InvalidInput("knot energy: face " + std::to_string(f) + " names vertex " +
                           std::to_string(v) + " of " + std::to_string(mesh.vertexCount()));
      }
      if (v == mesh.faces(f, (k + 1) % 3)) {
        throw InvalidInput("knot energy: face " + std::to_string(f) + " names vertex " +
                           std::to_string(v) + " twice");
      }
    }
  }
}

}  // namespace

MovingSet::MovingSet(const TriangleMesh& mesh, const std::vector<bool>& moves)
    : faces(mesh.faces), vertexMoves(moves) {
  requireValid(mesh, vertexMoves);
  const auto faceCount = static_cast<std::int32_t>(faces.rows());
  const auto vertexCount = static_cast<std::size_t>(mesh.vertexCount());

  std::vector<std::int32_t> begin(vertexCount + 1, 0);
  for (Eigen::Index i = 0; i < faces.size(); ++i) ++begin[faces.data()[i] + 1];
  for (std::size_t v = 0; v < vertexCount; ++v) begin[v + 1] += begin[v];
  std::vector<std::int32_t> around(static_cast<std::size_t>(faces.size()));
  std::vector<std::int32_t> next(begin.begin(), begin.end() - 1);
  for (std::int32_t f = 0; f < faceCount; ++f) {
    for (int k = 0; k < 3; ++k) around[next[faces(f, k)]++] = f;
  }

  faceMoves.resize(faceCount);
  for (std::int32_t f = 0; f < faceCount; ++f) {
    faceMoves[f] = vertexMoves[faces(f, 0)] || vertexMoves[faces(f, 1)] || vertexMoves[faces(f, 2)];
    (faceMoves[f] ? moving : fixed).push_back(f);
  }

  touchingBegin_.push_back(0);
  std::vector<std::int32_t> found;
  for (const std::int32_t s : moving) {
    found.clear();
    for (int k = 0; k < 3; ++k) {
      const std::int32_t v = faces(s, k);
      found.insert(found.end(), around.begin() + begin[v], around.begin() + begin[v + 1]);
    }
    std::ranges::sort(found);
    found.erase(std::unique(found.begin(), found.end()), found.end());
    touching_.insert(touching_.end(), found.begin(), found.end());
    touchingBegin_.push_back(touching_.size());

    for (const std::int32_t t : found) {
      if (t == s || (faceMoves[t] && t < s)) continue;
      AdjacentPair pair{s, t, verticesOf(faces, s), verticesOf(faces, t)};
      const auto cornersS = pair.cornersS;
      const auto cornersT = pair.cornersT;
      const auto commonFirst = [](std::array<std::int32_t, 3>& row,
                                  const std::array<std::int32_t, 3>& other) {
        std::stable_partition(row.begin(), row.end(),
                              [&](std::int32_t v) { return contains(other, v); });
      };
      commonFirst(pair.cornersS, cornersT);
      commonFirst(pair.cornersT, cornersS);
      const auto common =
          std::ranges::count_if(cornersS, [&](std::int32_t v) { return contains(cornersT, v); });
      if (common == 3) {
        throw InvalidInput("knot energy: faces " + std::to_string(s) + " and " + std::to_string(t) +
                           " lie on the same three vertices; their energy is infinite; remove one");
      }
      if (common == 2) {
        if (pair.cornersT[0] != pair.cornersS[0]) std::swap(pair.cornersT[0], pair.cornersT[1]);
        edgePairs.push_back(pair);
      } else {
        vertexPairs.push_back(pair);
      }
    }
  }
}

void MovingSet::requireVertexCount(const Positions& positions) const {
  if (positions.rows() != static_cast<Eigen::Index>(vertexMoves.size())) {
    throw InvalidInput("knot energy: " + std::to_string(positions.rows()) +
                       " positions for a surface of " + std::to_string(vertexMoves.size()) +
                       " vertices");
  }
}

FaceArea faceArea(const Corners& c) {
  const Vector cross = (c[1] - c[0]).cross(c[2] - c[0]);
  const double length = cross.norm();
  FaceArea result;
  result.area = length / 2;
  if (length > 0) result.normal = cross / length;
  return result;
}

AreaGradient areaGradient(const Corners& c) {
  const FaceArea face = faceArea(c);
  AreaGradient result;
  result.area = face.area;
  for (int k = 0; k < 3; ++k) result.byCorner[k] = areaByCorner(face.normal, c, k);
  return result;
}

}  // namespace explica::repulsion
