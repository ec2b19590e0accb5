// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Blocks.h"

#include "Explica/Core/OrderStatistics.h"
#include "Explica/Core/Parallel.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>

namespace explica::correspondence {

using Tracer = TrajectoryTracer::Field;

Steps stepsOf(const Tracer& tracer) {
  constexpr std::size_t kSamples = 4096;
  constexpr double kSmallSlopes = 0.05;  // share of voxels that may have smaller slopes
  constexpr double kStepsPerVoxel = 4;
  constexpr double kFewest = 64, kMost = 2048;
  const std::size_t n = tracer.node.size();
  std::vector<double> slope;
  for (std::size_t r = 0; r < n; r += 1 + n / kSamples) {
    slope.push_back(tracer.node[r]
                        .head<3>()
                        .matrix()
                        .cast<double>()
                        .cwiseProduct(tracer.inverseSpacing)
                        .norm() *
                    tracer.finest);
  }
  const auto small = nthSmallest(
      slope, static_cast<std::size_t>(kSmallSlopes * static_cast<double>(slope.size())));
  const auto count = static_cast<int>(
      small > 0 ? std::clamp(std::ceil(kStepsPerVoxel / small), kFewest, kMost) : kMost);
  Steps steps;
  steps.count = count;
  steps.of.resize(n);
  parallelFor(n, 1 << 13, [&](std::size_t r) {
    const float u = std::clamp(tracer.node[r][3], 0.0F, 1.0F);
    const int step = std::min(static_cast<int>(u * static_cast<float>(count)), count - 1);
    steps.of[r] = static_cast<std::uint16_t>(step);
  });
  return steps;
}

namespace {

/// Sorts ranks by a key below `keys`, equal ones as they were; returns where each key begins.
template <class KeyOf>
std::vector<std::int32_t> sortBy(std::span<std::int32_t> ranks, std::size_t keys,
                                 const KeyOf& keyOf) {
  std::vector<std::int32_t> start(keys + 1, 0);
  for (const std::int32_t r : ranks) ++start[keyOf(r) + 1];
  for (std::size_t k = 0; k < keys; ++k) start[k + 1] += start[k];
  const std::vector<std::int32_t> before(ranks.begin(), ranks.end());
  std::vector<std::int32_t> cursor(start.begin(), start.end() - 1);
  for (const std::int32_t r : before) ranks[cursor[keyOf(r)]++] = r;
  return start;
}

}  // namespace

Blocks blocksOf(const Tracer& tracer, const Steps& steps) {
  constexpr std::array<int, 3> kSize = {32, 16, 16};  // voxels
  const std::array<int, 3>& size = tracer.annulus.size;
  const int wide = (size[0] + kSize[0] - 1) / kSize[0], high = (size[1] + kSize[1] - 1) / kSize[1];
  const int slabs = (size[2] + kSize[2] - 1) / kSize[2];
  const auto columnOf = [&](std::int32_t r) {
    const std::int32_t row = tracer.placeOf[r] / size[0];
    const std::int32_t i = tracer.placeOf[r] - row * size[0], j = row % size[1];
    return i / kSize[0] + wide * (j / kSize[1]);
  };
  // Ranks are in storage order, so that those of a slab follow each other.
  const auto rankAtSlice = [&](int k) {
    const auto place = static_cast<std::int64_t>(k) * size[0] * size[1];
    const auto& places = tracer.placeOf;
    return std::lower_bound(places.begin(), places.end(), place) - places.begin();
  };
  Blocks blocks;
  blocks.rank.resize(tracer.placeOf.size());
  std::vector<std::vector<Blocks::Range>> bySlab(slabs);
  parallelFor(slabs, 1, [&](std::size_t slab) {
    const int slice = static_cast<int>(slab) * kSize[2];
    const auto begin = static_cast<std::int32_t>(rankAtSlice(slice));
    const auto end = static_cast<std::int32_t>(rankAtSlice(std::min(slice + kSize[2], size[2])));
    const std::span ranks(blocks.rank.data() + begin, blocks.rank.data() + end);
    std::iota(ranks.begin(), ranks.end(), begin);
    sortBy(ranks, steps.count, [&](std::int32_t r) { return steps.of[r]; });
    const std::vector<std::int32_t> start =
        sortBy(ranks, static_cast<std::size_t>(wide) * high, columnOf);
    for (std::size_t column = 0; column + 1 < start.size(); ++column) {
      if (start[column] == start[column + 1]) continue;
      bySlab[slab].push_back({begin + start[column], begin + start[column + 1]});
    }
  });
  for (const auto& ranges : bySlab) {
    blocks.ranges.insert(blocks.ranges.end(), ranges.begin(), ranges.end());
  }
  std::stable_sort(blocks.ranges.begin(), blocks.ranges.end(),
                   [&](const Blocks::Range& one, const Blocks::Range& two) {
                     const auto middleStep = [&](const Blocks::Range& range) {
                       return steps.of[blocks.rank[std::midpoint(range.begin, range.end)]];
                     };
                     return middleStep(one) < middleStep(two);
                   });
  return blocks;
}

std::vector<std::int32_t> orderByValue(const Tracer& tracer, const std::vector<double>& u) {
  const std::size_t n = u.size();
  std::vector<std::uint32_t> key(n), otherKey(n);
  std::vector<std::int32_t> order(n), other(n);
  for (std::size_t k = 0; k < n; ++k) {
    const double value = u[tracer.annulus.numberAt[tracer.placeOf[k]]];
    key[k] = static_cast<std::uint32_t>(std::clamp(value, 0.0, 1.0) * 4294967295.0);
    order[k] = static_cast<std::int32_t>(k);
  }
  for (int shift = 0; shift < 33; shift += 11) {
    std::vector<std::size_t> start(2049, 0);
    for (std::size_t k = 0; k < n; ++k) ++start[(key[k] >> shift & 2047) + 1];
    for (int b = 0; b < 2048; ++b) start[b + 1] += start[b];
    for (std::size_t k = 0; k < n; ++k) {
      const std::size_t to = start[key[k] >> shift & 2047]++;
      otherKey[to] = key[k];
      other[to] = order[k];
    }
    key.swap(otherKey);
    order.swap(other);
  }
  return order;
}

}  // namespace explica::correspondence
