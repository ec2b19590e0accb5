// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Parallel.h"
#include "Explica/Core/Volume.h"
#include "Explica/Core/VoxelSets.h"

#include <cstdint>
#include <vector>

namespace explica::surface {

using Mask = VoxelSet;

/// 1 where a voxel has one of the labels.
[[nodiscard]] Mask maskOf(const Volume<Label>& volume, const std::vector<Label>& labels);

/// How many numbers below `count` fulfil a condition; asked on several threads.
template <class Condition>
[[nodiscard]] std::int64_t countWhere(std::size_t count, const Condition& condition) {
  constexpr std::size_t kGrain = 1 << 18;  // voxels a task
  return parallelSum(count, kGrain, std::int64_t{0}, [&](std::size_t begin, std::size_t end) {
    std::int64_t found = 0;
    for (std::size_t v = begin; v < end; ++v) found += condition(v);
    return found;
  });
}

/// Voxels that are not 0 and lie on the edge of the image.
[[nodiscard]] std::int64_t countOnEdge(const Mask& mask);

/// Adds the voxels without side that are nearer to `own` than to `other`.
/// @return how many
std::int64_t addNearer(const Mask& unsided, Mask& own, const Mask& other);

}  // namespace explica::surface
