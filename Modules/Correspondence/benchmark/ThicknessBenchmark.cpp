// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
// Error beside time: methods and lambda on the spheroids, size, bandwidth, and a plain solver.
#include "Explica/Core/Parallel.h"
#include "Explica/Correspondence/Correspondence.h"
#include "Explica/Correspondence/Sulci.h"
#include "Explica/Harmonic/Phantoms.h"
#include "Explica/IO/VolumeFile.h"

#include <benchmark/benchmark.h>
#include <sys/resource.h>

#include <cmath>
#include <ctime>
#include <filesystem>

using namespace explica;
using namespace explica::correspondence;

namespace {

struct Solved {
  harmonic::ExactAnnulus exact;
  harmonic::Annulus annulus;
  harmonic::Interpolant interpolant;
};

/// Confocal spheroids of 128^3 at 1 mm, from level sets.
const Solved& spheroids() {
  static const Solved solved = [] {
    const auto phantom = harmonic::makePhantom(harmonic::PhantomKind::Spheroid, {128, 1});
    Solved s;
    s.exact = phantom.exact;
    s.annulus = harmonic::annulusFromLevels(phantom.innerLevel, phantom.outerLevel,
                                            {0, harmonic::LevelInside::Below});
    s.interpolant = harmonic::solveInterpolant(s.annulus);
    return s;
  }();
  return solved;
}

void measure(benchmark::State& state, const CorrespondenceOptions& options) {
  const Solved& s = spheroids();
  Correspondence found;
  for ([[maybe_unused]] auto _ : state)
    found = findCorrespondences(s.annulus, s.interpolant, options);
  double point = 0, worst = 0, thickness = 0;
  for (std::int32_t n = 0; n < static_cast<std::int32_t>(s.annulus.count()); ++n) {
    const Point x = s.annulus.world(n);
    const auto answer = s.exact.answer(x);
    const double inner = (x + found.innerPoint[n].cast<double>() - answer.innerPoint).norm();
    const double outer = (x + found.outerPoint[n].cast<double>() - answer.outerPoint).norm();
    point += 0.5 * (inner + outer);
    worst = std::max({worst, inner, outer});
    thickness += std::abs(found.thickness(n) - answer.thickness());
  }
  const auto count = static_cast<double>(s.annulus.count());
  state.counters["point_mean"] = point / count;
  state.counters["point_max"] = worst;
  state.counters["thickness_mean"] = thickness / count;
}

void Lagrangian(benchmark::State& state) {
  CorrespondenceOptions options;
  options.method = Method::Lagrangian;
  measure(state, options);
}
void Eulerian(benchmark::State& state) {
  CorrespondenceOptions options;
  options.method = Method::Eulerian;
  measure(state, options);
}
/// Argument: lambda in hundredths of a millimetre; negative is infinity.
void Hybrid(benchmark::State& state) {
  CorrespondenceOptions options;
  options.lambda = state.range(0) < 0 ? kInfinity : 0.01 * static_cast<double>(state.range(0));
  measure(state, options);
}
void AppendixA(benchmark::State& state) {
  CorrespondenceOptions options;
  options.method = Method::AppendixA;
  options.lambda = state.range(0) < 0 ? kInfinity : 0.01 * static_cast<double>(state.range(0));
  measure(state, options);
}
BENCHMARK(Lagrangian)->Unit(benchmark::kMillisecond);
BENCHMARK(Eulerian)->Unit(benchmark::kMillisecond);
BENCHMARK(AppendixA)->Arg(50)->Unit(benchmark::kMillisecond);
BENCHMARK(Hybrid)->Arg(0)->Arg(1)->Arg(10)->Arg(50)->Arg(100)->Arg(200)->Arg(-1)->Unit(
    benchmark::kMillisecond);

/// Processor time of each phase over all threads, ms: the same on a busy machine.
class Phases {
 public:
  explicit Phases(benchmark::State& state) : state_(state) {}
  void done(const char* phase) {
    const std::clock_t now = std::clock();
    state_.counters[phase] += 1000.0 * static_cast<double>(now - last_) / CLOCKS_PER_SEC;
    last_ = now;
  }

