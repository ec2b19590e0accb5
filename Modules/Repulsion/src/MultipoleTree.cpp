// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Repulsion/MultipoleTree.h"

#include "AdjacentChunks.h"
#include "Assembly.h"
#include "ClusterTree.h"
#include "Explica/Core/Errors.h"
#include "Explica/Core/Parallel.h"
#include "Kernels.h"
#include "MovingSet.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>

namespace explica::repulsion {
namespace {

constexpr int kLanes = kernels::kLanes;

// Distances of centroids, in sums of radii, from which seven and twelve points a face are enough;
// faces nearer than the last are halved.
constexpr float kSevenRatio = 0.9F;
constexpr float kTwelveRatio = 0.5F;
constexpr int kHalvings = 8;  // at most: then the faces touch

/// A face or a part of it, single precision, relative to the target leaf's centre.
struct Part {
  Eigen::Vector3f corner[3];
  Eigen::Vector3f lambda[3];  // of the corners, in the whole face
  Eigen::Vector3f centre;
  float radius = 0;
  float share = 1;
  bool whole = true;

  void measure() {
    centre = (corner[0] + corner[1] + corner[2]) / 3;
    radius = 0;
    for (const auto& c : corner) radius = std::max(radius, (c - centre).squaredNorm());
    radius = std::sqrt(radius);
  }

  void halve(Part& left, Part& right) const {
    int from = 0;
    for (int k = 1; k < 3; ++k) {
      if ((corner[k] - corner[(k + 1) % 3]).squaredNorm() >
          (corner[from] - corner[(from + 1) % 3]).squaredNorm()) {
        from = k;
      }
    }
    const int to = (from + 1) % 3;
    left = right = *this;
    left.corner[to] = right.corner[from] = (corner[from] + corner[to]) / 2;
    left.lambda[to] = right.lambda[from] = (lambda[from] + lambda[to]) / 2;
    for (Part* part : {&left, &right}) {
      part->share = share / 2;
      part->whole = false;
      part->measure();
    }
  }
};

/// Corners of the faces of a leaf, in units and relative to the target leaf's centre.
struct LeafCorners {
  float at[9][kLanes];
};

Part wholePart(const std::array<float, 9>& corners) {
  Part part;
  for (int k = 0; k < 3; ++k) {
    part.corner[k] = Eigen::Vector3f(corners[3 * k], corners[3 * k + 1], corners[3 * k + 2]);
    part.lambda[k] = Eigen::Vector3f::Unit(k);
  }
  part.measure();
  return part;
}

/// Means over the pairs of one target leaf that three points a face do not resolve.
class NearPairs {
 public:
  explicit NearPairs(const LeafCorners& targets) : targets_(targets) {}

  /// @param ratio   distance of the centroids in sums of radii
  /// @param source  corners of the source face
  void add(int lane, float ratio, const std::array<float, 9>& source, int set, float areaT) {
    if (ratio >= kTwelveRatio) {
      Batch& batch = ratio < kSevenRatio ? fine_ : coarse_;
      const int slot = batch.filled++;
      for (int row = 0; row < 9; ++row) {
        batch.data.s[row][slot] = targets_.at[row][lane];
        batch.data.t[row][slot] = source[row];
      }
      finish(batch, slot, lane, set, areaT, nullptr);
      return;
    }
    std::array<float, 9> own;
    for (int row = 0; row < 9; ++row) own[row] = targets_.at[row][lane];
    divide(wholePart(own), wholePart(source), lane, set, areaT, 0);
  }

  void flush() {
    flushBatch(coarse_);
    flushBatch(fine_);
  }

  /// Area of the sources times mean of 1/r^2, for each face of the target leaf.
  [[nodiscard]] double phi(int set, int lane) const { return phi_[set][lane]; }
  /// Its derivative by the face's corner k, in units.
  [[nodiscard]] Vector by(int lane, int k) const {
    return {by_[lane][3 * k], by_[lane][3 * k + 1], by_[lane][3 * k + 2]};
  }

 private:
  struct Batch {
    kernels::ApartBatch data;
    int filled = 0;
    int lane[kLanes];
    int set[kLanes];
    float weight[kLanes];
    bool whole[kLanes];
    Eigen::Vector3f lambda[kLanes][3];
  };

