// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Field.h"

#include <cstdint>
#include <span>
#include <vector>

namespace explica::correspondence {

/// Tissue in steps of u: those of one step do not depend on each other.
struct Steps {
  std::size_t count = 0;
  std::vector<std::uint16_t> of;  ///< per rank
};

/// Steps so small that nearly everywhere the first grid face upwind lies in an earlier one: its
/// corners differ from the voxel by 1/sqrt(3) voxel of the slope or more.
[[nodiscard]] Steps stepsOf(const TrajectoryTracer::Field& tracer);

/// Tissue in blocks of space, the blocks and the ranks of each in the order of steps.  What a
/// trajectory reads on its way to the first grid face lies in its block or beside it: a block's
/// share of every array fits into a processor's own cache.
struct Blocks {
  struct Range {
    std::int32_t begin = 0, end = 0;  ///< in `rank`
  };
  std::vector<std::int32_t> rank;  ///< of one block after the other in space
  std::vector<Range> ranges;       ///< per block

  [[nodiscard]] std::span<const std::int32_t> of(std::size_t block) const {
    const Range& range = ranges[block];
    return {rank.data() + range.begin, rank.data() + range.end};
  }
};

[[nodiscard]] Blocks blocksOf(const TrajectoryTracer::Field& tracer, const Steps& steps);

/// Ranks by ascending u (radix sort of 32-bit fixed point; equal values by rank).
[[nodiscard]] std::vector<std::int32_t> orderByValue(const TrajectoryTracer::Field& tracer,
                                                     const std::vector<double>& u);

}  // namespace explica::correspondence
