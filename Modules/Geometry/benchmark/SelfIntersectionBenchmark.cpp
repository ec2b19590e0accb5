// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Geometry/FaceTree.h"
#include "Explica/Geometry/Fixtures.h"
#include "Explica/Geometry/SelfIntersection.h"

#include <benchmark/benchmark.h>

namespace explica::geometry {
namespace {

void selfIntersection(benchmark::State& state) {
  const TriangleMesh mesh = makeFoldedSphere(static_cast<int>(state.range(0)), 1.0, 0.5, 9);
  for ([[maybe_unused]] auto _ : state) benchmark::DoNotOptimize(findSelfIntersections(mesh));
  state.counters["faces"] = static_cast<double>(mesh.faceCount());
}
BENCHMARK(selfIntersection)->DenseRange(4, 7)->Unit(benchmark::kMillisecond)->UseRealTime();

void treeBuild(benchmark::State& state) {
  const auto boxes = faceBoxes(makeFoldedSphere(static_cast<int>(state.range(0))));
  for ([[maybe_unused]] auto _ : state) benchmark::DoNotOptimize(BoxTree(boxes));
  state.counters["boxes"] = static_cast<double>(boxes.size());
}
BENCHMARK(treeBuild)->DenseRange(4, 7)->Unit(benchmark::kMillisecond)->UseRealTime();

}  // namespace
}  // namespace explica::geometry
