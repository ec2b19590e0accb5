// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
// Both methods on both phantoms in one run; the counters say what each reached.

#include "Explica/Planar/PolygonKnotEnergy.h"
#include "Explica/Planar/PolygonPhantoms.h"
#include "Explica/Planar/PolygonUnfolding.h"

#include <benchmark/benchmark.h>

#include <cmath>

namespace explica::planar {
namespace {

enum class Without { Nothing, Length, Topology };

void unfold(benchmark::State& state, const PolygonPhantom& phantom, PolygonMethod method,
            Without without) {
  const Region region = regionBetween(phantom.curve, phantom.first, phantom.last);
  PolygonUnfoldingOptions options;
  options.method = method;
  options.noLength = without == Without::Length;
  options.noTopology = without == Without::Topology;
  PolygonUnfolding result;
  for ([[maybe_unused]] auto _ : state) {
    result = unfoldPolygon(phantom.curve, region, phantom.viewpoint, options);
    benchmark::DoNotOptimize(result.seconds);
  }
  const PolygonIteration& end = result.history.back();
  state.counters["iterations"] = end.iteration;
  state.counters["visibility"] = end.visibility;
  state.counters["variance"] = end.variance;
  state.counters["length"] = end.length;
  state.counters["length_change"] = end.length / result.history.front().length - 1;
  state.counters["first_crossing"] = result.firstCrossing;
  state.counters["topology_share"] = result.secondsTopology / result.seconds;
}

void knot(benchmark::State& state, PolygonKnot method) {
  const int n = static_cast<int>(state.range(0));
  Curve ring;
  ring.positions.resize(n, 2);
  for (int v = 0; v < n; ++v) {
    const double a = 2 * kPi * v / n;
    const double r = 50 + 12 * std::sin(9 * a);
    ring.positions.row(v) << r * std::cos(a), r * std::sin(a);
  }
  const std::vector<bool> moving(n, true);
  const auto exact =
      PolygonKnotEnergy(PolygonKnot::AllPairs, ring, moving).evaluate(ring.positions);
  const auto energy = PolygonKnotEnergy(method, ring, moving);
  PolygonKnotValue value;
  for ([[maybe_unused]] auto _ : state) {
    value = energy.evaluate(ring.positions);
    benchmark::DoNotOptimize(value.value);
  }
  state.counters["gradient_error"] =
      (value.gradient - exact.gradient).norm() / exact.gradient.norm();
}

BENCHMARK_CAPTURE(unfold, polygon19_implicit, makePolygon19(), PolygonMethod::Implicit,
                  Without::Nothing)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(unfold, polygon34_implicit, makePolygon34(), PolygonMethod::Implicit,
                  Without::Nothing)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(unfold, polygon34_no_length, makePolygon34(), PolygonMethod::Implicit,
                  Without::Length)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(unfold, polygon34_no_topology, makePolygon34(), PolygonMethod::Implicit,
                  Without::Topology)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(unfold, polygon19_thesis, makePolygon19(), PolygonMethod::Thesis,
                  Without::Nothing)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(unfold, polygon34_thesis, makePolygon34(), PolygonMethod::Thesis,
                  Without::Nothing)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(unfold, polygon34_no_length_thesis, makePolygon34(), PolygonMethod::Thesis,
                  Without::Length)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(knot, all_pairs, PolygonKnot::AllPairs)->RangeMultiplier(4)->Range(128, 2048);
BENCHMARK_CAPTURE(knot, tree, PolygonKnot::Tree)->RangeMultiplier(4)->Range(128, 2048);

}  // namespace
}  // namespace explica::planar
