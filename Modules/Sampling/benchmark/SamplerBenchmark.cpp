// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Sampling/Sampler.h"

#include "Explica/Geometry/Fixtures.h"

#include <benchmark/benchmark.h>

namespace explica::sampling {
namespace {

/// 163,842 vertices at 11 depths and one block of 16 frames on a grid of 100 x 100 x 60.
void blockOfFrames(benchmark::State& state) {
  Grid grid;
  grid.size = {100, 100, 60};
  grid.spacing = {2.2, 2.2, 3.0};
  std::vector<float> frames(Sampler::kFramesAtOnce * grid.voxelCount());
  for (std::size_t v = 0; v < frames.size(); ++v) frames[v] = static_cast<float>(v % 1009);
  const Positions sphere = geometry::makeIcosphere(7, 1.0).positions;
  Positions points(11 * sphere.rows(), 3);
  for (int d = 0; d < 11; ++d) {
    points.middleRows(d * sphere.rows(), sphere.rows()) =
        ((70 + 0.3 * d) * sphere).rowwise() + Eigen::RowVector3d(109, 109, 90);
  }
  const Sampler sampler(grid, points, static_cast<Interpolation>(state.range(0)));
  for (auto _ : state) benchmark::DoNotOptimize(sampler.sample(frames));
  state.SetItemsProcessed(state.iterations() * points.rows() * Sampler::kFramesAtOnce);
}
BENCHMARK(blockOfFrames)->Arg(0)->Arg(1)->Arg(2)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace explica::sampling
