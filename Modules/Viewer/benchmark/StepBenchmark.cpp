// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Geometry/Fixtures.h"
#include "Explica/IO/SurfaceFile.h"
#include "Explica/Viewer/Session.h"

#include <benchmark/benchmark.h>

#include <chrono>
#include <ctime>
#include <filesystem>
#include <thread>

namespace explica::viewer {
namespace {

using Clock = std::chrono::steady_clock;

/// A whole unfolding as the window runs it, in the session's own thread: milliseconds a step, the
/// start left out; `processor_ms` is that of all threads.
void unfoldWatched(benchmark::State& state, const TriangleMesh& surface, const Point& centre,
                   const Vector& direction, unfolding::Surround surround) {
  Session session(surface);
  Choice choice;
  choice.centre = session.nearestVertex(centre);
  choice.view.direction = direction;
  choice.unfold.unfolder.surround = surround;
  const unfolding::Region region = session.choose(choice).region;
  if (!session.problem().empty()) {
    state.SkipWithError(session.problem().c_str());
    return;
  }
  const auto wait = [] { std::this_thread::sleep_for(std::chrono::microseconds(200)); };
  std::size_t steps = 0;
  double processor = 0;
  for ([[maybe_unused]] auto _ : state) {
    session.run();
    while (session.momentCount() == 0) wait();
    const std::size_t before = session.momentCount();
    const Clock::time_point begin = Clock::now();
    const std::clock_t used = std::clock();
    while (session.activity() == Activity::Running) wait();
    const std::chrono::duration<double> passed = Clock::now() - begin;
    const auto count = static_cast<double>(session.momentCount() - before);
    steps += session.momentCount() - before;
    processor += 1e3 * static_cast<double>(std::clock() - used) / CLOCKS_PER_SEC;
    state.SetIterationTime(passed.count() / count);
    session.reset();
  }
  state.counters["faces"] = static_cast<double>(region.faces.size());
  state.counters["steps"] = static_cast<double>(steps) / static_cast<double>(state.iterations());
  state.counters["processor_ms"] = processor / static_cast<double>(steps);
}

/// 25 mm of fsaverage5's left pial surface, 902 faces, as in Unfolding's table.
void Cortex(benchmark::State& state) {
  const std::filesystem::path file =
      std::filesystem::path(EXPLICA_REAL_DATA) / "fsaverage5" / "pial_left.gii.gz";
  if (!std::filesystem::exists(file)) {
    state.SkipWithError("skipped: no real data");
    return;
  }
  const TriangleMesh surface = io::readSurface(file).mesh;
  constexpr Eigen::Index kVertex = 4530;
  unfoldWatched(state, surface, surface.positions.row(kVertex).transpose(), Vector(-1, 0.2, 0.2),
                static_cast<unfolding::Surround>(state.range(0)));
}
BENCHMARK(Cortex)
    ->ArgName("surround")
    ->Arg(static_cast<int>(unfolding::Surround::Elastic))
    ->Arg(static_cast<int>(unfolding::Surround::None))
    ->Iterations(5)
    ->UseManualTime()
    ->Unit(benchmark::kMillisecond);

/// A side of a folded ball, for a place without real data.
void FoldedBall(benchmark::State& state) {
  unfoldWatched(state, geometry::makeFoldedSphere(5, 50), Point(-50, 0, 0), Vector(-1, 0, 0),
                unfolding::Surround::Elastic);
}
BENCHMARK(FoldedBall)->Iterations(5)->UseManualTime()->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace explica::viewer