  void divide(const Part& s, const Part& t, int lane, int set, float areaT, int depth) {
    const float ratio = (s.centre - t.centre).norm() / (s.radius + t.radius);
    if (ratio < kTwelveRatio && depth < 2 * kHalvings) {
      Part left;
      Part right;
      if (s.radius >= t.radius) {
        s.halve(left, right);
        divide(left, t, lane, set, areaT, depth + 1);
        divide(right, t, lane, set, areaT, depth + 1);
      } else {
        t.halve(left, right);
        divide(s, left, lane, set, areaT, depth + 1);
        divide(s, right, lane, set, areaT, depth + 1);
      }
      return;
    }
    Batch& batch = ratio < kSevenRatio ? fine_ : coarse_;
    const int slot = batch.filled++;
    for (int k = 0; k < 3; ++k) {
      for (int a = 0; a < 3; ++a) {
        batch.data.s[3 * k + a][slot] = s.corner[k][a];
        batch.data.t[3 * k + a][slot] = t.corner[k][a];
      }
    }
    finish(batch, slot, lane, set, areaT * s.share * t.share, s.whole ? nullptr : s.lambda);
  }

  void finish(Batch& batch, int slot, int lane, int set, float weight,
              const Eigen::Vector3f* lambda) {
    batch.lane[slot] = lane;
    batch.set[slot] = set;
    batch.weight[slot] = weight;
    batch.whole[slot] = lambda == nullptr;
    if (lambda) std::copy(lambda, lambda + 3, batch.lambda[slot]);
    if (batch.filled == kLanes) flushBatch(batch);
  }

  void flushBatch(Batch& batch) {
    if (batch.filled == 0) return;
    for (int row = 0; row < 9; ++row) {
      std::fill(batch.data.s[row] + batch.filled, batch.data.s[row] + kLanes, batch.data.s[row][0]);
      std::fill(batch.data.t[row] + batch.filled, batch.data.t[row] + kLanes, batch.data.t[row][0]);
    }
    kernels::integrateApart(batch.data, &batch == &fine_);
    for (int slot = 0; slot < batch.filled; ++slot) {
      const int lane = batch.lane[slot];
      const double w = batch.weight[slot];
      phi_[batch.set[slot]][lane] += w * batch.data.value[slot];
      double* by = by_[lane];
      for (int k = 0; k < 3; ++k) {
        for (int a = 0; a < 3; ++a) {
          const double g = w * batch.data.byS[3 * k + a][slot];
          if (batch.whole[slot]) {
            by[3 * k + a] += g;
          } else {
            for (int c = 0; c < 3; ++c) by[3 * c + a] += batch.lambda[slot][k][c] * g;
          }
        }
      }
    }
    batch.filled = 0;
  }

  const LeafCorners& targets_;
  double phi_[2][kLanes] = {};
  double by_[kLanes][9] = {};
  Batch coarse_;
  Batch fine_;
};

/// Scratch of one thread's block of leaves.
struct Lists {
  std::vector<kernels::FarNode> far;
  std::vector<kernels::CloseLeaf> close;
  std::vector<kernels::NearHit> hits;
  std::vector<std::int32_t> stack;
};

}  // namespace

struct MultipoleTree::State {
  State(const TriangleMesh& mesh, const std::vector<bool>& vertexMoves) : set(mesh, vertexMoves) {}

  MovingSet set;
  MultipoleTreeOptions options;
  double unit = 1;  // mm, a power of two next to the mean face size
  ClusterTree fixedTree;
  AdjacentChunks adjacent;

  void addNear(const kernels::TargetLeaf& target, const ClusterTree::Node& leaf,
               const ClusterTree& movingTree, const kernels::NearHit& hit, int which,
               const ClusterTree& tree, NearPairs& nearPairs) const;
  void gather(const ClusterTree::Node& target, const ClusterTree& tree, Lists& lists) const;
  void sumLeaf(const Positions& positions, const ClusterTree& movingTree, std::size_t leaf,
               Lists& lists, std::vector<FaceForce>& forces) const;
};

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
  auto state = std::make_unique<State>(mesh, vertexMoves);
  state->options = options;
  double area = 0;
  for (const std::int32_t f : state->set.moving) {
    area += areaGradient(cornersOf(mesh.positions, mesh.faces, f)).area;
  }
  if (area > 0) {
    const double size = std::sqrt(area / static_cast<double>(state->set.moving.size()));
    state->unit = std::exp2(std::round(std::log2(size)));
  }
  state->fixedTree = ClusterTree(mesh.positions, mesh.faces, state->set.fixed, state->unit);
  const ClusterTree movingTree(mesh.positions, mesh.faces, state->set.moving, state->unit);
  std::vector<std::int32_t> rank(static_cast<std::size_t>(mesh.faceCount()), 0);
  for (std::size_t i = 0; i < movingTree.order().size(); ++i) {
    rank[state->set.moving[movingTree.order()[i]]] = static_cast<std::int32_t>(i);
  }
  state->adjacent = AdjacentChunks(state->set, rank);
  state_ = std::move(state);
}

