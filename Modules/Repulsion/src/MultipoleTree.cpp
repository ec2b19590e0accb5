// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Repulsion/MultipoleTree.h"

#include "Assembly.h"
#include "ClusterTree.h"
#include "Explica/Core/Errors.h"
#include "Explica/Core/Parallel.h"
#include "Kernels.h"
#include "MovingSet.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

namespace explica::repulsion {
namespace {

constexpr int kLanes = kernels::kLanes;  // faces taken at once

// Distances of centroids, in sums of radii, from which seven and twelve points a face are enough;
// faces nearer than the last are halved.
constexpr float kSevenRatio = 0.9F;
constexpr float kTwelveRatio = 0.5F;
constexpr int kHalvings = 8;  // at most: then the faces touch

/// A face or a part of it, single precision, relative to the target leaf's centre.
struct EnergyPart {
  std::array<Eigen::Vector3f, 3> corner;
  std::array<Eigen::Vector3f, 3> lambda;  // of the corners, in the whole face
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

  void halve(EnergyPart& left, EnergyPart& right) const {
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
    for (EnergyPart* part : {&left, &right}) {
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

/// Second moments of each face about its centroid, over its area.
void setSecondMoments(const LeafCorners& corners, kernels::TargetLeaf& target) {
  constexpr std::array<std::pair<int, int>, 6> kAxes = {
      {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {0, 2}, {1, 2}}};
  for (std::size_t m = 0; m < kAxes.size(); ++m) {
    const auto [a, b] = kAxes[m];
    for (int lane = 0; lane < kLanes; ++lane) {
      float sum = 0;
      for (int k = 0; k < 3; ++k) {
        sum += (corners.at[3 * k + a][lane] - target.centroid[a][lane]) *
               (corners.at[3 * k + b][lane] - target.centroid[b][lane]);
      }
      target.second[m][lane] = sum / 12;
    }
  }
}

EnergyPart wholePart(const std::array<float, 9>& corners) {
  EnergyPart part;
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

  void divide(const EnergyPart& s, const EnergyPart& t, int lane, int set, float areaT, int depth) {
    const float ratio = (s.centre - t.centre).norm() / (s.radius + t.radius);
    if (ratio < kTwelveRatio && depth < 2 * kHalvings) {
      EnergyPart left;
      EnergyPart right;
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
    finish(batch, slot, lane, set, areaT * s.share * t.share, s.whole ? nullptr : s.lambda.data());
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

/// What a block of four target groups shares of one tree of sources.
struct Shared {
  std::vector<kernels::FarNode> far;  // seen from the block's centre
  std::vector<std::int32_t> close;    // groups
  std::vector<std::int32_t> candidates;
  std::vector<std::int32_t> next;
};

/// Scratch of one thread's blocks.
struct Lists {
  std::array<Shared, 2> shared;  // moving sources, fixed sources
  std::vector<kernels::CloseGroup> close;
  std::vector<kernels::FarNode> nodes;
  std::vector<kernels::OpenLeaf> leaves;
  std::vector<kernels::MaskedFace> masked;
  std::vector<kernels::NearHit> hits;
  std::vector<std::uint16_t> targetsAt;  // of each vertex: the group's faces that have it
};

/// Things that tasks take in turns, for their memory.
template <class T>
class Pool {
 public:
  [[nodiscard]] std::unique_ptr<T> take() {
    const std::scoped_lock lock(mutex_);
    if (idle_.empty()) return std::make_unique<T>();
    std::unique_ptr<T> thing = std::move(idle_.back());
    idle_.pop_back();
    return thing;
  }
  void giveBack(std::unique_ptr<T> thing) {
    const std::scoped_lock lock(mutex_);
    idle_.push_back(std::move(thing));
  }

 private:
  std::mutex mutex_;
  std::vector<std::unique_ptr<T>> idle_;
};

/// What an evaluation writes besides its result.
struct Workspace {
  ClusterTree movingTree;
  std::vector<FaceForce> forces;
  Pool<Lists> lists;
};

std::array<float, 3> difference(const std::array<double, 3>& a, const std::array<double, 3>& b) {
  return {static_cast<float>(a[0] - b[0]), static_cast<float>(a[1] - b[1]),
          static_cast<float>(a[2] - b[2])};
}

}  // namespace

struct MultipoleTree::State {
  State(const TriangleMesh& mesh, const std::vector<bool>& vertexMoves) : set(mesh, vertexMoves) {}

  MovingSet set;
  MultipoleTreeOptions options;
  double unit = 1;  // mm, a power of two next to the mean face size
  ClusterTree fixedTree;
  mutable Pool<Workspace> workspaces;

  void addNear(const kernels::TargetLeaf& target, const ClusterTree::Node& leaf,
               const kernels::NearHit& hit, int which, const ClusterTree& tree,
               NearPairs& nearPairs) const;
  void gatherShared(const ClusterTree& targets, std::int32_t block, const ClusterTree& tree,
                    Shared& shared) const;
  void sumBlock(const Positions& positions, const ClusterTree& movingTree, std::int32_t block,
                Lists& lists, std::vector<FaceForce>& forces) const;
  void sumLeaf(const Positions& positions, const ClusterTree& movingTree, std::int32_t group,
               std::int32_t block, Lists& lists, std::vector<FaceForce>& forces) const;
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
  state->fixedTree.build(mesh.positions, mesh.faces, state->set.fixed, state->unit, options.opening,
                         options.nearRatio);
  state_ = std::move(state);
}

MultipoleTree::~MultipoleTree() = default;

const char* MultipoleTree::instructionSet() {
  return kernels::instructionSet();
}

void MultipoleTree::State::gatherShared(const ClusterTree& targets, std::int32_t block,
                                        const ClusterTree& tree, Shared& shared) const {
  shared.far.clear();
  shared.close.clear();
  if (tree.empty()) return;
  const auto& origin = targets.moments()[block].centre;
  const std::array<float, 3> centre = difference(origin, tree.moments()[0].centre);
  const ClusterTree::Node& node = targets.nodes()[block];
  const auto spread = static_cast<float>(node.radius / unit);
  const auto margin = static_cast<float>((options.nearRatio - 1) * node.largestFace / unit);

  shared.candidates.assign(1, 0);
  while (!shared.candidates.empty()) {
    shared.next.clear();
    for (const std::int32_t number : shared.candidates) {
      const ClusterTree::Ball& source = tree.balls()[number];
      const float dx = source.x - centre[0];
      const float dy = source.y - centre[1];
      const float dz = source.z - centre[2];
      const float squared = dx * dx + dy * dy + dz * dz;
      const float clear = std::max(source.reach, source.margin + margin);
      if (squared > (spread + clear) * (spread + clear)) {
        shared.far.push_back(farNode(tree.moments()[number], origin));
      } else if (source.left >= 0) {
        shared.next.push_back(source.left);
        shared.next.push_back(source.left + 1);
      } else {
        shared.close.push_back(tree.nodes()[number].first / kLanes);
      }
    }
    shared.candidates.swap(shared.next);
  }
}

void MultipoleTree::State::addNear(const kernels::TargetLeaf& target, const ClusterTree::Node& leaf,
                                   const kernels::NearHit& hit, int which, const ClusterTree& tree,
                                   NearPairs& nearPairs) const {
  const kernels::SourceFace& source = tree.sources()[hit.face];
  const Vector offset = (tree.groupOf(hit.face).centre - leaf.centre) / unit;
  const std::array<float, 3> shift = {static_cast<float>(offset[0]), static_cast<float>(offset[1]),
                                      static_cast<float>(offset[2])};
  std::array<float, 9> corners;
  for (int row = 0; row < 9; ++row) corners[row] = tree.corners()[hit.face][row] + shift[row % 3];
  const std::uint32_t present = (1U << leaf.count) - 1;
  for (std::uint32_t left = hit.targets & present; left != 0; left &= left - 1) {
    const int lane = std::countr_zero(left);
    float squared = 0;
    for (int a = 0; a < 3; ++a) {
      const float d = target.centroid[a][lane] - source.centroid[a] - shift[a];
      squared += d * d;
    }
    const float ratio = std::sqrt(squared) / (target.radius[lane] + source.radius);
    nearPairs.add(lane, ratio, corners, which, 3 * source.point[0][3]);
  }
}

void MultipoleTree::State::sumBlock(const Positions& positions, const ClusterTree& movingTree,
                                    std::int32_t block, Lists& lists,
                                    std::vector<FaceForce>& forces) const {
  gatherShared(movingTree, block, movingTree, lists.shared[0]);
  gatherShared(movingTree, block, fixedTree, lists.shared[1]);
  const ClusterTree::Node& node = movingTree.nodes()[block];
  for (std::int32_t first = node.first; first < node.first + node.count; first += kLanes) {
    sumLeaf(positions, movingTree, movingTree.groups()[first / kLanes], block, lists, forces);
  }
}

void MultipoleTree::State::sumLeaf(const Positions& positions, const ClusterTree& movingTree,
                                   std::int32_t group, std::int32_t block, Lists& lists,
                                   std::vector<FaceForce>& forces) const {
  const ClusterTree::Node& leaf = movingTree.nodes()[group];
  const std::array<float, 3> shift =
      difference(movingTree.moments()[group].centre, movingTree.moments()[block].centre);
  kernels::TargetLeaf target{};
  LeafCorners corners;
  for (int lane = 0; lane < kLanes; ++lane) {
    const std::int32_t k = leaf.first + std::min(lane, leaf.count - 1);
    const kernels::SourceFace& face = movingTree.sources()[k];
    const auto& own = movingTree.corners()[k];
    for (int a = 0; a < 3; ++a) {
      target.centroid[a][lane] = face.centroid[a];
      for (int q = 0; q < 3; ++q) target.point[q][a][lane] = face.point[q][a];
    }
    target.radius[lane] = face.radius;
    for (int row = 0; row < 9; ++row) corners.at[row][lane] = own[row];
  }
  setSecondMoments(corners, target);

  // The faces' vertices, marked while the group is summed.
  const auto* vertices = movingTree.vertices().data() + leaf.first;
  for (int lane = 0; lane < leaf.count; ++lane) {
    for (const std::int32_t v : vertices[lane]) {
      lists.targetsAt[v] = static_cast<std::uint16_t>(lists.targetsAt[v] | (1U << lane));
    }
  }

  NearPairs nearPairs(corners);
  for (int which = 0; which < 2; ++which) {
    const ClusterTree& tree = which == 0 ? movingTree : fixedTree;
    const Shared& shared = lists.shared[which];
    kernels::addFarNodes(target, which, shared.far.data(), shared.far.size(), shift.data());
    lists.close.clear();
    for (const std::int32_t g : shared.close) {
      const std::array<float, 3> offset =
          difference(tree.moments()[tree.groups()[g]].centre, movingTree.moments()[group].centre);
      lists.close.push_back({&tree.groupPacks()[g], {offset[0], offset[1], offset[2], 0}});
    }
    const std::size_t room = lists.close.size() * kLanes + 1;
    if (lists.nodes.size() < room) {
      lists.nodes.resize(room);
      lists.leaves.resize(room);
      lists.masked.resize(room);
      lists.hits.resize(2 * room);
    }
    const std::size_t hitCount = kernels::addCloseGroups(
        target, which, lists.close.data(), lists.close.size(),
        {tree.leafPacks().data(), tree.sources().data(), tree.vertices().data(),
         lists.targetsAt.data()},
        static_cast<float>(options.nearRatio),
        {lists.nodes.data(), lists.leaves.data(), lists.masked.data(), lists.hits.data()});
    for (std::size_t h = 0; h < hitCount; ++h) {
      addNear(target, leaf, lists.hits[h], which, tree, nearPairs);
    }
  }
  nearPairs.flush();
  for (int lane = 0; lane < leaf.count; ++lane) {
    for (const std::int32_t v : vertices[lane]) lists.targetsAt[v] = 0;
  }

  for (int lane = 0; lane < leaf.count; ++lane) {
    const std::int32_t slot = movingTree.order()[leaf.first + lane];
    const Corners own = cornersOf(positions, set.faces, set.moving[slot]);
    const FaceArea area = faceArea(own);
    constexpr double kThird = 1.0 / 3;
    std::array<double, 2> phi = {nearPairs.phi(0, lane), nearPairs.phi(1, lane)};
    Vector total = Vector::Zero();
    std::array<Vector, 3> g;
    for (int q = 0; q < 3; ++q) {
      for (int which = 0; which < 2; ++which) {
        phi[which] += kThird * static_cast<double>(target.phi[which][q][lane]);
      }
      g[q] = kThird * Vector(target.g[q][0][lane], target.g[q][1][lane], target.g[q][2][lane]);
      total += g[q];
    }
    FaceForce& force = forces[slot];
    force.value = area.area * (phi[0] + 2 * phi[1]);
    const double byShape = 2 * area.area / unit;
    const double byArea = 2 * (phi[0] + phi[1]);
    for (int k = 0; k < 3; ++k) {
      force.byCorner[k] = byShape * (total / 6 + g[k] / 2 + nearPairs.by(lane, k)) +
                          byArea * areaByCorner(area.normal, own, k);
    }
  }
}

KnotValue MultipoleTree::evaluate(const Positions& positions) const {
  const State& state = *state_;
  state.set.requireVertexCount(positions);
  std::unique_ptr<Workspace> work = state.workspaces.take();
  work->movingTree.build(positions, state.set.faces, state.set.moving, state.unit,
                         state.options.opening, state.options.nearRatio);
  work->forces.resize(state.set.moving.size());
  const std::vector<std::int32_t>& blocks = work->movingTree.blocks();
  parallelForBlocks(blocks.size(), std::clamp<std::size_t>(blocks.size() / 64, 1, 8),
                    [&](std::size_t begin, std::size_t end) {
                      std::unique_ptr<Lists> lists = work->lists.take();
                      lists->targetsAt.resize(state.set.vertexMoves.size(), 0);
                      for (std::size_t b = begin; b < end; ++b) {
                        state.sumBlock(positions, work->movingTree, blocks[b], *lists,
                                       work->forces);
                      }
                      work->lists.giveBack(std::move(lists));
                    });

  KnotValue result = assemble(state.set, positions, work->forces,
                              adjacentPairs(state.set, positions, PairAccuracy::Coarse));
  state.workspaces.giveBack(std::move(work));
  return result;
}

}  // namespace explica::repulsion
