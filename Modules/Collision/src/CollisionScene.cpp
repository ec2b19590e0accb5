// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Collision/CollisionScene.h"

#include "MeetingKernels.h"

#include "Explica/Core/Errors.h"
#include "Explica/Core/Parallel.h"
#include "Explica/Geometry/BoundsSearch.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <bit>
#include <cmath>
#include <iterator>
#include <memory>
#include <utility>

namespace explica::collision {
namespace {

using geometry::BlockPair;
using geometry::BoundsPyramid;
using geometry::BoundsSearch;
using geometry::MotionBounds;

Edges edgesOf(const Faces& faces) {
  // Those of each vertex that is the smaller end, together: few, which are then put in order.
  const auto forSides = [&](const auto& visit) {
    for (Eigen::Index f = 0; f < faces.rows(); ++f) {
      for (int k = 0; k < 3; ++k) {
        const std::int32_t a = faces(f, k), b = faces(f, (k + 1) % 3);
        visit(std::min(a, b), std::max(a, b));
      }
    }
  };
  const std::size_t vertices = faces.size() == 0 ? 0 : std::size_t(faces.maxCoeff()) + 1;
  std::vector<std::size_t> begin(vertices + 1, 0);
  forSides([&](std::int32_t a, std::int32_t /*b*/) { ++begin[a + 1]; });
  for (std::size_t v = 0; v < vertices; ++v) begin[v + 1] += begin[v];
  std::vector<std::int32_t> ends(begin.back());
  std::vector<std::size_t> next(begin.begin(), begin.end() - 1);
  forSides([&](std::int32_t a, std::int32_t b) { ends[next[a]++] = b; });
  Edges edges(static_cast<Eigen::Index>(ends.size()), 2);
  Eigen::Index count = 0;
  for (std::size_t v = 0; v < vertices; ++v) {
    const auto from = ends.begin() + static_cast<std::ptrdiff_t>(begin[v]);
    const auto to = ends.begin() + static_cast<std::ptrdiff_t>(begin[v + 1]);
    std::sort(from, to);
    for (auto end = from; end != to; ++end) {
      if (end == from || *end != *(end - 1))
        edges.row(count++) << static_cast<std::int32_t>(v), *end;
    }
  }
  edges.conservativeResize(count, 2);
  return edges;
}

/// Collects pairs, tests eight at a time and keeps those that come within reach.
class MeetingFilter {
 public:
  MeetingFilter(const CollisionScene& scene, PairKind kind, const Positions& start,
                const Positions& motion, double reach)
      : scene_(scene), kind_(kind), start_(start), motion_(motion), reach_(reach) {}

  void add(std::int32_t first, std::int32_t second) {
    pairs_[count_] = {kind_, first, second};
    const std::array<std::int32_t, 4> v = scene_.vertices(pairs_[count_]);
    const bool apart = kind_ == PairKind::VertexFace
                           ? v[0] != v[1] && v[0] != v[2] && v[0] != v[3]
                           : v[0] != v[2] && v[0] != v[3] && v[1] != v[2] && v[1] != v[3];
    if (!apart) return;
    for (int i = 0; i < 3; ++i) {
      for (int k = 0; k < 3; ++k) {
        batch_.at[i][k][count_] = start_(v[i + 1], k) - start_(v[0], k);
        batch_.motion[i][k][count_] = motion_(v[i + 1], k) - motion_(v[0], k);
      }
    }
    if (++count_ == kernels::PairBatch::kLanes) test();
  }

  [[nodiscard]] std::vector<Meeting> take() {
    if (count_ > 0) test();
    return std::move(kept_);
  }

 private:
  void test() {
    if (kind_ == PairKind::VertexFace) {
      kernels::separateVertexFace(batch_);
    } else {
      kernels::separateEdgeEdge(batch_);
    }
    for (int n = 0; n < count_; ++n) {
      const double separation = batch_.separation[n], closing = batch_.closing[n];
      const bool far = separation - std::max(0.0, closing) > reach_;  // not so if not a number
      if (!far) kept_.push_back({pairs_[n], separation, closing});
    }
    count_ = 0;
  }

