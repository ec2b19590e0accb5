// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Core/Parallel.h"
#include "Explica/Geometry/FaceTree.h"
#include "NearestKernel.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

namespace explica::geometry {
namespace {

constexpr auto kBoxLanes = static_cast<std::size_t>(BoxBlock::kLanes);  // boxes a block
constexpr int kMostLevels = 11;                                         // of 2^31 faces
/// Relative roundings to single precision, with room to spare: of one number, and of a square of
/// sums of them.
constexpr float kBoxRounding = 1.2e-7F, kSquareRounding = 2e-6F;

/// Orders items so that each aligned run of 8, of 64 and so on lies together.
void orderInSpace(const std::vector<Point>& centres, std::int32_t* items, std::size_t count) {
  constexpr std::size_t kAlone = 4096;  // items that are not worth another thread
  if (count <= kBoxLanes) return;
  std::size_t unit = kBoxLanes;
  while (unit * kBoxLanes < count) unit *= kBoxLanes;
  const std::size_t half = (count + unit - 1) / unit / 2 * unit;
  Box spread;
  for (std::size_t n = 0; n < count; ++n) spread.extend(centres[items[n]]);
  int axis = 0;
  (void)spread.sizes().maxCoeff(&axis);
  std::nth_element(items, items + half, items + count, [&](std::int32_t a, std::int32_t b) {
    const double x = centres[a][axis], y = centres[b][axis];
    return x < y || (x == y && a < b);
  });
  parallelForBlocks(2, count > kAlone ? 1 : 2, [&](std::size_t begin, std::size_t end) {
    if (begin == 0) orderInSpace(centres, items, half);
    if (end == 2) orderInSpace(centres, items + half, count - half);
  });
}

struct BoxBounds {
  std::array<float, 3> lower, upper;
};

void put(const BoxBounds& bounds, BoxBlock& block, std::size_t lane) {
  for (int a = 0; a < 3; ++a) {
    block.lower[a][lane] = bounds.lower[a];
    block.upper[a][lane] = bounds.upper[a];
  }
}

BoxBounds boundsOf(const BoxBlock& block) {
  BoxBounds bounds;
  for (int a = 0; a < 3; ++a) {
    bounds.lower[a] = *std::min_element(block.lower[a], block.lower[a] + kBoxLanes);
    bounds.upper[a] = *std::max_element(block.upper[a], block.upper[a] + kBoxLanes);
  }
  return bounds;
}

/// Blocks for `count` things; lanes beyond them repeat the last.
template <class BoundsAt>
std::vector<BoxBlock> levelOf(std::size_t count, const BoundsAt& boundsAt) {
  std::vector<BoxBlock> level((count + kBoxLanes - 1) / kBoxLanes);
  parallelFor(level.size(), 256, [&](std::size_t b) {
    for (std::size_t lane = 0; lane < kBoxLanes; ++lane) {
      put(boundsAt(std::min(kBoxLanes * b + lane, count - 1)), level[b], lane);
    }
  });
  return level;
}

/// A block that waits, and how near its things may be.
struct Pending {
  float squared;
  std::int32_t level, block;
};

/// Lanes of a block that may be near enough, the nearest last.
struct NearLanes {
  std::array<float, kBoxLanes> squared;
  std::array<std::int32_t, kBoxLanes> lane;
  std::size_t count = 0;

