// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "AdjacentChunks.h"

#include "Explica/Core/Parallel.h"
#include "Explica/Repulsion/PairIntegral.h"
#include "Kernels.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <numeric>

namespace explica::repulsion {
namespace {

constexpr std::size_t kChunk = 512;  // pairs

template <class T>
std::int32_t indexIn(const std::vector<T>& sorted, const T& value) {
  return static_cast<std::int32_t>(std::lower_bound(sorted.begin(), sorted.end(), value) -
                                   sorted.begin());
}

template <class T>
void sortUnique(std::vector<T>& values) {
  std::sort(values.begin(), values.end());
  values.erase(std::unique(values.begin(), values.end()), values.end());
}

}  // namespace

struct AdjacentChunks::EdgeKind {
  using Batch = kernels::EdgeBatch;
  static constexpr int kArms = 3;
  static constexpr std::array<int, 3> kCornersT = {0, 1, 3};
  static void choose(const Batch& batch, std::int32_t* rules) {
    kernels::chooseEdgeRules(batch, rules);
  }
  static void integrate(Batch& batch, int rule) { kernels::integrateEdge(batch, rule); }
  static PairIntegral exactly(const Corners& s, const Corners& t) {
    return integrateEdgeSharing(s, t);
  }
};

struct AdjacentChunks::VertexKind {
  using Batch = kernels::VertexBatch;
  static constexpr int kArms = 4;
  static constexpr std::array<int, 3> kCornersT = {0, 3, 4};
  static void choose(const Batch& batch, std::int32_t* rules) {
    kernels::chooseVertexRules(batch, rules);
  }
  static void integrate(Batch& batch, int rule) { kernels::integrateVertex(batch, rule); }
  static PairIntegral exactly(const Corners& s, const Corners& t) {
    return integrateVertexSharing(s, t);
  }
};

AdjacentChunks::AdjacentChunks(const MovingSet& set, const std::vector<std::int32_t>& rank) {
  std::vector<std::int32_t> involved(static_cast<std::size_t>(set.faces.rows()), -1);
  for (std::size_t i = 0; i < set.involved.size(); ++i) {
    involved[set.involved[i]] = static_cast<std::int32_t>(i);
  }
  edgeChunks_ = cut(set, set.edgePairs, rank, involved, true);
  vertexChunks_ = cut(set, set.vertexPairs, rank, involved, false);

  placesBegin_.assign(set.vertexMoves.size() + 1, 0);
  const auto forEachPlace = [this](const auto& body) {
    std::int32_t number = 0;
    for (const auto* chunks : {&edgeChunks_, &vertexChunks_}) {
      for (const Chunk& chunk : *chunks) {
        for (std::size_t v = 0; v < chunk.vertices.size(); ++v) {
          body(chunk.vertices[v], Place{number, static_cast<std::int32_t>(v)});
        }
        ++number;
      }
    }
  };
  forEachPlace([this](std::int32_t v, Place) { ++placesBegin_[v + 1]; });
  for (std::size_t v = 1; v < placesBegin_.size(); ++v) placesBegin_[v] += placesBegin_[v - 1];
  places_.resize(placesBegin_.back());
  std::vector<std::size_t> next(placesBegin_.begin(), placesBegin_.end() - 1);
  forEachPlace([&](std::int32_t v, Place place) { places_[next[v]++] = place; });
}

std::vector<AdjacentChunks::Chunk> AdjacentChunks::cut(const MovingSet& set,
                                                       const std::vector<AdjacentPair>& pairs,
                                                       const std::vector<std::int32_t>& rank,
                                                       const std::vector<std::int32_t>& involved,
                                                       bool edges) {
  std::vector<std::int32_t> sorted(pairs.size());
  std::iota(sorted.begin(), sorted.end(), 0);
  std::stable_sort(sorted.begin(), sorted.end(), [&](std::int32_t l, std::int32_t r) {
    return rank[pairs[l].s] < rank[pairs[r].s];
  });
  std::vector<Chunk> chunks((pairs.size() + kChunk - 1) / kChunk);
  parallelFor(chunks.size(), 1, [&](std::size_t c) {
    Chunk& chunk = chunks[c];
    const std::size_t begin = c * kChunk;
    const std::size_t end = std::min(begin + kChunk, sorted.size());
    std::vector<std::int32_t> faces;
    for (std::size_t i = begin; i < end; ++i) {
      const AdjacentPair& pair = pairs[sorted[i]];
      faces.insert(faces.end(), {pair.s, pair.t});
      chunk.vertices.insert(chunk.vertices.end(), pair.cornersS.begin(), pair.cornersS.end());
      chunk.vertices.insert(chunk.vertices.end(), pair.cornersT.begin(), pair.cornersT.end());
    }
    sortUnique(faces);
    sortUnique(chunk.vertices);
    for (const std::int32_t f : faces) {
      chunk.areas.push_back(involved[f]);
      chunk.faces.push_back({indexIn(chunk.vertices, set.faces(f, 0)),
                             indexIn(chunk.vertices, set.faces(f, 1)),
                             indexIn(chunk.vertices, set.faces(f, 2))});
    }
    for (std::size_t i = begin; i < end; ++i) {
      const AdjacentPair& p = pairs[sorted[i]];
      const auto corners = edges ? std::array{p.cornersS[0], p.cornersS[1], p.cornersS[2],
                                              p.cornersT[2], p.cornersT[2]}
                                 : std::array{p.cornersS[0], p.cornersS[1], p.cornersS[2],
                                              p.cornersT[1], p.cornersT[2]};
      Pair pair{};
      for (std::size_t k = 0; k < corners.size(); ++k) {
        pair.vertex[k] = indexIn(chunk.vertices, corners[k]);
      }
      pair.s = indexIn(faces, p.s);
      pair.t = indexIn(faces, p.t);
      chunk.pairs.push_back(pair);
    }
  });
  return chunks;
}

/// Adds up one chunk's pairs: sixteen at once where they need the same rule.
template <class Kind>
class AdjacentChunks::Adder {
 public:
  Adder(const Chunk& chunk, const Positions& positions, const std::vector<FaceArea>& areas,
        double unit, Sum& sum)
      : chunk_(chunk), areas_(areas), inverseUnit_(1 / unit), sum_(sum), x_(sum.positions) {
    x_.resize(chunk.vertices.size());
    for (std::size_t v = 0; v < x_.size(); ++v) {
      x_[v] = positions.row(chunk.vertices[v]).transpose();
    }
    sum_.value = 0;
    sum_.gradient.assign(x_.size(), Vector::Zero());
    sum_.byArea.assign(chunk.faces.size(), 0.0);
  }

