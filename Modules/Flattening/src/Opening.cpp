// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Flattening/Opening.h"

#include "Explica/Core/Errors.h"
#include "Explica/Core/IndicesWhere.h"
#include "Explica/Geometry/FacePieces.h"
#include "Explica/Geometry/MeshMeasures.h"
#include "Explica/Geometry/MeshTopology.h"

#include <algorithm>
#include <string>
#include <unordered_set>

namespace explica::flattening {
namespace {

/// True for the faces of the part that has the largest area; none if there is no part.
std::vector<bool> largestPart(const geometry::MeshTopology& topology, const TriangleMesh& mesh,
                              const std::vector<bool>& chosen) {
  const auto part = geometry::facePieces(topology, chosen);
  const std::vector<double> areas = geometry::pieceAreas(mesh, part);
  const auto best = std::ranges::max_element(areas) - areas.begin();
  std::vector<bool> largest(part.size(), false);
  for (std::size_t f = 0; f < part.size(); ++f) largest[f] = part[f] == best;
  return largest;
}

/// Edges as one number each, whichever end comes first.
class EdgeSet {
 public:
  void add(std::int32_t a, std::int32_t b) { keys_.insert(keyOf(a, b)); }
  [[nodiscard]] bool has(std::int32_t a, std::int32_t b) const {
    return keys_.contains(keyOf(a, b));
  }

 private:
  static std::uint64_t keyOf(std::int32_t a, std::int32_t b) {
    return static_cast<std::uint64_t>(std::min(a, b)) << 32 |
           static_cast<std::uint64_t>(std::max(a, b));
  }
  std::unordered_set<std::uint64_t> keys_;
};

EdgeSet edgesOf(const geometry::MeshTopology& topology, std::span<const CutPath> cuts) {
  EdgeSet cut;
  for (const CutPath& path : cuts) {
    for (std::size_t n = 1; n < path.size(); ++n) {
      const auto near = topology.vertexVertices[path[n]];
      if (!std::ranges::binary_search(near, path[n - 1])) {
        throw InvalidInput("cuts: vertices " + std::to_string(path[n - 1]) + " and " +
                           std::to_string(path[n]) + " are no neighbours");
      }
      cut.add(path[n - 1], path[n]);
    }
  }
  return cut;
}

}  // namespace

std::vector<std::int32_t> facesWithoutWall(const TriangleMesh& mesh,
                                           const std::vector<bool>& inCortex) {
  const auto topology = geometry::buildTopology(mesh.faces, mesh.vertexCount());
  std::vector<bool> outside(static_cast<std::size_t>(mesh.faceCount()), false);
  for (Eigen::Index f = 0; f < mesh.faceCount(); ++f) {
    for (int k = 0; k < 3; ++k) {
      if (!inCortex[mesh.faces(f, k)]) outside[f] = true;
    }
  }
  const auto wall = largestPart(topology, mesh, outside);
  std::vector<bool> rest(wall.size());
  for (std::size_t f = 0; f < wall.size(); ++f) rest[f] = !wall[f];
  const auto cortex = largestPart(topology, mesh, rest);
  const auto kept = indicesWhere(cortex.size(), [&](std::size_t f) { return cortex[f]; });
  if (kept.empty()) throw InvalidInput("cortex: it has no face");
  if (kept.size() == cortex.size()) {
    throw InvalidInput("cortex: it is the whole surface, so that there is no medial wall");
  }
  return kept;
}

std::vector<std::int32_t> openFaces(Faces& faces, Eigen::Index vertexCount,
                                    std::span<const CutPath> cuts) {
  const auto topology = geometry::buildTopology(faces, vertexCount);
  const EdgeSet cut = edgesOf(topology, cuts);
  std::vector<std::int32_t> touched, copyOf;
  for (const CutPath& path : cuts) touched.insert(touched.end(), path.begin(), path.end());
  std::ranges::sort(touched);
  touched.erase(std::unique(touched.begin(), touched.end()), touched.end());
  const Faces before = faces;
  for (const std::int32_t v : touched) {
    const auto sides = geometry::fansAt(before, v, topology.vertexFaces[v],
                                        [&](std::int32_t other) { return cut.has(v, other); });
    for (std::size_t n = 1; n < sides.size(); ++n) {
      const auto copy =
          static_cast<std::int32_t>(vertexCount) + static_cast<std::int32_t>(copyOf.size());
      copyOf.push_back(v);
      for (const std::int32_t f : sides[n]) {
        for (int k = 0; k < 3; ++k) {
          if (before(f, k) == v) faces(f, k) = copy;
        }
      }
    }
  }
  return copyOf;
}

Disc openedAlong(const Disc& disc, std::span<const CutPath> cuts) {
  Disc opened;
  opened.faceOrigin = disc.faceOrigin;
  opened.vertexOrigin = disc.vertexOrigin;
  opened.mesh = disc.mesh;
  opened.trimmedFaces = disc.trimmedFaces;
  const Eigen::Index before = disc.mesh.vertexCount();
  const auto copyOf = openFaces(opened.mesh.faces, before, cuts);
  opened.mesh.positions.conservativeResize(before + static_cast<Eigen::Index>(copyOf.size()), 3);
  for (std::size_t n = 0; n < copyOf.size(); ++n) {
    opened.vertexOrigin.push_back(disc.vertexOrigin[copyOf[n]]);
    opened.mesh.positions.row(before + static_cast<Eigen::Index>(n)) =
        disc.mesh.positions.row(copyOf[n]);
  }
  findLoops(opened);
  return opened;
}

std::vector<bool> secondCopies(const Disc& disc) {
  std::unordered_set<std::int32_t> known;
  std::vector<bool> second;
  for (const std::int32_t v : disc.vertexOrigin) second.push_back(!known.insert(v).second);
  return second;
}

}  // namespace explica::flattening
