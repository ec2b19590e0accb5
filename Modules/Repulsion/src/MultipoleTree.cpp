// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Repulsion/MultipoleTree.h"

#include "Assembly.h"
#include "ClusterTree.h"
#include "MovingSet.h"
#include "Quadrature.h"

#include "Explica/Core/Errors.h"
#include "Explica/Core/Parallel.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace explica::repulsion {
namespace {

/// What clusters do at a point: phi, the integral of 1/|x - y|^2 dS(y), and its gradient.
struct Field {
  double phi = 0;
  Vector gradient = Vector::Zero();
};

/// With r from the centre to the point, s = 1/r^2, m the area, Q its second moments, q = r . Q r:
///   phi = s (m + s (4 q s - tr Q)),
///   grad phi = s^2 ((-2 m + s (4 tr Q - 24 q s)) r + 8 s Q r).
Field fieldOf(const Cluster& cluster, const Point& x) {
  const Vector r = x - cluster.centre;
  const double s = 1 / r.squaredNorm(), trace = cluster.second.trace();
  const Vector turned = cluster.second * r;
  const double qs = turned.dot(r) * s;
  return {s * (cluster.area + s * (4 * qs - trace)),
          s * s * ((-2 * cluster.area + s * (4 * trace - 24 * qs)) * r + 8 * s * turned)};
}

/// A moving face and what acts on it.
class Target {
 public:
  Target(const MovingSet& set, const Positions& positions, std::size_t k)
      : set_(set),
        positions_(positions),
        touching_(set.touching(k)),
        corners_(cornersOf(positions, set.faces, set.moving[k])),
        area_(areaGradient(corners_)),
        centre_((corners_[0] + corners_[1] + corners_[2]) / 3) {
    for (const Point& c : corners_) radius_ = std::max(radius_, (c - centre_).norm());
    int q = 0;
    for (const RulePoint& p : triangleRule3()) {
      points_[q++] =
          p.lambda[0] * corners_[0] + p.lambda[1] * corners_[1] + p.lambda[2] * corners_[2];
    }
  }

  /// @param weight  of the value: 2 for faces that do not move, since both orders of a pair count
  void add(const ClusterTree& tree, double opening, double weight) {
    std::array<Field, 3> fields;
    tree.visit(
        centre_, radius_, opening,
        [&](const Cluster& cluster) {
          for (int q = 0; q < 3; ++q) {
            const Field field = fieldOf(cluster, points_[q]);
            fields[q].phi += field.phi;
            fields[q].gradient += field.gradient;
          }
        },
        [&](std::int32_t face) { addNear(face, weight); });
    int q = 0;
    for (const RulePoint& p : triangleRule3()) {
      const Field& field = fields[q++];
      force_.value += weight * p.weight * area_.area * field.phi;
      for (int k = 0; k < 3; ++k) {
        force_.byCorner[k] +=
            2 * p.weight *
            (area_.area * p.lambda[k] * field.gradient + field.phi * area_.byCorner[k]);
      }
    }
  }

  [[nodiscard]] const FaceForce& force() const { return force_; }

 private:
  void addNear(std::int32_t face, double weight) {
    if (std::binary_search(touching_.begin(), touching_.end(), face)) return;
    const PairIntegral pair =
        integrateApart(corners_, cornersOf(positions_, set_.faces, face), PairAccuracy::Coarse);
    force_.value += weight * pair.value;
    for (int k = 0; k < 3; ++k) force_.byCorner[k] += 2 * pair.byS[k];
  }

  const MovingSet& set_;
  const Positions& positions_;
  std::span<const std::int32_t> touching_;
  Corners corners_;
  AreaGradient area_;
  Point centre_;
  double radius_ = 0;
  std::array<Point, 3> points_;
  FaceForce force_;
};

}  // namespace

struct MultipoleTree::State {
  MovingSet set;
  double opening;
  ClusterTree fixed;
};

MultipoleTree::MultipoleTree(const TriangleMesh& mesh, const std::vector<bool>& vertexMoves,
                             double opening) {
  if (!(opening > 0 && opening < 1)) {
    throw InvalidInput("knot energy: opening is " + std::to_string(opening) +
                       "; it must lie between 0 and 1");
  }
  MovingSet set(mesh, vertexMoves);
  ClusterTree fixed(mesh.positions, mesh.faces, set.fixed);
  state_ = std::make_unique<State>(State{std::move(set), opening, std::move(fixed)});
}

MultipoleTree::~MultipoleTree() = default;

KnotValue MultipoleTree::evaluate(const Positions& positions) const {
  const MovingSet& set = state_->set;
  set.requireVertexCount(positions);
  const ClusterTree moving(positions, set.faces, set.moving);
  std::vector<FaceForce> forces(set.moving.size());
  constexpr std::size_t kGrain = 16;  // faces a task
  parallelFor(forces.size(), kGrain, [&](std::size_t k) {
    Target target(set, positions, k);
    target.add(moving, state_->opening, 1);
    target.add(state_->fixed, state_->opening, 2);
    forces[k] = target.force();
  });
  return assemble(set, positions, forces, adjacentPairs(set, positions, PairAccuracy::Coarse));
}

}  // namespace explica::repulsion