  NearLanes(const BoxBlock& block, std::size_t lanes, const NearQuery& query, float limit) {
    alignas(64) std::array<float, kBoxLanes> all;
    squaredDistances(block, query, all.data());
    for (std::size_t n = 0; n < std::min(lanes, kBoxLanes); ++n) {
      if (all[n] > limit) continue;
      std::size_t place = count++;
      for (; place > 0 && squared[place - 1] < all[n]; --place) {
        squared[place] = squared[place - 1];
        lane[place] = lane[place - 1];
      }
      squared[place] = all[n];
      lane[place] = static_cast<std::int32_t>(n);
    }
  }
};

/// The query in the boxes' frame and unit, as far as single precision tells it.
NearQuery queryAt(const Point& fromOrigin) {
  constexpr double kFarthest = 1e15;  // from there on boxes seem nearer than they are
  NearQuery query;
  for (int a = 0; a < 3; ++a) {
    const auto at = static_cast<float>(std::clamp(fromOrigin[a], -kFarthest, kFarthest));
    const float room = kBoxRounding * (1 + std::abs(at));
    query.low[a] = at - room;
    query.high[a] = at + room;
  }
  return query;
}

}  // namespace

Point closestPointOnTriangle(const Point& q, const Point& a, const Point& b, const Point& c) {
  // Which of the triangle's seven Voronoi regions q projects into, by barycentric signs.
  const Vector ab = b - a, ac = c - a;
  const Vector aq = q - a;
  const double d1 = ab.dot(aq), d2 = ac.dot(aq);
  if (d1 <= 0 && d2 <= 0) return a;
  const Vector bq = q - b;
  const double d3 = ab.dot(bq), d4 = ac.dot(bq);
  if (d3 >= 0 && d4 <= d3) return b;
  const Vector cq = q - c;
  const double d5 = ab.dot(cq), d6 = ac.dot(cq);
  if (d6 >= 0 && d5 <= d6) return c;
  const double weightC = d1 * d4 - d3 * d2;
  if (weightC <= 0 && d1 >= 0 && d3 <= 0) return a + ab * (d1 / (d1 - d3));
  const double weightB = d5 * d2 - d1 * d6;
  if (weightB <= 0 && d2 >= 0 && d6 <= 0) return a + ac * (d2 / (d2 - d6));
  const double weightA = d3 * d6 - d5 * d4;
  if (weightA <= 0 && d4 >= d3 && d5 >= d6) {
    return b + (c - b) * ((d4 - d3) / ((d4 - d3) + (d5 - d6)));
  }
  const double sum = weightA + weightB + weightC;
  return a + ab * (weightB / sum) + ac * (weightC / sum);
}

std::vector<std::int32_t> faceOfEachVertex(const TriangleMesh& mesh) {
  std::vector<std::int32_t> faces(static_cast<std::size_t>(mesh.vertexCount()), 0);
  for (Eigen::Index f = 0; f < mesh.faceCount(); ++f) {
    for (int k = 0; k < 3; ++k) faces[mesh.faces(f, k)] = static_cast<std::int32_t>(f);
  }
  return faces;
}

FaceTree::FaceTree(TriangleMesh mesh) : mesh_(std::move(mesh)) {
  const auto count = static_cast<std::size_t>(mesh_.faceCount());
  if (count == 0) return;
  Box all;
  std::vector<Point> centres(count);
  for (std::size_t f = 0; f < count; ++f) {
    Box box;
    for (int k = 0; k < 3; ++k) box.extend(mesh_.corner(static_cast<Eigen::Index>(f), k));
    centres[f] = box.center();
    all.extend(box);
  }
  origin_ = all.center();
  const double half = all.sizes().maxCoeff() / 2;
  if (half > 0 && half < kInfinity) perMm_ = 1 / half;
  items_.resize(count);
  std::iota(items_.begin(), items_.end(), 0);
  orderInSpace(centres, items_.data(), count);
  corners_.resize(count);
  parallelFor(count, [&](std::size_t n) {
    const std::int32_t face = items_[n];
    corners_[n] = {mesh_.corner(face, 0), mesh_.corner(face, 1), mesh_.corner(face, 2)};
  });
  fillLevels();
}

void FaceTree::fillLevels() {
  levels_.push_back(levelOf(items_.size(), [&](std::size_t n) {
    BoxBounds bounds;
    for (int a = 0; a < 3; ++a) {
      const auto [low, high] =
          std::minmax({corners_[n][0][a], corners_[n][1][a], corners_[n][2][a]});
      const auto lower = static_cast<float>((low - origin_[a]) * perMm_);
      const auto upper = static_cast<float>((high - origin_[a]) * perMm_);
      bounds.lower[a] = lower - kBoxRounding * (1 + std::abs(lower));
      bounds.upper[a] = upper + kBoxRounding * (1 + std::abs(upper));
    }
    return bounds;
  }));
  while (levels_.back().size() > 1) {
    const std::vector<BoxBlock>& below = levels_.back();
    levels_.push_back(levelOf(below.size(), [&](std::size_t n) { return boundsOf(below[n]); }));
  }
}

ClosestPoint FaceTree::closestPoint(const Point& query) const {
  return nearerThan({}, query);
}

ClosestPoint FaceTree::closestPoint(const Point& query, std::int32_t near) const {
  const Point point = closestPointOnTriangle(query, mesh_.corner(near, 0), mesh_.corner(near, 1),
                                             mesh_.corner(near, 2));
  return nearerThan({point, near, (point - query).squaredNorm()}, query);
}

ClosestPoint FaceTree::nearerThan(ClosestPoint best, const Point& query) const {
  if (levels_.empty()) return best;
  const NearQuery near = queryAt((query - origin_) * perMm_);
  const auto limitOf = [&] {
    return static_cast<float>(best.squaredDistance * perMm_ * perMm_) * (1 + kSquareRounding);
  };
  const auto look = [&](std::size_t n) {
    const std::int32_t face = items_[n];
    const auto& [a, b, c] = corners_[n];
    const Point point = closestPointOnTriangle(query, a, b, c);
    const double squared = (point - query).squaredNorm();
    if (squared < best.squaredDistance || (squared == best.squaredDistance && face < best.face)) {
      best = {point, face, squared};
      return true;
    }
    return false;
  };
  float limit = limitOf();
  std::array<Pending, kMostLevels * kBoxLanes> stack;
  std::size_t depth = 0;
  stack[depth++] = {0, static_cast<std::int32_t>(levels_.size()) - 1, 0};
  while (depth > 0) {
    const Pending next = stack[--depth];
    if (next.squared > limit) continue;
    const std::size_t first = kBoxLanes * static_cast<std::size_t>(next.block);
    const std::size_t below = next.level == 0 ? items_.size() : levels_[next.level - 1].size();
    const NearLanes lanes(levels_[next.level][next.block], below - first, near, limit);
    if (next.level > 0) {
      for (std::size_t k = 0; k < lanes.count; ++k) {
        stack[depth++] = {lanes.squared[k], next.level - 1,
                          static_cast<std::int32_t>(first) + lanes.lane[k]};
      }
      continue;
    }
    for (std::size_t k = lanes.count; k-- > 0;) {
      if (!(lanes.squared[k] > limit) && look(first + lanes.lane[k])) limit = limitOf();
    }
  }
  return best;
}

}  // namespace explica::geometry