  const CollisionScene& scene_;
  PairKind kind_;
  const Positions& start_;
  const Positions& motion_;
  double reach_;
  kernels::PairBatch batch_ = {};
  std::array<Pair, kernels::PairBatch::kLanes> pairs_;
  int count_ = 0;
  std::vector<Meeting> kept_;
};

/// By kind, first and second: a pass that counts, in about as many bins, and what few share one.
void sortMeetings(std::vector<Meeting>& meetings, std::size_t firstCount) {
  const int shift = std::bit_width(firstCount / (meetings.size() + 1));
  const std::size_t bins = (firstCount >> shift) + 1;
  std::vector<std::size_t> begin(2 * bins + 1, 0);
  const auto bin = [&](const Meeting& m) {
    return (static_cast<std::size_t>(m.pair.first) >> shift) +
           (m.pair.kind == PairKind::VertexFace ? 0 : bins);
  };
  for (const Meeting& m : meetings) ++begin[bin(m) + 1];
  for (std::size_t n = 1; n < begin.size(); ++n) begin[n] += begin[n - 1];
  std::vector<Meeting> sorted(meetings.size());
  std::vector<std::size_t> at(begin.begin(), begin.end() - 1);
  for (const Meeting& m : meetings) sorted[at[bin(m)]++] = m;
  for (std::size_t n = 0; n + 1 < begin.size(); ++n) {
    if (begin[n + 1] - begin[n] < 2) continue;
    std::sort(sorted.begin() + static_cast<std::ptrdiff_t>(begin[n]),
              sorted.begin() + static_cast<std::ptrdiff_t>(begin[n + 1]),
              [](const Meeting& a, const Meeting& b) { return a.pair < b.pair; });
  }
  meetings = std::move(sorted);
}

}  // namespace

/// Vertices, edges or faces with a search tree.
struct CollisionScene::Features {
  std::vector<std::int32_t> items;
  BoundsPyramid pyramid;
};

struct CollisionScene::Surroundings {
  Features vertices, edges, faces;
};

CollisionScene::CollisionScene(const TriangleMesh& mesh, const std::vector<bool>& vertexMoves)
    : faces_(mesh.faces), edges_(edgesOf(mesh.faces)) {
  if (static_cast<Eigen::Index>(vertexMoves.size()) != mesh.vertexCount()) {
    throw InvalidInput("vertexMoves: " + std::to_string(vertexMoves.size()) + " flags for " +
                       std::to_string(mesh.vertexCount()) + " vertices");
  }
  std::array<std::vector<std::int32_t>, 3> standing;
  std::vector<bool> used(vertexMoves.size(), false);
  for (Eigen::Index n = 0; n < faces_.size(); ++n) used[faces_.data()[n]] = true;
  Eigen::AlignedBox3d box;
  for (std::int32_t v = 0; v < static_cast<std::int32_t>(used.size()); ++v) {
    if (!used[v]) continue;
    (vertexMoves[v] ? movingVertices_ : standing[0]).push_back(v);
    if (vertexMoves[v]) box.extend(Point(mesh.positions.row(v).transpose()));
  }
  if (!box.isEmpty()) origin_ = box.center();
  for (std::int32_t e = 0; e < edges_.rows(); ++e) {
    const bool moves = vertexMoves[edges_(e, 0)] || vertexMoves[edges_(e, 1)];
    (moves ? movingEdges_ : standing[1]).push_back(e);
  }
  for (std::int32_t f = 0; f < faces_.rows(); ++f) {
    const bool moves =
        vertexMoves[faces_(f, 0)] || vertexMoves[faces_(f, 1)] || vertexMoves[faces_(f, 2)];
    (moves ? movingFaces_ : standing[2]).push_back(f);
  }
  auto [vertices, edges, faces] =
      featuresOf(std::move(standing), mesh.positions, Positions::Zero(mesh.vertexCount(), 3));
  fixed_ =
      std::make_shared<const Surroundings>(std::move(vertices), std::move(edges), std::move(faces));
}

std::array<std::int32_t, 4> CollisionScene::vertices(const Pair& pair) const {
  if (pair.kind == PairKind::VertexFace) {
    return {pair.first, faces_(pair.second, 0), faces_(pair.second, 1), faces_(pair.second, 2)};
  }
  return {edges_(pair.first, 0), edges_(pair.first, 1), edges_(pair.second, 0),
          edges_(pair.second, 1)};
}

FourPoints CollisionScene::points(const Pair& pair, const Positions& positions) const {
  const auto v = vertices(pair);
  FourPoints x;
  for (int i = 0; i < 4; ++i) x[i] = positions.row(v[i]).transpose();
  return x;
}

std::array<CollisionScene::Features, 3> CollisionScene::featuresOf(
    std::array<std::vector<std::int32_t>, 3> items, const Positions& start,
    const Positions& motion) const {
  std::vector<char> asked(static_cast<std::size_t>(start.rows()), 0);
  for (const std::int32_t v : items[0]) asked[v] = 1;
  for (const std::int32_t e : items[1]) asked[edges_(e, 0)] = asked[edges_(e, 1)] = 1;
  for (const std::int32_t f : items[2]) {
    for (int k = 0; k < 3; ++k) asked[faces_(f, k)] = 1;
  }
  const auto at = std::make_unique_for_overwrite<MotionBounds[]>(asked.size());
  parallelFor(asked.size(), [&](std::size_t n) {
    if (asked[n] == 0) return;
    const auto v = static_cast<Eigen::Index>(n);
    at[n] = MotionBounds::ofPoint(start.row(v).transpose() - origin_, motion.row(v).transpose());
  });
  const auto pyramidOf = [&](const std::vector<std::int32_t>& list, const auto& rowOf) {
    std::vector<MotionBounds> bounds(list.size());
    parallelFor(list.size(), [&](std::size_t n) {
      const auto row = rowOf(list[n]);
      bounds[n] = at[row[0]];
      for (Eigen::Index k = 1; k < row.size(); ++k) bounds[n].extend(at[row[k]]);
    });
    return BoundsPyramid(bounds);
  };
  std::array<Features, 3> features;
  parallelFor(3, 1, [&](std::size_t n) {
    features[n].pyramid =
        n == 0
            ? pyramidOf(items[0], [](std::int32_t v) { return Eigen::Vector<std::int32_t, 1>(v); })
        : n == 1 ? pyramidOf(items[1], [&](std::int32_t e) { return edges_.row(e); })
                 : pyramidOf(items[2], [&](std::int32_t f) { return faces_.row(f); });
    features[n].items = std::move(items[n]);
  });
  return features;
}

/// Features of two lists, and flags of those in the lists that another query finds.
struct CollisionScene::Query {
  PairKind kind;
  const Features* first;
  const Features* second;
  const std::vector<char>* skipFirst = nullptr;
  const std::vector<char>* skipSecond = nullptr;
};

std::vector<Meeting> CollisionScene::answer(std::span<const Query> queries, const Positions& start,
                                            const Positions& motion, double reach) const {
  double size = 0;  // of the numbers that are rounded
  for (const std::int32_t v : movingVertices_) {
    size = std::max(size, (start.row(v).transpose() - origin_).lpNorm<Eigen::Infinity>() +
                              motion.row(v).lpNorm<Eigen::Infinity>());
  }
  size = std::exp2(std::ceil(std::log2(size + reach)));  // most motions of a start have the same
  constexpr double kSingle = 2e-6, kDouble = 1e-13;      // some roundings of that size
  const auto boundsReach = static_cast<float>(reach + kSingle * size);
  const float squaredReach = boundsReach * boundsReach * (1 + 1e-6F);

  struct Task {
    const Query* query;
    BoundsSearch search;
    BlockPair from;
  };
  std::vector<Task> tasks;
  for (const Query& query : queries) {
    const BoundsSearch search{&query.first->pyramid, &query.second->pyramid, squaredReach};
    for (const BlockPair& pair : blocksToShareOut(search)) tasks.push_back({&query, search, pair});
  }
  std::vector<std::vector<Meeting>> found(tasks.size());
  parallelFor(tasks.size(), 4, [&](std::size_t n) {
    const Query& query = *tasks[n].query;
    MeetingFilter filter(*this, query.kind, start, motion, reach + kDouble * size);
    visitItems(tasks[n].search, tasks[n].from, [&](std::int32_t i, std::int32_t j) {
      const std::int32_t first = query.first->items[i], second = query.second->items[j];
      if (query.skipFirst != nullptr && (*query.skipFirst)[first] != 0) return;
      if (query.skipSecond != nullptr && (*query.skipSecond)[second] != 0) return;
      if (query.kind == PairKind::VertexFace) {
        filter.add(first, second);
      } else {
        filter.add(std::min(first, second), std::max(first, second));
      }
    });
    found[n] = filter.take();
  });
  std::vector<Meeting> all;
  std::size_t count = 0;
  for (const auto& part : found) count += part.size();
  all.reserve(count);
  for (const auto& part : found) all.insert(all.end(), part.begin(), part.end());
  sortMeetings(all, static_cast<std::size_t>(std::max<Eigen::Index>(start.rows(), edges_.rows())));
  return all;
}

std::vector<Meeting> CollisionScene::findMeetings(const Positions& start, const Positions& motion,
                                                  double reach) const {
  const auto moving = featuresOf({movingVertices_, movingEdges_, movingFaces_}, start, motion);
  const Features &vertices = moving[0], &edges = moving[1], &faces = moving[2];
  const std::array<Query, 5> queries = {{{PairKind::VertexFace, &vertices, &faces},
                                         {PairKind::VertexFace, &vertices, &fixed_->faces},
                                         {PairKind::VertexFace, &fixed_->vertices, &faces},
                                         {PairKind::EdgeEdge, &edges, &edges},
                                         {PairKind::EdgeEdge, &edges, &fixed_->edges}}};
  return answer(queries, start, motion, reach);
}

std::vector<Meeting> CollisionScene::updateMeetings(std::span<const Meeting> known,
                                                    const Positions& start, const Positions& motion,
                                                    double reach,
                                                    std::span<const std::int32_t> changed) const {
  std::vector<char> vertexChanged(static_cast<std::size_t>(start.rows()), 0);
  for (const std::int32_t v : changed) vertexChanged[v] = 1;
  std::vector<std::int32_t> changedEdges, changedFaces;
  std::vector<char> edgeChanged(static_cast<std::size_t>(edges_.rows()), 0);
  for (const std::int32_t e : movingEdges_) {
    if (vertexChanged[edges_(e, 0)] == 0 && vertexChanged[edges_(e, 1)] == 0) continue;
    edgeChanged[e] = 1;
    changedEdges.push_back(e);
  }
  for (const std::int32_t f : movingFaces_) {
    if (vertexChanged[faces_(f, 0)] + vertexChanged[faces_(f, 1)] + vertexChanged[faces_(f, 2)] > 0)
      changedFaces.push_back(f);
  }
  const auto moving = featuresOf({movingVertices_, movingEdges_, movingFaces_}, start, motion);
  std::array<std::vector<std::int32_t>, 3> items;
  items[0].assign(changed.begin(), changed.end());
  items[1] = std::move(changedEdges);
  items[2] = std::move(changedFaces);
  const auto own = featuresOf(std::move(items), start, motion);
  const std::array<Query, 7> queries = {
      {{PairKind::VertexFace, &own[0], &moving[2]},
       {PairKind::VertexFace, &own[0], &fixed_->faces},
       {PairKind::VertexFace, &moving[0], &own[2], &vertexChanged},
       {PairKind::VertexFace, &fixed_->vertices, &own[2]},
       {PairKind::EdgeEdge, &own[1], &own[1]},
       {PairKind::EdgeEdge, &own[1], &moving[1], nullptr, &edgeChanged},
       {PairKind::EdgeEdge, &own[1], &fixed_->edges}}};
  const std::vector<Meeting> found = answer(queries, start, motion, reach);
  std::vector<Meeting> kept;
  kept.reserve(known.size());
  std::ranges::copy_if(known, std::back_inserter(kept), [&](const Meeting& m) {
    const auto v = vertices(m.pair);
    return vertexChanged[v[0]] + vertexChanged[v[1]] + vertexChanged[v[2]] + vertexChanged[v[3]] ==
           0;
  });
  std::vector<Meeting> all(kept.size() + found.size());
  std::merge(kept.begin(), kept.end(), found.begin(), found.end(), all.begin(),
             [](const Meeting& a, const Meeting& b) { return a.pair < b.pair; });
  return all;
}

std::vector<Pair> CollisionScene::findPairs(const Positions& start, const Positions& motion,
                                            double reach) const {
  return pairsOf(findMeetings(start, motion, reach));
}

std::vector<Pair> pairsOf(std::span<const Meeting> meetings) {
  std::vector<Pair> pairs(meetings.size());
  std::ranges::transform(meetings, pairs.begin(), &Meeting::pair);
  return pairs;
}

double largestSafeStep(const CollisionScene& scene, std::span<const Meeting> meetings,
                       const Positions& start, const Positions& motion, double limit,
                       const AdvanceOptions& options) {
  constexpr std::size_t kGrain = 512;  // elements a task
  constexpr double kRoundDown = 1 - 1e-9;
  std::vector<double> safe((meetings.size() + kGrain - 1) / kGrain, limit);
  parallelForBlocks(meetings.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    double& least = safe[begin / kGrain];
    for (const Meeting& m : meetings.subspan(begin, end - begin)) {
      const double room = kRoundDown * (m.separation - options.gap(m.separation));
      if (room > 0 && least * m.closing <= room) continue;
      least = std::min(least, safeTime(m.pair.kind, scene.points(m.pair, start),
                                       scene.points(m.pair, motion), least, options));
    }
  });
  for (const double t : safe) limit = std::min(limit, t);
  return limit;
}

}  // namespace explica::collision
