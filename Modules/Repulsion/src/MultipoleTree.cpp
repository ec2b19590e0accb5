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
// Distance, in sizes of the largest target face, from which a node acts on the centroid of each
// face rather than on its quadrature points.
constexpr double kFarthest = 6;
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
  std::vector<kernels::FarNode> farthest;
  std::vector<kernels::CloseLeaf> close;
  std::vector<kernels::ClearFace> clear;
  std::vector<kernels::MaskedFace> masked;
  std::vector<kernels::NearHit> hits;
  std::vector<std::int32_t> candidates;
  std::vector<std::int32_t> farNumbers;
  std::vector<std::int32_t> opened;
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
  [[nodiscard]] kernels::CloseLeaf closeLeaf(const ClusterTree::Node& target,
                                             const ClusterTree::Node& leaf,
                                             const ClusterTree& tree) const;
  void gather(const ClusterTree::Node& target, const ClusterTree& tree, Lists& lists) const;
  void sumLeaf(const Positions& positions, const std::vector<FaceArea>& areas,
               const ClusterTree& movingTree, std::size_t leaf, Lists& lists,
               std::vector<FaceForce>& forces) const;
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
  lists.farthest.clear();
  lists.close.clear();
  if (tree.empty()) return;
  const double inverseUnit = 1 / unit;
  const Eigen::Vector3f centre =
      ((target.centre - tree.nodes()[0].centre) * inverseUnit).cast<float>();
  const auto radius = static_cast<float>(target.radius * inverseUnit);
  const auto largestFace = static_cast<float>(target.largestFace * inverseUnit);
  const auto inverseOpening = static_cast<float>(1 / options.opening);
  const auto margin = static_cast<float>(options.nearRatio - 1);

  // Level by level, without branches: whether a node is far is hard to predict.
  lists.candidates.assign(1, 0);
  lists.farNumbers.clear();
  while (!lists.candidates.empty()) {
    const std::size_t before = lists.farNumbers.size();
    lists.farNumbers.resize(before + lists.candidates.size());
    lists.opened.resize(lists.candidates.size());
    std::int32_t* far = lists.farNumbers.data() + before;
    std::int32_t* open = lists.opened.data();
    for (const std::int32_t number : lists.candidates) {
      const ClusterTree::Ball& ball = tree.balls()[number];
      const float dx = ball.x - centre[0];
      const float dy = ball.y - centre[1];
      const float dz = ball.z - centre[2];
      const float clear =
          radius + std::max(ball.radius * inverseOpening,
                            ball.radius + margin * (largestFace + ball.largestFace));
      const bool isFar = dx * dx + dy * dy + dz * dz > clear * clear;
      *far = number;
      *open = number;
      far += isFar;
      open += !isFar;
    }
    lists.farNumbers.resize(static_cast<std::size_t>(far - lists.farNumbers.data()));
    const auto openCount = static_cast<std::size_t>(open - lists.opened.data());
    lists.candidates.clear();
    for (std::size_t i = 0; i < openCount; ++i) {
      const std::int32_t left = tree.balls()[lists.opened[i]].left;
      if (left < 0) {
        lists.close.push_back(closeLeaf(target, tree.nodes()[lists.opened[i]], tree));
      } else {
        lists.candidates.push_back(left);
        lists.candidates.push_back(left + 1);
      }
    }
  }

  const double carried = target.radius + kFarthest * target.largestFace;
  lists.far.resize(lists.farNumbers.size());
  lists.farthest.resize(lists.farNumbers.size());
  kernels::FarNode* far = lists.far.data();
  kernels::FarNode* farthest = lists.farthest.data();
  for (const std::int32_t number : lists.farNumbers) {
    const Vector offset = tree.nodes()[number].centre - target.centre;
    const bool isFarthest = offset.squaredNorm() > carried * carried;
    kernels::FarNode& node = *(isFarthest ? farthest : far);
    node = tree.moments()[number];
    for (int a = 0; a < 3; ++a) node.centre[a] = static_cast<float>(offset[a] * inverseUnit);
    farthest += isFarthest;
    far += !isFarthest;
  }
  lists.far.resize(static_cast<std::size_t>(far - lists.far.data()));
  lists.farthest.resize(static_cast<std::size_t>(farthest - lists.farthest.data()));
}