MultipoleTree::~MultipoleTree() = default;

const char* MultipoleTree::instructionSet() {
  return kernels::instructionSet();
}

void MultipoleTree::State::gather(const ClusterTree::Node& target, const ClusterTree& tree,
                                  Lists& lists) const {
  lists.far.clear();
  lists.close.clear();
  if (tree.empty()) return;
  const double inverseOpening = 1 / options.opening;
  const double inverseUnit = 1 / unit;
  lists.stack.assign(1, 0);
  while (!lists.stack.empty()) {
    const ClusterTree::Node& node = tree.nodes()[lists.stack.back()];
    lists.stack.pop_back();
    const Vector offset = node.centre - target.centre;
    const double squared = offset.squaredNorm();
    const double clear =
        target.radius +
        std::max(node.radius * inverseOpening,
                 node.radius + (options.nearRatio - 1) * (target.largestFace + node.largestFace));
    if (squared > clear * clear) {
      kernels::FarNode far;
      for (int a = 0; a < 3; ++a) far.centre[a] = static_cast<float>(offset[a] * inverseUnit);
      const double area = inverseUnit * inverseUnit;
      const double second = area * area;
      far.mass = static_cast<float>(node.mass * area);
      far.xx = static_cast<float>(node.second[0] * second);
      far.yy = static_cast<float>(node.second[1] * second);
      far.zz = static_cast<float>(node.second[2] * second);
      far.xy = static_cast<float>(node.second[3] * second);
      far.xz = static_cast<float>(node.second[4] * second);
      far.yz = static_cast<float>(node.second[5] * second);
      far.trace = far.xx + far.yy + far.zz;
      lists.far.push_back(far);
    } else if (node.isLeaf()) {
      kernels::CloseLeaf close;
      close.faces = tree.sources().data() + node.first;
      close.count = node.count;
      close.first = node.first;
      for (int a = 0; a < 3; ++a) close.offset[a] = static_cast<float>(offset[a] * inverseUnit);
      lists.close.push_back(close);
    } else {
      lists.stack.push_back(node.left + 1);
      lists.stack.push_back(node.left);
    }
  }
}

void MultipoleTree::State::addNear(const kernels::TargetLeaf& target, const ClusterTree::Node& leaf,
                                   const ClusterTree& movingTree, const kernels::NearHit& hit,
                                   int which, const ClusterTree& tree, NearPairs& nearPairs) const {
  const kernels::SourceFace& source = tree.sources()[hit.face];
  const auto& vertices = tree.vertices()[hit.face];
  const Vector offset = (tree.leafOf(hit.face).centre - leaf.centre) / unit;
  const std::array<float, 3> shift = {static_cast<float>(offset[0]), static_cast<float>(offset[1]),
                                      static_cast<float>(offset[2])};
  std::array<float, 9> corners;
  for (int row = 0; row < 9; ++row) corners[row] = tree.corners()[hit.face][row] + shift[row % 3];
  const std::uint32_t present = (1U << leaf.count) - 1;
  for (std::uint32_t left = hit.targets & present; left != 0; left &= left - 1) {
    const int lane = std::countr_zero(left);
    const auto& own = movingTree.vertices()[leaf.first + lane];
    bool touching = false;
    for (const std::int32_t v : own) {
      touching |= (v == vertices[0]) | (v == vertices[1]) | (v == vertices[2]);
    }
    if (touching) continue;
    float squared = 0;
    for (int a = 0; a < 3; ++a) {
      const float d = target.centroid[a][lane] - source.centroid[a] - shift[a];
      squared += d * d;
    }
    const float ratio = std::sqrt(squared) / (target.radius[lane] + source.radius);
    nearPairs.add(lane, ratio, corners, which, 3 * source.weight);
  }
}

