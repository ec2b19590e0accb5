// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Arrays.h"
#include "Bindings.h"
#include "Watch.h"

#include "Explica/Collision/Barrier.h"
#include "Explica/Collision/CollisionScene.h"
#include "Explica/Core/Errors.h"

namespace explica::python {
namespace {

using namespace py::literals;
using PositionsIn = Eigen::Ref<const Positions>;
using FacesIn = Eigen::Ref<const Faces>;
using collision::CollisionScene;
using collision::PairKind;

CollisionScene sceneOf(const TriangleMesh& mesh, const std::optional<std::vector<bool>>& moves) {
  const auto count = static_cast<std::size_t>(mesh.vertexCount());
  if (moves && moves->size() != count) {
    throw InvalidInput("moves: has " + std::to_string(moves->size()) + " flags for " +
                       std::to_string(count) + " vertices");
  }
  return {mesh, moves ? *moves : std::vector<bool>(count, true)};
}

/// Motion with zero rows where vertices do not move.
Positions motionOf(const TriangleMesh& mesh, const PositionsIn& motion,
                   const CollisionScene& scene) {
  if (motion.rows() != mesh.vertexCount() || !motion.allFinite()) {
    throw InvalidInput("motion: a finite array of " + std::to_string(mesh.vertexCount()) +
                       " rows, one a vertex, is needed");
  }
  Positions moving = Positions::Zero(mesh.vertexCount(), 3);
  for (const std::int32_t v : scene.movingVertices()) moving.row(v) = motion.row(v);
  return moving;
}

}  // namespace

void bindCollision(py::module_& m) {
  m.def(
      "largest_safe_step",
      [](const PositionsIn& positions, const FacesIn& faces, const PositionsIn& motion,
         const std::optional<std::vector<bool>>& moves) {
        const TriangleMesh mesh = meshOf(positions, faces);
        return unlocked([&] {
          const CollisionScene scene = sceneOf(mesh, moves);
          const Positions way = motionOf(mesh, motion, scene);
          const auto pairs = scene.findPairs(mesh.positions, way, 0);
          return collision::largestSafeStep(scene, pairs, mesh.positions, way);
        });
      },
      "positions"_a, "faces"_a, "motion"_a, "moves"_a = py::none(),
      "Largest share t in [0, 1] of a motion (V, 3), mm, that brings no two features of the "
      "surface\n"
      "to contact while every vertex goes straight: conservative, never beyond the true contact.\n"
      "`moves` (V,) marks the vertices that move (default: all); rows of others count as zero.");
  m.def(
      "near_pairs",
      [](const PositionsIn& positions, const FacesIn& faces, double reach,
         const std::optional<std::vector<bool>>& moves) {
        const TriangleMesh mesh = meshOf(positions, faces);
        std::vector<std::array<std::int32_t, 2>> vertexFace;
        std::vector<std::array<std::int32_t, 4>> edgeEdge;
        unlocked([&] {
          const CollisionScene scene = sceneOf(mesh, moves);
          const Positions still = Positions::Zero(mesh.vertexCount(), 3);
          for (const auto& pair : scene.findPairs(mesh.positions, still, reach)) {
            if (collision::squaredDistance(pair.kind, scene.points(pair, mesh.positions)) >
                reach * reach) {
              continue;
            }
            if (pair.kind == PairKind::VertexFace) {
              vertexFace.push_back({pair.first, pair.second});
            } else {
              edgeEdge.push_back(scene.vertices(pair));
            }
          }
        });
        return std::make_pair(rowsOf(vertexFace), rowsOf(edgeEdge));
      },
      "positions"_a, "faces"_a, "reach"_a, "moves"_a = py::none(),
      "Features of the surface that lie within `reach` mm of each other and share no vertex:\n"
      "(vertex, face) pairs (N, 2), and edge pairs as their four vertices (M, 4).");
  m.def(
      "contact_barrier",
      [](double distance, double range) {
        if (!(distance > 0) || !(range > 0)) {
          throw InvalidInput("distance and range: must be positive");
        }
        const auto b = collision::evaluateBarrier(distance, range);
        return std::make_tuple(b.value, b.slope, b.curvature);
      },
      "distance"_a, "range"_a,
      "Barrier -(d/r - 1)^2 ln(d/r) of a contact at distance d below range r, mm, with its first "
      "and\nsecond derivative by the distance: zero from the range on, infinite at contact.");
}

}  // namespace explica::python
