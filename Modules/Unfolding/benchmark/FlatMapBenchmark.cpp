// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
// Distortion of an unfolded patch beside that of its flat parameterisations, on real pial surfaces.
// Counters: visibility, mean |log area ratio|, mean relative area error, mean edge strain, mean
// largest angle change of a face (degrees), faces turned over, pairs of faces that overlap.

#include "FlatMaps.h"

#include "Explica/Geometry/MeshTopology.h"
#include "Explica/Geometry/SelfIntersection.h"
#include "Explica/IO/SurfaceFile.h"
#include "Explica/Unfolding/Distortion.h"
#include "Explica/Unfolding/Region.h"
#include "Explica/Unfolding/Unfold.h"

#include <benchmark/benchmark.h>

#include <filesystem>
#include <map>
#include <numeric>
#include <string>

namespace explica::unfolding {
namespace {

struct Patch {
  const char* file;
  double direction[3];
  double radius;
  double target;
};
constexpr Patch kPatches[] = {
    {"fsaverage5/pial_left.gii.gz", {-1, 0.2, 0.2}, 25, 0.97},
    {"fsaverage5/pial_left.gii.gz", {-1, 0, 0}, 40, 0.99},
    {"s1_pycortex_lh/pia_lh.gii", {-1, 0.2, 0.2}, 20, 0.97},
};

struct Case {
  TriangleMesh mesh;
  Region region;
  visibility::Viewpoints view;
  double target = 1;
};

const Case& caseOf(int n) {
  static std::map<int, Case> cases;
  if (const auto found = cases.find(n); found != cases.end()) return found->second;
  const Patch& patch = kPatches[n];
  Case c;
  c.mesh = io::readSurface(std::filesystem::path(EXPLICA_REAL_DATA) / patch.file).mesh;
  const Vector along(patch.direction[0], patch.direction[1], patch.direction[2]);
  const Point centre = c.mesh.positions.colwise().mean().transpose();
  int farthest = 0;
  (void)((c.mesh.positions.rowwise() - centre.transpose()) * along).maxCoeff(&farthest);
  RegionOptions where;
  where.vertex = farthest;
  where.radius = patch.radius;
  c.region = selectRegion(c.mesh, where);
  Point middle = Point::Zero();
  for (const std::int32_t v : c.region.vertices) middle += c.mesh.positions.row(v).transpose();
  middle /= static_cast<double>(c.region.vertices.size());
  c.view = visibility::viewpoint(middle + 1000 * along.normalized());
  c.target = patch.target;
  return cases[n] = std::move(c);
}

void report(benchmark::State& state, const TriangleMesh& before, const Positions& after) {
  std::vector<std::int32_t> faces(static_cast<std::size_t>(before.faceCount()));
  std::iota(faces.begin(), faces.end(), 0);
  const Distortion d = measureDistortion(before, after, faces);
  state.counters["faces"] = static_cast<double>(faces.size());
  state.counters["log_area"] = d.areaRatio.array().max(1e-12).log().abs().mean();
  state.counters["area_error"] = d.areaErrorMean;
  state.counters["strain"] = d.edgeStrainMean;
  state.counters["angle_deg"] = d.angleErrorMeanRad * 180 / kPi;
  state.counters["overlaps"] =
      static_cast<double>(geometry::findSelfIntersections({after, before.faces}).size());
}

template <class Map>
void flatten(benchmark::State& state, const Map& map) {
  if (!std::filesystem::exists(EXPLICA_REAL_DATA)) return state.SkipWithError("no real data");
  const Case& c = caseOf(static_cast<int>(state.range(0)));
  const TriangleMesh patch = geometry::extractFaces(c.mesh, c.region.faces).mesh;
  Positions flat;
  for ([[maybe_unused]] auto _ : state) flat = map(patch);
  report(state, patch, flat);
  state.counters["flipped"] = static_cast<double>(flippedFaces(flat, patch.faces));
}

void conformal(benchmark::State& state) {
  flatten(state, [](const TriangleMesh& patch) { return leastSquaresConformalMap(patch); });
}
void rigid(benchmark::State& state) {
  flatten(state, [](const TriangleMesh& patch) { return asRigidAsPossibleMap(patch); });
}

void unfolded(benchmark::State& state, Surround surround) {
  if (!std::filesystem::exists(EXPLICA_REAL_DATA)) return state.SkipWithError("no real data");
  const Case& c = caseOf(static_cast<int>(state.range(0)));
  UnfoldOptions options;
  options.unfolder.surround = surround;
  options.targetVisibility = c.target;
  UnfoldResult result;
  for ([[maybe_unused]] auto _ : state) result = unfold(c.mesh, c.region, c.view, options);
  const auto after = geometry::extractFaces(result.mesh, result.region.faces);
  report(state, geometry::extractFaces(c.mesh, c.region.faces).mesh, after.mesh.positions);
  state.counters["visibility"] = result.history.back().visibility;
}

BENCHMARK(conformal)->Name("LSCM")->DenseRange(0, 2)->Iterations(1)->Unit(benchmark::kMillisecond);
BENCHMARK(rigid)->Name("ARAP")->DenseRange(0, 2)->Iterations(1)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(unfolded, none, Surround::None)
    ->Name("Unfolded/none")
    ->DenseRange(0, 2)
    ->Iterations(1)
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(unfolded, fixed, Surround::Fixed)
    ->Name("Unfolded/fixed")
    ->Arg(0)
    ->Iterations(1)
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace explica::unfolding