  void run() {
    for (std::size_t begin = 0; begin < chunk_.pairs.size(); begin += kLanes) takeBatch(begin);
    for (int rule = 0; rule < kernels::kRules; ++rule) flush(rule);
    addAreas();
  }

 private:
  static constexpr int kArms = Kind::kArms;
  static constexpr int kRows = 3 * kArms;
  static constexpr int kLanes = kernels::kLanes;
  using Batch = typename Kind::Batch;
  using Pairs = std::array<const Pair*, kLanes>;

  /// Pairs that wait until sixteen need the same rule.
  struct Waiting {
    Batch batch;
    Pairs pair{};
    int filled = 0;
  };

  [[nodiscard]] const FaceArea& areaOf(std::int32_t face) const {
    return areas_[chunk_.areas[face]];
  }

  /// Arms of up to sixteen pairs from `begin` on; the last one fills what is left.
  void load(std::size_t begin, int count, Batch& batch) const {
    for (int lane = 0; lane < kLanes; ++lane) {
      const auto& v =
          chunk_.pairs[begin + static_cast<std::size_t>(std::min(lane, count - 1))].vertex;
      for (int k = 0; k < kArms; ++k) {
        for (int a = 0; a < 3; ++a) {
          batch.arm[3 * k + a][lane] =
              static_cast<float>((x_[v[k + 1]][a] - x_[v[0]][a]) * inverseUnit_);
        }
      }
    }
  }

  void takeBatch(std::size_t begin) {
    const int count = static_cast<int>(std::min<std::size_t>(kLanes, chunk_.pairs.size() - begin));
    Batch batch;
    load(begin, count, batch);
    std::array<std::int32_t, kLanes> rules;
    Kind::choose(batch, rules.data());
    if (rules[0] < kernels::kRules &&
        std::all_of(rules.begin(), rules.end(), [&](std::int32_t r) { return r == rules[0]; })) {
      Kind::integrate(batch, rules[0]);
      Pairs pairs{};
      for (int lane = 0; lane < count; ++lane) {
        pairs[lane] = &chunk_.pairs[begin + static_cast<std::size_t>(lane)];
      }
      add(batch, pairs, count);
      return;
    }
    for (int lane = 0; lane < count; ++lane) {
      const Pair& pair = chunk_.pairs[begin + static_cast<std::size_t>(lane)];
      rules[lane] == kernels::kRules ? addExactly(pair) : await(pair, batch, lane, rules[lane]);
    }
  }

  void addExactly(const Pair& pair) {
    const auto& v = pair.vertex;
    const auto& t = Kind::kCornersT;
    const PairIntegral exact =
        Kind::exactly({x_[v[0]], x_[v[1]], x_[v[2]]}, {x_[v[t[0]]], x_[v[t[1]]], x_[v[t[2]]]});
    sum_.value += 2 * exact.value;
    for (int k = 0; k < 3; ++k) {
      sum_.gradient[v[k]] += 2 * exact.byS[k];
      sum_.gradient[v[t[k]]] += 2 * exact.byT[k];
    }
  }

