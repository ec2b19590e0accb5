// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Collision/ContinuousCollision.h"
#include "Explica/Core/TriangleMesh.h"

#include <memory>
#include <span>
#include <vector>

namespace explica::collision {

/// A vertex and a face, or two edges (smaller first), of a CollisionScene.
struct Pair {
  PairKind kind = PairKind::VertexFace;
  std::int32_t first = -1;
  std::int32_t second = -1;
  friend auto operator<=>(const Pair&, const Pair&) = default;  // NOLINT(modernize-use-nullptr)
};

/// A pair that may meet while it moves, and how near it is to that.
struct Meeting {
  Pair pair;
  double separation = 0;  ///< mm: at the start they are not nearer; NaN if they touch
  /// mm: at any time t in [0, 1] they are not nearer than separation - max(0, t * closing).
  double closing = 0;
};

/// Their pairs, in their order.
[[nodiscard]] std::vector<Pair> pairsOf(std::span<const Meeting> meetings);

/// A surface of which some vertices move, and who can meet whom in it.
///
/// Every vertex-face and edge-edge pair with at least one moving vertex counts, except those that
/// share a vertex; so the ring of faces that joins moving vertices to fixed surroundings is in it.
class CollisionScene {
 public:
  /// @param vertexMoves  V flags; edges and faces with a moving vertex move
  CollisionScene(const TriangleMesh& mesh, const std::vector<bool>& vertexMoves);

  /// All pairs that come within `reach` mm of each other at some time in [0, 1] while every vertex
  /// goes straight from `start` to `start + motion`; a superset by little.  Sorted; threaded. Which
  /// pairs are in it depends on the arguments alone.  Fixed vertices must stand where they
  /// stood at construction.
  [[nodiscard]] std::vector<Meeting> findMeetings(const Positions& start, const Positions& motion,
                                                  double reach) const;

  /// findMeetings() where it is known for another motion.
  /// @param known    of the same start and reach, for a motion that differs at `changed` alone
  /// @param changed  vertices that move, none twice
  [[nodiscard]] std::vector<Meeting> updateMeetings(std::span<const Meeting> known,
                                                    const Positions& start, const Positions& motion,
                                                    double reach,
                                                    std::span<const std::int32_t> changed) const;

  /// The pairs of findMeetings().
  [[nodiscard]] std::vector<Pair> findPairs(const Positions& start, const Positions& motion,
                                            double reach) const;

  /// The four vertices of a pair: vertex and face corners, or ends of both edges.
  [[nodiscard]] std::array<std::int32_t, 4> vertices(const Pair& pair) const;
  [[nodiscard]] FourPoints points(const Pair& pair, const Positions& positions) const;

  [[nodiscard]] const Edges& edges() const { return edges_; }
  [[nodiscard]] const Faces& faces() const { return faces_; }
  [[nodiscard]] const std::vector<std::int32_t>& movingVertices() const { return movingVertices_; }
  [[nodiscard]] const std::vector<std::int32_t>& movingFaces() const { return movingFaces_; }

 private:
  struct Features;
  struct Surroundings;
  struct Query;
  /// @param items  vertices, edges, faces
  [[nodiscard]] std::array<Features, 3> featuresOf(std::array<std::vector<std::int32_t>, 3> items,
                                                   const Positions& start,
                                                   const Positions& motion) const;
  [[nodiscard]] std::vector<Meeting> answer(std::span<const Query> queries, const Positions& start,
                                            const Positions& motion, double reach) const;
  Faces faces_;
  Edges edges_;  ///< those of any face, in lexicographic order
  std::vector<std::int32_t> movingVertices_, movingEdges_, movingFaces_;
  Point origin_ = Point::Zero();               ///< of single-precision bounds
  std::shared_ptr<const Surroundings> fixed_;  ///< what does not move, with its search trees
};

/// Largest step t in [0, limit] that brings no pair to contact; see safeTime().  Threaded.
/// @param meetings  of the same start and motion: what they know is saved
[[nodiscard]] double largestSafeStep(const CollisionScene& scene, std::span<const Meeting> meetings,
                                     const Positions& start, const Positions& motion,
                                     double limit = 1, const AdvanceOptions& options = {});

}  // namespace explica::collision
