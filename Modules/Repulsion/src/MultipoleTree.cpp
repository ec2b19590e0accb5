// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Repulsion/MultipoleTree.h"

#include "Assembly.h"
#include "ClusterTree.h"
#include "Explica/Core/Errors.h"
#include "Explica/Core/Parallel.h"
#include "FieldKernel.h"
#include "MovingSet.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <bit>
#include <span>
#include <string>
#include <vector>

namespace explica::repulsion {

struct MultipoleTree::State {
  MovingSet set;
  MultipoleTreeOptions options;
  ClusterTree fixed;

  State(const TriangleMesh& mesh, const std::vector<bool>& vertexMoves,
        const MultipoleTreeOptions& wanted)
      : set(mesh, vertexMoves),
        options(wanted),
        fixed(mesh.positions, mesh.faces, set.fixed, kGroupFaces) {}
};

namespace {

/// What acts on a group of faces.
struct Sources {
  /// Faces that are too near for their moments.
  struct Near {
    std::int32_t face;      ///< in its tree's order
    std::uint32_t targets;  ///< bit i: of the group's face i
  };
  std::vector<FieldCluster> clusters;
  std::vector<FieldPoint> points;
  std::vector<Near> near;
};

FieldCluster seenFrom(const Point& origin, const Cluster& cluster) {
  const Eigen::Vector3f centre = (cluster.centre - origin).cast<float>();
  const Eigen::Matrix3f m = cluster.second.cast<float>();
  return {{centre[0], centre[1], centre[2]},
          static_cast<float>(cluster.area),
          {m(0, 0), m(1, 1), m(2, 2), m(0, 1), m(0, 2), m(1, 2)}};
}

/// The targets to which a face is nearer than `nearRatio` sums of radii, one bit each.
std::uint32_t nearTargets(const Cluster& face, std::span<const Cluster> targets, double nearRatio) {
  std::uint32_t found = 0;
  for (std::size_t i = 0; i < targets.size(); ++i) {
    const double reach = nearRatio * (face.radius + targets[i].radius);
    const bool near = (face.centre - targets[i].centre).squaredNorm() < reach * reach;
    found |= static_cast<std::uint32_t>(near) << i;
  }
  return found;
}

/// What acts on a group: clusters whose second moments are enough for all of it, faces by three
/// points each where they are not.
Sources sourcesOf(const ClusterTree& tree, const Cluster& group, std::span<const Cluster> targets,
                  const MultipoleTreeOptions& options) {
  Sources sources;
  const double openings = 1 / options.opening;
  const auto isBeyond = [&](const Cluster& cluster, double gap) {
    const double reach = group.radius + gap;
    return (cluster.centre - group.centre).squaredNorm() > reach * reach;
  };
  const auto nearGap = [&](const Cluster& cluster) {
    return cluster.radius + (options.nearRatio - 1) * (cluster.largestFace + group.largestFace);
  };
  const auto isFar = [&](const Cluster& cluster) {
    return isBeyond(cluster, std::max(openings * cluster.radius, nearGap(cluster)));
  };
  std::vector<std::int32_t> waiting(tree.nodes.empty() ? 0 : 1, 0);
  while (!waiting.empty()) {
    const std::int32_t n = waiting.back();
    waiting.pop_back();
    const ClusterTree::Node& node = tree.nodes[n];
    if (isFar(tree.clusters[n])) {
      sources.clusters.push_back(seenFrom(group.centre, tree.clusters[n]));
      continue;
    }
    if (node.left >= 0) {
      waiting.push_back(node.left + 1);
      waiting.push_back(node.left);
      continue;
    }
    for (std::int32_t f = node.first; f < node.first + node.count; ++f) {
      if (isFar(tree.faces[f])) {
        sources.clusters.push_back(seenFrom(group.centre, tree.faces[f]));
        continue;
      }
      const std::uint32_t near = isBeyond(tree.faces[f], nearGap(tree.faces[f]))
                                     ? 0
                                     : nearTargets(tree.faces[f], targets, options.nearRatio);
      if (near != 0) sources.near.push_back({f, near});
      for (const Point& point : tree.points[f]) {
        const Eigen::Vector3f at = (point - group.centre).cast<float>();
        sources.points.push_back(
            {{at[0], at[1], at[2]}, static_cast<float>(tree.faces[f].area / 3), ~near});
      }
    }
  }
  return sources;
}

FieldPoints fieldPoints(std::span<const std::array<Point, 3>> faces, const Point& origin) {
  FieldPoints points{};
  for (int i = 0; i < kGroupFaces; ++i) {
    const auto& face = faces[std::min<std::size_t>(i, faces.size() - 1)];
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector3f x = (face[k] - origin).cast<float>();
      for (int a = 0; a < 3; ++a) points.at[a][k * kGroupFaces + i] = x[a];
    }
  }
  return points;
}

/// The force of the field at a face's three points.
/// @param shares  how often a pair counts in the value
void addFieldForce(const FieldPoints& points, int i, const Corners& corners, int shares,
                   FaceForce& force) {
  const AreaGradient area = areaGradient(corners);
  double mean = 0;
  std::array<Vector, 3> pull;
  for (int k = 0; k < 3; ++k) {
    const int n = k * kGroupFaces + i;
    const auto& g = points.gradient;
    mean += static_cast<double>(points.phi[n]) / 3;
    pull[k] = area.area / 3 * Vector(g[0][n], g[1][n], g[2][n]);
  }
  force.value += shares * area.area * mean;
  for (int k = 0; k < 3; ++k) {  // point k has the corners' weights 2/3, 1/6, 1/6
    const Vector moved = (pull[0] + pull[1] + pull[2]) / 6 + pull[k] / 2;
    force.byCorner[k] += 2 * (mean * area.byCorner[k] + moved);
  }
}

}  // namespace

