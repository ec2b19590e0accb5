// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Collision/CollisionScene.h"
#include "Explica/Geometry/Fixtures.h"

#include <benchmark/benchmark.h>

#include <cmath>
#include <vector>

namespace explica::collision {
namespace {

/// The upper half of a folded sphere opens: neighbours move nearly alike, folds apart and together.
struct Opening {
  TriangleMesh mesh;
  std::vector<bool> moves;
  Positions motion;
  double edge = 0;

  explicit Opening(int level) : mesh(geometry::makeFoldedSphere(level, 50, 0.35, 9)) {
    moves.resize(static_cast<std::size_t>(mesh.vertexCount()));
    motion = Positions::Zero(mesh.vertexCount(), 3);
    edge = (mesh.corner(0, 0) - mesh.corner(0, 1)).norm();
    for (Eigen::Index v = 0; v < mesh.vertexCount(); ++v) {
      const auto x = mesh.positions.row(v);
      moves[v] = x[2] > 0;
      if (!moves[v]) continue;
      motion.row(v) << 0.5 * edge * std::sin(x[1] / 9), 0.5 * edge * std::cos(x[2] / 7), 2 * edge;
    }
  }
};

void findMeetings(benchmark::State& state) {
  const Opening s(static_cast<int>(state.range(0)));
  const CollisionScene scene(s.mesh, s.moves);
  std::size_t count = 0;
  for ([[maybe_unused]] auto _ : state) {
    const auto meetings = scene.findMeetings(s.mesh.positions, s.motion, 0.25 * s.edge);
    count = meetings.size();
    benchmark::DoNotOptimize(meetings.data());
  }
  state.counters["pairs"] = static_cast<double>(count);
}
BENCHMARK(findMeetings)->DenseRange(4, 7)->Unit(benchmark::kMillisecond)->UseRealTime();

void updateMeetings(benchmark::State& state) {
  Opening s(static_cast<int>(state.range(0)));
  const CollisionScene scene(s.mesh, s.moves);
  const auto meetings = scene.findMeetings(s.mesh.positions, s.motion, 0.25 * s.edge);
  std::vector<std::int32_t> changed;
  for (std::size_t n = 0; n < scene.movingVertices().size(); n += 200) {
    changed.push_back(scene.movingVertices()[n]);
    s.motion.row(changed.back()).setZero();
  }
  for ([[maybe_unused]] auto _ : state) {
    benchmark::DoNotOptimize(
        scene.updateMeetings(meetings, s.mesh.positions, s.motion, 0.25 * s.edge, changed));
  }
  state.counters["changed"] = static_cast<double>(changed.size());
}
BENCHMARK(updateMeetings)->DenseRange(4, 7)->Unit(benchmark::kMillisecond)->UseRealTime();

void safeStep(benchmark::State& state) {
  const Opening s(static_cast<int>(state.range(0)));
  const CollisionScene scene(s.mesh, s.moves);
  const auto meetings = scene.findMeetings(s.mesh.positions, s.motion, 0.25 * s.edge);
  for ([[maybe_unused]] auto _ : state) {
    benchmark::DoNotOptimize(largestSafeStep(scene, meetings, s.mesh.positions, s.motion));
  }
  state.counters["pairs"] = static_cast<double>(meetings.size());
}
BENCHMARK(safeStep)->DenseRange(4, 7)->Unit(benchmark::kMillisecond)->UseRealTime();

}  // namespace
}  // namespace explica::collision
