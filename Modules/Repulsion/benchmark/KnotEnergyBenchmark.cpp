// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
//
// Error beside time of the knot energy's evaluators.  Errors are relative L2, against all pairs, on
// 200 moving vertices, 25 in surfaces of 327,680 faces (the gradient at a vertex does not depend on
// what else moves), in the same run.
//   patches of a pial surface:        --benchmark_filter=Patch
//   whole closed surfaces:            --benchmark_filter=Closed

#include "Explica/Geometry/Fixtures.h"
#include "Explica/Repulsion/AllPairs.h"
#include "Explica/Repulsion/MultipoleTree.h"
#include "Explica/Repulsion/ThesisTree.h"

#include <benchmark/benchmark.h>
#include <Eigen/Geometry>

#include <bit>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
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

}  // namespace