 private:
  benchmark::State& state_;
  std::clock_t last_ = std::clock();
};

/// All fields of the tissue between labels; returns its voxels.
std::size_t measureAll(benchmark::State& state, const Volume<Label>& labels,
                       const harmonic::LabelRoles& roles, bool sulci) {
  Phases phases(state);
  auto annulus = harmonic::annulusFromLabels(labels, roles);
  phases.done("boundary_ms");
  if (sulci) {
    annulus = recoverSulci(annulus).annulus;
    phases.done("sulci_ms");
  }
  const auto interpolant = harmonic::solveInterpolant(annulus);
  phases.done("harmonic_ms");
  const auto found = findCorrespondences(annulus, interpolant);
  phases.done("correspondence_ms");
  benchmark::DoNotOptimize(found.innerDistance.data());
  return annulus.count();
}

/// Settings of what takes seconds.
void once(benchmark::internal::Benchmark* settings) {
  settings->UseRealTime()->MeasureProcessCPUTime()->Unit(benchmark::kMillisecond)->Iterations(1);
}

/// A shell whose radii are these shares of the size.
Volume<Label> shellLabels(int size, double inner, double outer) {
  const auto exact = harmonic::exactShell(size * inner, size * outer);
  const Grid grid = harmonic::centredGrid({size, size, size}, Vector::Ones());
  Volume<Label> labels(grid, 0);
  parallelFor(grid.voxelCount(), 1 << 14, [&](std::size_t v) {
    const auto s = grid.subscripts(v);
    const Point x = grid.toWorld(Vector(s[0], s[1], s[2]));
    labels[v] = exact.innerLevel(x) <= 0 ? 1 : exact.outerLevel(x) < 0 ? 2 : 0;
  });
  return labels;
}

/// All fields of a shell (radii 2/9 and 1/3 of the size) from labels; argument: voxels a side.
void Shell(benchmark::State& state) {
  const Volume<Label> labels = shellLabels(static_cast<int>(state.range(0)), 2.0 / 9, 1.0 / 3);
  std::size_t voxels = 0;
  for ([[maybe_unused]] auto _ : state)
    voxels = measureAll(state, labels, {{1}, {2}, {}, {}}, false);
  state.counters["voxels"] = static_cast<double>(voxels);
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);  // of the process so far: sizes ascend
  state.counters["peak_MB"] = static_cast<double>(usage.ru_maxrss) / 1024;
}
BENCHMARK(Shell)->Arg(124)->Arg(240)->Arg(480)->Apply(once);

/// The left ribbon of a real brain, all fields with buried sulci.
void Ribbon(benchmark::State& state) {
  const auto path = std::filesystem::path(EXPLICA_REAL_DATA) / "bert_freesurfer/mri/ribbon.mgz";
  if (!std::filesystem::exists(path)) {
    state.SkipWithError("skipped: no real data");
    return;
  }
  const auto labels = io::readLabels(path).volume;
  for ([[maybe_unused]] auto _ : state) measureAll(state, labels, {{2}, {3}, {}, {}}, true);
}
BENCHMARK(Ribbon)->Apply(once);

/// a = b + 3 c over 3 x 80 MB: the machine's bandwidth.
void Triad(benchmark::State& state) {
  const std::size_t n = 10'000'000;
  std::vector<double> a(n, 0), b(n, 1), c(n, 2);
  for ([[maybe_unused]] auto _ : state) {
    parallelForBlocks(n, 1 << 16, [&](std::size_t begin, std::size_t end) {
      for (std::size_t k = begin; k < end; ++k) a[k] = b[k] + 3 * c[k];
    });
    benchmark::ClobberMemory();
  }
  state.counters["bytes_per_s"] = benchmark::Counter(24.0 * static_cast<double>(n),
                                                     benchmark::Counter::kIsIterationInvariantRate);
}
BENCHMARK(Triad)->UseRealTime()->Unit(benchmark::kMillisecond);

/// One V-cycle on a shell of 1.8 million tissue voxels.
void Cycle(benchmark::State& state) {
  const auto exact = harmonic::exactShell(57, 85);
  const Grid grid = harmonic::centredGrid({176, 176, 176}, Vector::Ones());
  const auto annulus = harmonic::annulusFromLevels(harmonic::sampled(grid, exact.innerLevel),
                                                   harmonic::sampled(grid, exact.outerLevel),
                                                   {0, harmonic::LevelInside::Below});
  harmonic::Multigrid multigrid(annulus);
  std::vector<float> r(annulus.count(), 1), e;
  for ([[maybe_unused]] auto _ : state) multigrid.cycle(r, e);
}
BENCHMARK(Cycle)->UseRealTime()->Unit(benchmark::kMillisecond);

/// Confocal spheroids 128 mm wide; argument: voxels a side.
Volume<Label> spheroidLabels(benchmark::State& state) {
  const int size = static_cast<int>(state.range(0));
  return harmonic::makePhantom(harmonic::PhantomKind::Spheroid, {size, 128.0 / size}).labels;
}

