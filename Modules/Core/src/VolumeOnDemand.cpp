// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Core/VolumeOnDemand.h"

namespace explica {

Volume<Eigen::Vector3f> volumeOf(const VectorsOnDemand& components) {
  const auto& [x, y, z] = components;
  Volume<Eigen::Vector3f> volume(x.grid, {x.elsewhere, y.elsewhere, z.elsewhere});
  constexpr std::size_t kGrain = 1 << 14;  // elements a task
  for (int c = 0; c < 3; ++c) {
    const VolumeOnDemand<float>& values = components[c];
    parallelForBlocks(values.end - values.begin, kGrain, [&](std::size_t begin, std::size_t end) {
      std::vector<float> part(end - begin);
      values.fill(values.begin + begin, part.size(), part.data());
      for (std::size_t v = 0; v < part.size(); ++v) {
        volume.data[values.begin + begin + v][c] = part[v];
      }
    });
  }
  return volume;
}

}  // namespace explica