MultipoleTree::MultipoleTree(const TriangleMesh& mesh, const std::vector<bool>& vertexMoves,
                             const MultipoleTreeOptions& options) {
  if (!(options.opening > 0 && options.opening < 1)) {
    throw InvalidInput("knot energy: opening is " + std::to_string(options.opening) +
                       "; it must lie between 0 and 1");
  }
  if (!(options.nearRatio >= 1)) {
    throw InvalidInput("knot energy: near ratio is " + std::to_string(options.nearRatio) +
                       "; it must be at least 1");
  }
  state_ = std::make_unique<State>(mesh, vertexMoves, options);
}

MultipoleTree::~MultipoleTree() = default;

const char* MultipoleTree::instructionSet() {
  return fieldInstructionSet();
}

KnotValue MultipoleTree::evaluate(const Positions& positions) const {
  const auto& [set, options, fixed] = *state_;
  set.requireVertexCount(positions);
  const ClusterTree moving(positions, set.faces, set.moving, kGroupFaces);
  std::vector<FaceForce> forces(set.moving.size());
  using FacePairs = std::vector<std::array<std::int32_t, 2>>;
  std::vector<FacePairs> nearPairs(moving.groups.size());

  parallelFor(moving.groups.size(), 4, [&](std::size_t g) {
    const ClusterTree::Node& node = moving.nodes[moving.groups[g]];
    const Cluster& group = moving.clusters[moving.groups[g]];
    const auto slots = std::span(moving.order).subspan(node.first, node.count);
    const FieldPoints empty =
        fieldPoints(std::span(moving.points).subspan(node.first, node.count), group.centre);
    for (const ClusterTree* tree : {&moving, &fixed}) {
      const Sources sources = sourcesOf(*tree, group, moving.facesOf(node), options);
      FieldPoints points = empty;
      addField(points, sources.clusters, sources.points);
      for (int i = 0; i < node.count; ++i) {
        const Corners corners = cornersOf(positions, set.faces, set.moving[slots[i]]);
        addFieldForce(points, i, corners, tree == &moving ? 1 : 2, forces[slots[i]]);
      }
      for (const auto& [place, targets] : sources.near) {
        const std::int32_t source = (tree == &moving ? set.moving : set.fixed)[tree->order[place]];
        for (std::uint32_t left = targets; left != 0; left &= left - 1) {
          const std::int32_t k = slots[std::countr_zero(left)];
          const bool isFirst = tree == &fixed || set.moving[k] < source;  // each pair once
          if (isFirst && !std::ranges::binary_search(set.touching(k), source)) {
            nearPairs[g].push_back({set.moving[k], source});
          }
        }
      }
    }
  });
  FacePairs apart;
  for (const FacePairs& pairs : nearPairs) apart.insert(apart.end(), pairs.begin(), pairs.end());
  return assemble(set, positions, forces, PairAccuracy::Coarse, apart);
}

}  // namespace explica::repulsion