kernels::CloseLeaf MultipoleTree::State::closeLeaf(const ClusterTree::Node& target,
                                                   const ClusterTree::Node& leaf,
                                                   const ClusterTree& tree) const {
  const Vector group = (tree.groupOf(leaf.first).centre - target.centre) / unit;
  kernels::CloseLeaf close;
  close.faces = tree.sources().data() + leaf.first;
  close.count = leaf.count;
  close.first = leaf.first;
  for (int a = 0; a < 3; ++a) close.offset[a] = static_cast<float>(group[a]);
  const double apart = target.radius + leaf.radius +
                       (options.nearRatio - 1) * (target.largestFace + leaf.largestFace);
  close.mayTouch = (leaf.centre - target.centre).squaredNorm() <= apart * apart;
  return close;
}

void MultipoleTree::State::addNear(const kernels::TargetLeaf& target, const ClusterTree::Node& leaf,
                                   const ClusterTree& movingTree, const kernels::NearHit& hit,
                                   int which, const ClusterTree& tree, NearPairs& nearPairs) const {
  const kernels::SourceFace& source = tree.sources()[hit.face];
  const auto& vertices = tree.vertices()[hit.face];
  const Vector offset = (tree.groupOf(hit.face).centre - leaf.centre) / unit;
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
    nearPairs.add(lane, ratio, corners, which, 3 * source.point[0][3]);
  }
}

void MultipoleTree::State::sumLeaf(const Positions& positions, const std::vector<FaceArea>& areas,
                                   const ClusterTree& movingTree, std::size_t leafNumber,
                                   Lists& lists, std::vector<FaceForce>& forces) const {
  const ClusterTree::Node& leaf = movingTree.nodes()[movingTree.groups()[leafNumber]];
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
    kernels::addFarthestNodes(target, which, lists.farthest.data(), lists.farthest.size());
    std::size_t room = 0;
    for (const auto& c : lists.close) room += static_cast<std::size_t>(c.count);
    if (lists.hits.size() < room + 1) {
      lists.clear.resize(room + 1);
      lists.masked.resize(room + 1);
      lists.hits.resize(room + 1);
    }
    const std::size_t hitCount =
        kernels::addCloseLeaves(target, which, lists.close.data(), lists.close.size(),
                                static_cast<float>(options.nearRatio),
                                {lists.clear.data(), lists.masked.data(), lists.hits.data()});
    for (std::size_t h = 0; h < hitCount; ++h) {
      addNear(target, leaf, movingTree, lists.hits[h], which, tree, nearPairs);
    }
  }
  nearPairs.flush();

  for (int lane = 0; lane < leaf.count; ++lane) {
    const std::int32_t slot = movingTree.order()[leaf.first + lane];
    const FaceArea& area = areas[slot];
    const Corners own = cornersOf(positions, set.faces, set.moving[slot]);
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
      force.byCorner[k] =
          2 * (area.area * by + (phi[0] + phi[1]) * areaByCorner(area.normal, own, k));
    }
  }
}

KnotValue MultipoleTree::evaluate(const Positions& positions) const {
  const State& state = *state_;
  state.set.requireVertexCount(positions);
  const ClusterTree movingTree(positions, state.set.faces, state.set.moving, state.unit);
  std::vector<FaceArea> areas(state.set.involved.size());
  parallelFor(areas.size(), 1024, [&](std::size_t i) {
    areas[i] = faceArea(cornersOf(positions, state.set.faces, state.set.involved[i]));
  });
  std::vector<FaceForce> forces(state.set.moving.size());
  parallelForBlocks(movingTree.groups().size(), 4, [&](std::size_t begin, std::size_t end) {
    Lists lists;
    for (std::size_t leaf = begin; leaf < end; ++leaf) {
      state.sumLeaf(positions, areas, movingTree, leaf, lists, forces);
    }
  });

  KnotValue result;
  result.gradient.setZero(positions.rows(), 3);
  state.adjacent.add(positions, areas, state.unit, result.value, result.gradient);
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
