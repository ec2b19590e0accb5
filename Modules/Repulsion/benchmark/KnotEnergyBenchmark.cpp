// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
//
// Error beside time of the knot energy's evaluators.  Errors are relative L2, against all pairs, on
// 200 moving vertices, 25 in surfaces of 327,680 faces (the gradient at a vertex does not depend on
// what else moves), in the same run.
//   patches of a pial surface:        --benchmark_filter=Patch
//   whole closed surfaces:            --benchmark_filter=Closed
//   ratios of times, within one run:  --benchmark_filter=Ratio

#include "../src/Kernels.h"
#include "Explica/Core/Parallel.h"
#include "Explica/Geometry/Fixtures.h"
#include "Explica/Repulsion/AllPairs.h"
#include "Explica/Repulsion/MultipoleTree.h"
#include "Explica/Repulsion/ThesisTree.h"

#include <benchmark/benchmark.h>
#include <Eigen/Geometry>

#include <array>
#include <bit>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <limits>
#include <map>
#include <string>

namespace {

using namespace explica;
using namespace explica::repulsion;

/// Vertices at which the error is measured.
std::size_t sampleCount(Eigen::Index faces) {
  return faces > 100000 ? 25 : 200;
}

/// FreeSurfer's binary triangles: three bytes of magic, two lines of comment, big-endian numbers.
TriangleMesh readPial() {
  std::ifstream file(std::string(EXPLICA_REAL_DATA) + "/fsaverage5/fs_binary/lh.pial",
                     std::ios::binary);
  const auto number = [&file](int bytes) {
    std::uint32_t value = 0;
    for (; bytes > 0; --bytes) value = value << 8 | static_cast<unsigned char>(file.get());
    return value;
  };
  TriangleMesh mesh;
  if (!file) return mesh;
  number(3);
  std::string line;
  std::getline(file, line);
  std::getline(file, line);
  const std::uint32_t vertices = number(4);
  const std::uint32_t faces = number(4);
  mesh.positions.resize(vertices, 3);
  mesh.faces.resize(faces, 3);
  for (Eigen::Index i = 0; i < mesh.positions.size(); ++i) {
    mesh.positions.data()[i] = std::bit_cast<float>(number(4));
  }
  for (Eigen::Index i = 0; i < mesh.faces.size(); ++i) {
    mesh.faces.data()[i] = static_cast<std::int32_t>(number(4));
  }
  return mesh;
}

struct Scene {
  TriangleMesh mesh;
  std::vector<bool> moves;
  std::int64_t movingFaces = 0;
  std::vector<bool> sampled;
  KnotValue exact;  // of the sampled vertices
};

void finish(Scene& scene) {
  const auto& f = scene.mesh.faces;
  std::vector<std::size_t> moving;
  for (std::size_t v = 0; v < scene.moves.size(); ++v) {
    if (scene.moves[v]) moving.push_back(v);
  }
  for (Eigen::Index i = 0; i < f.rows(); ++i) {
    scene.movingFaces += scene.moves[f(i, 0)] || scene.moves[f(i, 1)] || scene.moves[f(i, 2)];
  }
  scene.sampled.assign(scene.moves.size(), false);
  const std::size_t step = std::max<std::size_t>(1, moving.size() / sampleCount(f.rows()));
  for (std::size_t i = 0; i < moving.size(); i += step) scene.sampled[moving[i]] = true;
  scene.exact = AllPairs(scene.mesh, scene.sampled).evaluate(scene.mesh.positions);
}

/// Patch of fsaverage5's left pial surface after `levels` subdivisions: within 27.5 mm, about 1,500
/// faces of the original, that of the unfolding's first example, a little larger.
const Scene& patch(int levels, double radius) {
  static std::map<std::pair<int, double>, Scene> scenes;
  const std::pair key(levels, radius);
  if (const auto found = scenes.find(key); found != scenes.end()) return found->second;
  Scene& scene = scenes[key];
  scene.mesh = readPial();
  if (scene.mesh.faceCount() == 0) return scene;
  for (int i = 0; i < levels; ++i) scene.mesh = geometry::subdivide(scene.mesh);
  const Point centroid = scene.mesh.positions.colwise().mean().transpose();
  Eigen::Index centre = 0;
  ((scene.mesh.positions.rowwise() - centroid.transpose()) * Vector(-1, 0.2, 0.2))
      .maxCoeff(&centre);
  scene.moves.resize(static_cast<std::size_t>(scene.mesh.vertexCount()));
  for (Eigen::Index v = 0; v < scene.mesh.vertexCount(); ++v) {
    scene.moves[static_cast<std::size_t>(v)] =
        (scene.mesh.positions.row(v) - scene.mesh.positions.row(centre)).norm() < radius;
  }
  finish(scene);
  return scene;
}

const Scene& closed(int levels, bool folded) {
  static std::map<std::pair<int, bool>, Scene> scenes;
  const std::pair key(levels, folded);
  if (const auto found = scenes.find(key); found != scenes.end()) return found->second;
  Scene& scene = scenes[key];
  scene.mesh = folded ? geometry::makeFoldedSphere(levels) : geometry::makeIcosphere(levels);
  scene.moves.assign(static_cast<std::size_t>(scene.mesh.vertexCount()), true);
  finish(scene);
  return scene;
}

/// Relative L2 error of the gradient at the sampled vertices.
double gradientError(const Scene& scene, const KnotValue& found) {
  double difference = 0;
  double size = 0;
  for (std::size_t v = 0; v < scene.sampled.size(); ++v) {
    if (!scene.sampled[v]) continue;
    const auto row = static_cast<Eigen::Index>(v);
    difference += (found.gradient.row(row) - scene.exact.gradient.row(row)).squaredNorm();
    size += scene.exact.gradient.row(row).squaredNorm();
  }
  return std::sqrt(difference / size);
}

template <class Evaluator, class... Options>
double valueError(const Scene& scene, const Options&... options) {
  const KnotValue found =
      Evaluator(scene.mesh, scene.sampled, options...).evaluate(scene.mesh.positions);
  return std::abs(found.value / scene.exact.value - 1);
}

template <class Evaluator, class... Options>
void run(benchmark::State& state, const Scene& scene, const Options&... options) {
  if (scene.mesh.faceCount() == 0) {
    state.SkipWithError("skipped: no real data");
    return;
  }
  const Evaluator evaluator(scene.mesh, scene.moves, options...);
  KnotValue found;
  for ([[maybe_unused]] auto _ : state) found = evaluator.evaluate(scene.mesh.positions);
  state.counters["faces"] = static_cast<double>(scene.mesh.faceCount());
  state.counters["moving"] = static_cast<double>(scene.movingFaces);
  state.counters["s_per_moving"] = benchmark::Counter(
      static_cast<double>(scene.movingFaces),
      benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
  state.counters["gradient_error"] = gradientError(scene, found);
  state.counters["value_error"] = valueError<Evaluator>(scene, options...);
}

void PatchTree(benchmark::State& state) {
  const double radius = static_cast<double>(state.range(1)) / 2;
  run<MultipoleTree>(state, patch(static_cast<int>(state.range(0)), radius));
  state.SetLabel(MultipoleTree::instructionSet());
}
/// Near distance in mean edges; relative error per mille.
void PatchThesisTree(benchmark::State& state) {
  const ThesisTreeOptions options = {static_cast<double>(state.range(0)),
                                     static_cast<double>(state.range(1)) / 1000};
  run<ThesisTree>(state, patch(0, 27.5), options);
}
void ClosedTree(benchmark::State& state) {
  run<MultipoleTree>(state, closed(static_cast<int>(state.range(0)), state.range(1) != 0));
  state.SetLabel(MultipoleTree::instructionSet());
}

/// A plain vectorised sum over all pairs of centroids.
template <class T>
class CentroidPairs {
 public:
  explicit CentroidPairs(const TriangleMesh& mesh)
      : count_(static_cast<std::size_t>(mesh.faceCount()) / kernels::kLanes * kernels::kLanes) {
    for (auto& c : column_) c.resize(count_);
    for (std::size_t i = 0; i < count_; ++i) {
      const auto f = static_cast<Eigen::Index>(i);
      const Point c = (mesh.corner(f, 0) + mesh.corner(f, 1) + mesh.corner(f, 2)) / 3;
      for (int a = 0; a < 3; ++a) column_[a][i] = static_cast<T>(c[a]);
      const Vector cross =
          (mesh.corner(f, 1) - mesh.corner(f, 0)).cross(mesh.corner(f, 2) - mesh.corner(f, 0));
      column_[3][i] = static_cast<T>(cross.norm() / 2);
    }
  }

  void sum() {
    const kernels::CentroidSum<T> columns = {
        column_[0].data(), column_[1].data(), column_[2].data(), column_[3].data(), count_,
        column_[4].data(), column_[5].data(), column_[6].data(), column_[7].data()};
    parallelForBlocks(count_, 256, [&](std::size_t begin, std::size_t end) {
      kernels::sumCentroids(columns, begin, end);
    });
    benchmark::DoNotOptimize(columns.phi);
  }

 private:
  std::size_t count_;
  std::array<std::vector<T>, 8> column_;
};

template <class T>
void ClosedCentroidPairs(benchmark::State& state) {
  const TriangleMesh mesh = geometry::makeIcosphere(static_cast<int>(state.range(0)));
  CentroidPairs<T> pairs(mesh);
  for ([[maybe_unused]] auto _ : state) pairs.sum();
  state.counters["faces"] = static_cast<double>(mesh.faceCount());
}

/// Least of some runs' times in ms.
struct Times {
  double wall = std::numeric_limits<double>::infinity();
  double processor = std::numeric_limits<double>::infinity();  ///< of all threads
};

template <class Work>
Times leastTimes(int runs, const Work& work) {
  Times least;
  for (int run = 0; run < runs; ++run) {
    const auto start = std::chrono::steady_clock::now();
    const std::clock_t used = std::clock();
    work();
    const double processor = 1e3 * static_cast<double>(std::clock() - used) / CLOCKS_PER_SEC;
    const std::chrono::duration<double, std::milli> passed =
        std::chrono::steady_clock::now() - start;
    least.wall = std::min(least.wall, passed.count());
    least.processor = std::min(least.processor, processor);
  }
  return least;
}

Times treeTimes(int runs, const Scene& scene, const MultipoleTreeOptions& options = {}) {
  const MultipoleTree tree(scene.mesh, scene.moves, options);
  return leastTimes(runs,
                    [&] { benchmark::DoNotOptimize(tree.evaluate(scene.mesh.positions).value); });
}

void reportTimes(benchmark::State& state, const std::string& name, const Times& times) {
  state.counters[name + "_ms"] = times.wall;
  state.counters[name + "_processor_ms"] = times.processor;
}

void reportRatio(benchmark::State& state, const std::string& name, const Times& over,
                 const Times& under) {
  state.counters[name] = over.wall / under.wall;
  state.counters[name + "_processor"] = over.processor / under.processor;
}

Scene closedWithoutTruth(int levels, bool folded) {
  Scene scene;
  scene.mesh = folded ? geometry::makeFoldedSphere(levels) : geometry::makeIcosphere(levels);
  scene.moves.assign(static_cast<std::size_t>(scene.mesh.vertexCount()), true);
  return scene;
}

/// The multipole tree against plain sums over all pairs, whole closed surfaces of 81,920 faces.
void RatioToCentroidPairs(benchmark::State& state) {
  const Scene sphere = closed(6, false), foldedSphere = closed(6, true);
  MultipoleTreeOptions options;
  options.opening = 0.55;  // as wide as gradients within 1e-2 allow
  options.nearRatio = 1;
  const auto error = [&](const Scene& scene) {
    const MultipoleTree tree(scene.mesh, scene.moves, options);
    return gradientError(scene, tree.evaluate(scene.mesh.positions));
  };
  for ([[maybe_unused]] auto _ : state) {
    const Times tree = treeTimes(10, sphere, options);
    const Times folded = treeTimes(10, foldedSphere, options);
    state.counters["tree_gradient_error"] = error(sphere);
    state.counters["folded_gradient_error"] = error(foldedSphere);
    CentroidPairs<float> singles(sphere.mesh);
    CentroidPairs<double> doubles(sphere.mesh);
    const Times single = leastTimes(4, [&] { singles.sum(); });
    const Times twice = leastTimes(2, [&] { doubles.sum(); });
    reportTimes(state, "tree", tree);
    reportTimes(state, "folded", folded);
    reportTimes(state, "single", single);
    reportTimes(state, "double", twice);
    reportRatio(state, "single_over_tree", single, tree);
    reportRatio(state, "single_over_folded", single, folded);
    reportRatio(state, "double_over_tree", twice, tree);
    reportRatio(state, "double_over_folded", twice, folded);
  }
}

/// Time of 327,680 faces over that of 20,480.
void RatioOfGrowth(benchmark::State& state) {
  for ([[maybe_unused]] auto _ : state) {
    for (const bool folded : {false, true}) {
      const Times coarse = treeTimes(20, closedWithoutTruth(5, folded));
      const Times fine = treeTimes(6, closedWithoutTruth(7, folded));
      reportRatio(state, folded ? "folded" : "icosphere", fine, coarse);
    }
  }
}

/// The thesis's tree at three options over ours, with the errors of all.
void RatioToThesisTree(benchmark::State& state) {
  const Scene& scene = patch(0, 27.5);
  if (scene.mesh.faceCount() == 0) {
    state.SkipWithError("skipped: no real data");
    return;
  }
  for ([[maybe_unused]] auto _ : state) {
    const Times tree = treeTimes(50, scene);
    reportTimes(state, "tree", tree);
    state.counters["tree_gradient_error"] =
        gradientError(scene, MultipoleTree(scene.mesh, scene.moves).evaluate(scene.mesh.positions));
    state.counters["tree_value_error"] = valueError<MultipoleTree>(scene);
    for (const ThesisTreeOptions& options :
         {ThesisTreeOptions{2, 0.02}, ThesisTreeOptions{}, ThesisTreeOptions{6, 0.002}}) {
      const ThesisTree thesis(scene.mesh, scene.moves, options);
      KnotValue found;
      const Times times = leastTimes(5, [&] { found = thesis.evaluate(scene.mesh.positions); });
      const auto name = "thesis_" + std::to_string(static_cast<int>(options.nearDistance)) + "_" +
                        std::to_string(std::lround(1000 * options.relativeError));
      reportTimes(state, name, times);
      reportRatio(state, name + "_over_tree", times, tree);
      state.counters[name + "_gradient_error"] = gradientError(scene, found);
      state.counters[name + "_value_error"] = valueError<ThesisTree>(scene, options);
    }
  }
}

BENCHMARK(PatchTree)
    ->Args({0, 55})
    ->Args({1, 55})
    ->Args({2, 55})
    ->Args({2, 100})
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime()
    ->UseRealTime();
BENCHMARK(PatchThesisTree)
    ->Args({2, 20})
    ->Args({3, 10})
    ->Args({6, 2})
    ->Iterations(1)
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime()
    ->UseRealTime();
BENCHMARK(ClosedTree)
    ->ArgsProduct({{3, 4, 5, 6, 7}, {0, 1}})
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime()
    ->UseRealTime();
BENCHMARK(ClosedCentroidPairs<float>)
    ->DenseRange(3, 6)
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime()
    ->UseRealTime();
BENCHMARK(ClosedCentroidPairs<double>)
    ->DenseRange(3, 6)
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime()
    ->UseRealTime();
BENCHMARK(RatioToCentroidPairs)
    ->Iterations(1)
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime()
    ->UseRealTime();
BENCHMARK(RatioOfGrowth)
    ->Iterations(1)
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime()
    ->UseRealTime();
BENCHMARK(RatioToThesisTree)
    ->Iterations(1)
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime()
    ->UseRealTime();

}  // namespace
