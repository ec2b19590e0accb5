// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Parallel.h"
#include "Explica/Core/Volume.h"

#include <array>
#include <cstddef>
#include <functional>
#include <optional>

namespace explica {

/// A volume whose values are made when they are asked for, so that what exists for some voxels only
/// can be written without an array of the whole grid.
template <class T>
struct VolumeOnDemand {
  Grid grid;
  T elsewhere{};                   ///< of every voxel before `begin` and from `end` on
  std::size_t begin = 0, end = 0;  ///< places in the storage order
  /// Puts voxels [first, first + count) of the storage order; called from several threads.
  std::function<void(std::size_t first, std::size_t count, T* to)> fill;
  std::optional<std::array<T, 2>> range = {};  ///< least and greatest value, where it is known
};

/// Vectors by their components.
using VectorsOnDemand = std::array<VolumeOnDemand<float>, 3>;

/// All values at once.
template <class T>
[[nodiscard]] Volume<T> volumeOf(const VolumeOnDemand<T>& values) {
  constexpr std::size_t kGrain = 1 << 16;  // elements a task
  Volume<T> volume(values.grid, values.elsewhere);
  parallelForBlocks(values.end - values.begin, kGrain, [&](std::size_t begin, std::size_t end) {
    const std::size_t first = values.begin + begin;
    values.fill(first, end - begin, volume.data.data() + first);
  });
  return volume;
}

[[nodiscard]] Volume<Eigen::Vector3f> volumeOf(const VectorsOnDemand& components);

}  // namespace explica