/// Reference: staircase boundary, Jacobi-preconditioned conjugate gradients to our residual, then
/// Yezzi-Prince sweeps for both lengths in storage order until nothing changes.
/// @param links  per unknown its neighbours' numbers or what lies there
void solvePlainly(const std::vector<std::array<std::int32_t, 6>>& links,
                  const std::vector<std::uint8_t>& isTissue) {
  const std::size_t n = links.size();
  constexpr std::size_t kGrain = 1 << 13;
  std::vector<double> u(n, 0), r(n, 0), p, q(n, 0);
  parallelFor(n, kGrain, [&](std::size_t k) {
    if (!isTissue[k]) return;
    for (const auto link : links[k]) r[k] += link == harmonic::kOuter;
  });
  p = r;
  const auto dot = [&](const std::vector<double>& a, const std::vector<double>& b) {
    return parallelSum(n, kGrain, 0.0, [&](std::size_t begin, std::size_t end) {
      double sum = 0;
      for (std::size_t k = begin; k < end; ++k) sum += a[k] * b[k];
      return sum;
    });
  };
  double rr = dot(r, r);
  const double stop = 1e-18 * rr;  // isotropic: the diagonal is constant
  while (rr > stop) {
    parallelFor(n, kGrain, [&](std::size_t k) {
      if (!isTissue[k]) return;
      q[k] = 6 * p[k];
      for (const auto link : links[k]) q[k] -= link >= 0 ? p[link] : 0;
    });
    const double alpha = rr / dot(p, q);
    parallelFor(n, kGrain, [&](std::size_t k) {
      u[k] += alpha * p[k];
      r[k] -= alpha * q[k];
    });
    const double next = dot(r, r);
    parallelFor(n, kGrain, [&](std::size_t k) { p[k] = r[k] + next / rr * p[k]; });
    rr = next;
  }
  const auto value = [&](std::int32_t link) {
    return link >= 0 ? u[link] : link == harmonic::kOuter ? 1.0 : 0.0;
  };
  for (const bool inner : {true, false}) {
    std::vector<double> length(n, 0);
    for (double change = 1; change > 1e-6;) {
      change = 0;
      for (std::size_t k = 0; k < n; ++k) {
        if (!isTissue[k]) continue;
        double sum = 0, weighted = 0, squared = 0;
        for (int a = 0; a < 3; ++a) {
          const double slope = value(links[k][2 * a + 1]) - value(links[k][2 * a]);
          const auto link = links[k][2 * a + ((slope > 0) == inner ? 0 : 1)];
          squared += slope * slope;
          sum += std::abs(slope);
          if (link >= 0) weighted += std::abs(slope) * length[link];
        }
        const double found = (std::sqrt(squared) + weighted) / sum;
        change = std::max(change, std::abs(found - length[k]));
        length[k] = found;
      }
    }
    benchmark::DoNotOptimize(length.data());
  }
}

/// The reference on our compact tissue.
void PlainCompact(benchmark::State& state) {
  harmonic::AnnulusOptions options;
  options.boundary = harmonic::BoundaryModel::Staircase;
  const auto labels = spheroidLabels(state);
  for ([[maybe_unused]] auto _ : state) {
    const auto annulus = harmonic::annulusFromLabels(labels, {{1}, {2}, {}, {}}, options);
    solvePlainly(annulus.links, std::vector<std::uint8_t>(annulus.count(), 1));
  }
}

/// The reference on arrays of the whole grid, as plain tools have them.
void PlainGrid(benchmark::State& state) {
  const auto labels = spheroidLabels(state);
  for ([[maybe_unused]] auto _ : state) {
    const int size = labels.grid.size[0];
    std::vector<std::array<std::int32_t, 6>> links(labels.size());
    std::vector<std::uint8_t> isTissue(labels.size());
    const std::array<std::int32_t, 3> strides = {1, size, size * size};
    parallelFor(labels.size(), 1 << 13, [&](std::size_t v) {
      isTissue[v] = labels[v] == 2;
      if (!isTissue[v]) return;
      for (int d = 0; d < 6; ++d) {
        const auto w =
            static_cast<std::int32_t>(v) + harmonic::signOf(d) * strides[harmonic::axisOf(d)];
        links[v][d] = labels[w] == 2 ? w : labels[w] == 1 ? harmonic::kInner : harmonic::kOuter;
      }
    });
    solvePlainly(links, isTissue);
  }
}

/// Ours on the same labels: sub-voxel boundary, boundary points and lengths.
void Ours(benchmark::State& state) {
  const auto labels = spheroidLabels(state);
  for ([[maybe_unused]] auto _ : state) measureAll(state, labels, {{1}, {2}, {}, {}}, false);
}
BENCHMARK(Ours)->Arg(128)->Arg(256)->Apply(once);
BENCHMARK(PlainCompact)->Arg(128)->Arg(256)->Apply(once);
BENCHMARK(PlainGrid)->Arg(128)->Arg(256)->Apply(once);

}  // namespace
