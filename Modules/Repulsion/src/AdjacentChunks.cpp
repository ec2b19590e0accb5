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

template <class Kind>
void AdjacentChunks::sumUp(const Chunk& chunk, const Positions& positions,
                           const std::vector<FaceArea>& allAreas, double unit, Sum& sum) {
  constexpr int kArms = Kind::kArms;
  constexpr int kLanes = kernels::kLanes;
  std::vector<Point>& x = sum.positions;
  x.resize(chunk.vertices.size());
  for (std::size_t v = 0; v < x.size(); ++v) x[v] = positions.row(chunk.vertices[v]).transpose();
  const auto areaOf = [&](std::int32_t face) -> const FaceArea& {
    return allAreas[chunk.areas[face]];
  };
  const double inverseUnit = 1 / unit;
  sum.value = 0;
  sum.gradient.assign(x.size(), Vector::Zero());
  std::vector<double>& byArea = sum.byArea;
  byArea.assign(chunk.faces.size(), 0.0);

  // Adds what a batch of means contributes; its derivatives are used up.
  const auto add = [&](typename Kind::Batch& batch, const std::array<const Pair*, kLanes>& pairs,
                       int count) {
    constexpr int kRows = 3 * kArms;
    std::array<float, kLanes> factor{};
    for (int lane = 0; lane < count; ++lane) {
      const Pair& pair = *pairs[lane];
      const double mean = 2 * inverseUnit * inverseUnit * batch.value[lane];
      const double areaS = areaOf(pair.s).area;
      const double areaT = areaOf(pair.t).area;
      sum.value += areaS * areaT * mean;
      byArea[pair.s] += areaT * mean;
      byArea[pair.t] += areaS * mean;
      factor[lane] =
          static_cast<float>(2 * areaS * areaT * (inverseUnit * inverseUnit * inverseUnit));
    }
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
      Vector& first = sum.gradient[vertex[0]];
      for (int a = 0; a < 3; ++a) first[a] += common[a][lane];
      for (int arm = 0; arm < kArms; ++arm) {
        Vector& by = sum.gradient[vertex[arm + 1]];
        for (int a = 0; a < 3; ++a) by[a] += batch.byArm[3 * arm + a][lane];
      }
    }
  };

  // Pairs that wait until sixteen need the same rule.
  struct Waiting {
    typename Kind::Batch batch;
    std::array<const Pair*, kLanes> pair{};
    int filled = 0;
  };
  std::array<Waiting, kernels::kRules> waiting;

  const auto flush = [&](int rule) {
    Waiting& w = waiting[rule];
    if (w.filled == 0) return;
    for (auto& row : w.batch.arm) std::fill(row + w.filled, row + kLanes, row[0]);
    Kind::integrate(w.batch, rule);
    add(w.batch, w.pair, w.filled);
    w.filled = 0;
  };

  for (std::size_t begin = 0; begin < chunk.pairs.size(); begin += kLanes) {
    const int count = static_cast<int>(std::min<std::size_t>(kLanes, chunk.pairs.size() - begin));
    typename Kind::Batch batch;
    for (int lane = 0; lane < kLanes; ++lane) {
      const auto& v =
          chunk.pairs[begin + static_cast<std::size_t>(std::min(lane, count - 1))].vertex;
      for (int k = 0; k < kArms; ++k) {
        for (int a = 0; a < 3; ++a) {
          batch.arm[3 * k + a][lane] =
              static_cast<float>((x[v[k + 1]][a] - x[v[0]][a]) * inverseUnit);
        }
      }
    }
    std::array<std::int32_t, kLanes> rules;
    Kind::choose(batch, rules.data());
    if (rules[0] < kernels::kRules &&
        std::all_of(rules.begin(), rules.end(), [&](std::int32_t r) { return r == rules[0]; })) {
      Kind::integrate(batch, rules[0]);
      std::array<const Pair*, kLanes> batchPairs{};
      for (int lane = 0; lane < count; ++lane) {
        batchPairs[lane] = &chunk.pairs[begin + static_cast<std::size_t>(lane)];
      }
      add(batch, batchPairs, count);
      continue;
    }
    for (int lane = 0; lane < count; ++lane) {
      const Pair& pair = chunk.pairs[begin + static_cast<std::size_t>(lane)];
      const int rule = rules[lane];
      if (rule == kernels::kRules) {
        const auto& v = pair.vertex;
        const auto& t = Kind::kCornersT;
        const PairIntegral exact =
            Kind::exactly({x[v[0]], x[v[1]], x[v[2]]}, {x[v[t[0]]], x[v[t[1]]], x[v[t[2]]]});
        sum.value += 2 * exact.value;
        for (int k = 0; k < 3; ++k) {
          sum.gradient[v[k]] += 2 * exact.byS[k];
          sum.gradient[v[t[k]]] += 2 * exact.byT[k];
        }
        continue;
      }
      Waiting& w = waiting[rule];
      for (int row = 0; row < 3 * kArms; ++row) w.batch.arm[row][w.filled] = batch.arm[row][lane];
      w.pair[w.filled++] = &pair;
      if (w.filled == kLanes) flush(rule);
    }
  }
  for (int rule = 0; rule < kernels::kRules; ++rule) flush(rule);

  for (std::size_t f = 0; f < chunk.faces.size(); ++f) {
    const auto& v = chunk.faces[f];
    const Corners corners = {x[v[0]], x[v[1]], x[v[2]]};
    const Vector scaled = byArea[f] * areaOf(static_cast<std::int32_t>(f)).normal;
    for (int k = 0; k < 3; ++k) sum.gradient[v[k]] += areaByCorner(scaled, corners, k);
  }
}

void AdjacentChunks::add(const Positions& positions, const std::vector<FaceArea>& areas,
                         double unit, std::vector<Sum>& sums, double& value,
                         Positions& gradient) const {
  const std::size_t edges = edgeChunks_.size();
  sums.resize(edges + vertexChunks_.size());
  parallelFor(sums.size(), 1, [&](std::size_t c) {
    if (c < edges) {
      sumUp<EdgeKind>(edgeChunks_[c], positions, areas, unit, sums[c]);
    } else {
      sumUp<VertexKind>(vertexChunks_[c - edges], positions, areas, unit, sums[c]);
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
