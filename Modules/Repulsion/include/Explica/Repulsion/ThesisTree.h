// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Repulsion/KnotEnergy.h"

#include <vector>

namespace explica::repulsion {

class MovingSet;

/// Tree over faces that grows by merging neighbours, [Thesis, section 5.4].
struct MergingTree {
  struct Node {
    Point centroid = Point::Zero();      ///< of the area below, mm
    double area = 0;                     ///< below, mm^2
    std::int32_t parent = -1;            ///< -1 for the root
    std::vector<std::int32_t> children;  ///< none for a face
  };
  std::vector<Node> nodes;  ///< faces first, in their order; children before parents; root last
};

/// The merging algorithm of [Thesis, section 5.4], step by step: rounds that first merge the two
/// closest unmerged neighbours until none are left, then give each left-over node to the parent of
/// its closest neighbour.  Ties go to the lower numbers.
///
/// Departure: parts of a surface that are no neighbours never merge in the thesis; here they become
/// the children of one more node, the root.
/// @param neighbours  of each face: those with a common vertex
[[nodiscard]] MergingTree buildMergingTree(
    const std::vector<Point>& centroids, const std::vector<double>& areas,
    const std::vector<std::vector<std::int32_t>>& neighbours);

struct ThesisTreeOptions {
  /// Faces whose centroids are nearer than this many mean edges are integrated by [Thesis,
  /// Eq. 5.43].
  double nearDistance = 3;
  /// A node's children are good enough once they agree with the node to this relative error,
  /// averaged over the face's corners.
  double relativeError = 0.01;
};

/// Knot energy by the merging tree and recursion, [Thesis, section 5.4]: the baseline.
///
/// Far nodes act by their centroid and area, [Thesis, Eq. 5.45 with erratum 2 mended].  The tree is
/// merged once, at construction; its centroids and areas follow the positions.
class ThesisTree : public KnotEnergy {
 public:
  /// @throws InvalidInput  as makeKnotEnergy; an option out of range
  ThesisTree(const TriangleMesh& mesh, const std::vector<bool>& vertexMoves,
             const ThesisTreeOptions& options = {});
  ~ThesisTree() override;

  [[nodiscard]] KnotValue evaluate(const Positions& positions) const override;

 private:
  std::unique_ptr<const MovingSet> set_;
  MergingTree tree_;
  ThesisTreeOptions options_;
  double nearDistance_ = 0;  // mm
};

}  // namespace explica::repulsion