  void await(const Pair& pair, const Batch& batch, int lane, int rule) {
    Waiting& w = waiting_[rule];
    for (int row = 0; row < kRows; ++row) w.batch.arm[row][w.filled] = batch.arm[row][lane];
    w.pair[w.filled++] = &pair;
    if (w.filled == kLanes) flush(rule);
  }

  void flush(int rule) {
    Waiting& w = waiting_[rule];
    if (w.filled == 0) return;
    for (auto& row : w.batch.arm) std::fill(row + w.filled, row + kLanes, row[0]);
    Kind::integrate(w.batch, rule);
    add(w.batch, w.pair, w.filled);
    w.filled = 0;
  }

  /// Adds what a batch of means contributes; its derivatives are used up.
  void add(Batch& batch, const Pairs& pairs, int count) {
    std::array<float, kLanes> factor{};
    for (int lane = 0; lane < count; ++lane) factor[lane] = addValue(batch, *pairs[lane], lane);
    for (int row = 0; row < kRows; ++row) {
      for (int lane = 0; lane < kLanes; ++lane) batch.byArm[row][lane] *= factor[lane];
    }
    float common[3][kLanes];  // by the corner from which the arms are seen
    for (int a = 0; a < 3; ++a) {
      for (int lane = 0; lane < kLanes; ++lane) common[a][lane] = -batch.byArm[a][lane];
      for (int row = 3 + a; row < kRows; row += 3) {
        for (int lane = 0; lane < kLanes; ++lane) common[a][lane] -= batch.byArm[row][lane];
      }
    }
    for (int lane = 0; lane < count; ++lane) {
      const auto& vertex = pairs[lane]->vertex;
      Vector& first = sum_.gradient[vertex[0]];
      for (int a = 0; a < 3; ++a) first[a] += common[a][lane];
      for (int arm = 0; arm < kArms; ++arm) {
        Vector& by = sum_.gradient[vertex[arm + 1]];
        for (int a = 0; a < 3; ++a) by[a] += batch.byArm[3 * arm + a][lane];
      }
    }
  }

  /// Value and derivatives by the areas of one lane; what its derivatives by arms are scaled by.
  float addValue(const Batch& batch, const Pair& pair, int lane) {
    const double mean = 2 * inverseUnit_ * inverseUnit_ * batch.value[lane];
    const double areaS = areaOf(pair.s).area;
    const double areaT = areaOf(pair.t).area;
    sum_.value += areaS * areaT * mean;
    sum_.byArea[pair.s] += areaT * mean;
    sum_.byArea[pair.t] += areaS * mean;
    return static_cast<float>(2 * areaS * areaT * (inverseUnit_ * inverseUnit_ * inverseUnit_));
  }

  void addAreas() {
    for (std::size_t f = 0; f < chunk_.faces.size(); ++f) {
      const auto& v = chunk_.faces[f];
      const Corners corners = {x_[v[0]], x_[v[1]], x_[v[2]]};
      const Vector scaled = sum_.byArea[f] * areaOf(static_cast<std::int32_t>(f)).normal;
      for (int k = 0; k < 3; ++k) sum_.gradient[v[k]] += areaByCorner(scaled, corners, k);
    }
  }

  const Chunk& chunk_;
  const std::vector<FaceArea>& areas_;
  double inverseUnit_;
  Sum& sum_;
  std::vector<Point>& x_;
  std::array<Waiting, kernels::kRules> waiting_;
};

void AdjacentChunks::add(const Positions& positions, const std::vector<FaceArea>& areas,
                         double unit, std::vector<Sum>& sums, double& value,
                         Positions& gradient) const {
  const std::size_t edges = edgeChunks_.size();
  sums.resize(edges + vertexChunks_.size());
  parallelFor(sums.size(), 1, [&](std::size_t c) {
    if (c < edges) {
      Adder<EdgeKind>(edgeChunks_[c], positions, areas, unit, sums[c]).run();
    } else {
      Adder<VertexKind>(vertexChunks_[c - edges], positions, areas, unit, sums[c]).run();
    }
  });
  for (const Sum& sum : sums) value += sum.value;
  parallelFor(placesBegin_.size() - 1, 4096, [&](std::size_t v) {
    for (std::size_t i = placesBegin_[v]; i < placesBegin_[v + 1]; ++i) {
      gradient.row(static_cast<Eigen::Index>(v)) +=
          sums[places_[i].chunk].gradient[places_[i].vertex].transpose();
    }
  });
}

}  // namespace explica::repulsion