void MultipoleTree::State::sumLeaf(const Positions& positions, const ClusterTree& movingTree,
                                   std::size_t leafNumber, Lists& lists,
                                   std::vector<FaceForce>& forces) const {
  const ClusterTree::Node& leaf = movingTree.nodes()[movingTree.leaves()[leafNumber]];
  kernels::TargetLeaf target{};
  for (int lane = 0; lane < kLanes; ++lane) {
    const kernels::SourceFace& face =
        movingTree.sources()[leaf.first + std::min(lane, leaf.count - 1)];
    for (int a = 0; a < 3; ++a) {
      target.centroid[a][lane] = face.centroid[a];
      for (int q = 0; q < 3; ++q) target.point[q][a][lane] = face.point[q][a];
    }
    target.radius[lane] = face.radius;
  }

  LeafCorners corners;
  for (int lane = 0; lane < leaf.count; ++lane) {
    const auto& own = movingTree.corners()[leaf.first + lane];
    for (int row = 0; row < 9; ++row) corners.at[row][lane] = own[row];
  }
  NearPairs nearPairs(corners);
  for (int which = 0; which < 2; ++which) {
    const ClusterTree& tree = which == 0 ? movingTree : fixedTree;
    gather(leaf, tree, lists);
    kernels::addFarNodes(target, which, lists.far.data(), lists.far.size());
    std::size_t room = 0;
    for (const auto& c : lists.close) room += static_cast<std::size_t>(c.count);
    // A face may be listed once for each part of the lanes that one vector holds.
    if (lists.hits.size() < kLanes * room) lists.hits.resize(kLanes * room);
    const std::size_t hitCount =
        kernels::addCloseLeaves(target, which, lists.close.data(), lists.close.size(),
                                static_cast<float>(options.nearRatio), lists.hits.data());
    for (std::size_t h = 0; h < hitCount; ++h) {
      addNear(target, leaf, movingTree, lists.hits[h], which, tree, nearPairs);
    }
  }
  nearPairs.flush();

  for (int lane = 0; lane < leaf.count; ++lane) {
    const std::int32_t slot = movingTree.order()[leaf.first + lane];
    const AreaGradient area = areaGradient(cornersOf(positions, set.faces, set.moving[slot]));
    std::array<double, 2> phi = {nearPairs.phi(0, lane), nearPairs.phi(1, lane)};
    Vector total = Vector::Zero();
    std::array<Vector, 3> g;
    for (int q = 0; q < 3; ++q) {
      for (int which = 0; which < 2; ++which) {
        phi[which] += static_cast<double>(target.phi[which][q][lane]) / 3;
      }
      g[q] = Vector(target.g[q][0][lane], target.g[q][1][lane], target.g[q][2][lane]) / 3;
      total += g[q];
    }
    FaceForce& force = forces[slot];
    force.value = area.area * (phi[0] + 2 * phi[1]);
    for (int k = 0; k < 3; ++k) {
      const Vector by = (total / 6 + g[k] / 2 + nearPairs.by(lane, k)) / unit;
      force.byCorner[k] = 2 * (area.area * by + (phi[0] + phi[1]) * area.byCorner[k]);
    }
  }
}

KnotValue MultipoleTree::evaluate(const Positions& positions) const {
  const State& state = *state_;
  state.set.requireVertexCount(positions);
  const ClusterTree movingTree(positions, state.set.faces, state.set.moving, state.unit);
  std::vector<FaceForce> forces(state.set.moving.size());
  parallelForBlocks(movingTree.leaves().size(), 4, [&](std::size_t begin, std::size_t end) {
    Lists lists;
    for (std::size_t leaf = begin; leaf < end; ++leaf) {
      state.sumLeaf(positions, movingTree, leaf, lists, forces);
    }
  });

  KnotValue result;
  result.gradient.setZero(positions.rows(), 3);
  state.adjacent.add(positions, state.unit, result.value, result.gradient);
  for (std::size_t k = 0; k < forces.size(); ++k) {
    result.value += forces[k].value;
    for (int c = 0; c < 3; ++c) {
      result.gradient.row(state.set.faces(state.set.moving[k], c)) +=
          forces[k].byCorner[c].transpose();
    }
  }
  for (Eigen::Index v = 0; v < positions.rows(); ++v) {
    if (!state.set.vertexMoves[static_cast<std::size_t>(v)]) result.gradient.row(v).setZero();
  }
  return result;
}

}  // namespace explica::repulsion
