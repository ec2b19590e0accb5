// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

// Reading and writing volumes as a command does: n^3 voxels, a folded shell of tissue in empty
// space.

#include "Explica/Core/Parallel.h"
#include "Explica/IO/VolumeFile.h"

#include <benchmark/benchmark.h>

#include <cmath>
#include <filesystem>

namespace {

using namespace explica;
namespace fs = std::filesystem;

Grid gridOf(int n) {
  Grid grid;
  grid.size = {n, n, n};
  grid.origin = Point::Constant(-0.5 * n);
  return grid;
}

/// Radius of a voxel over that of a wavy shell.
double radiusRatio(const Grid& grid, std::size_t v) {
  const std::array<int, 3> at = grid.subscripts(v);
  const Point p = grid.toWorld(Vector(at[0], at[1], at[2])) / (0.3 * grid.size[0]);
  const double waves = 0.1 * std::sin(9 * p[0]) * std::sin(11 * p[1]) * std::cos(10 * p[2]);
  return p.norm() + waves;
}

bool inTissue(double ratio) {
  return ratio > 0.9 && ratio < 1.0;
}

Volume<Label> labels(int n) {
  Volume<Label> volume(gridOf(n));
  for (std::size_t v = 0; v < volume.size(); ++v) {
    const double ratio = radiusRatio(volume.grid, v);
    volume[v] = ratio <= 0.9 ? 2 : inTissue(ratio) ? 3 : 0;
  }
  return volume;
}

Volume<float> thickness(int n) {
  Volume<float> volume(gridOf(n));
  for (std::size_t v = 0; v < volume.size(); ++v) {
    const double ratio = radiusRatio(volume.grid, v);
    if (inTissue(ratio))
      volume[v] = static_cast<float>(2.5 + std::sin(0.01 * static_cast<double>(v % 9973)));
  }
  return volume;
}

Volume<Eigen::Vector3f> points(int n) {
  Volume<Eigen::Vector3f> volume(gridOf(n), Eigen::Vector3f::Zero());
  for (std::size_t v = 0; v < volume.size(); ++v) {
    const std::array<int, 3> at = volume.grid.subscripts(v);
    const double ratio = radiusRatio(volume.grid, v);
    if (inTissue(ratio)) {
      volume[v] = (volume.grid.toWorld(Vector(at[0], at[1], at[2])) * (0.9 / ratio)).cast<float>();
    }
  }
  return volume;
}

class Files {
 public:
  Files() : folder_(fs::temp_directory_path() / "explica-io-benchmark") {
    fs::create_directories(folder_);
  }
  ~Files() {
    std::error_code ignored;
    fs::remove_all(folder_, ignored);
  }
  [[nodiscard]] fs::path operator/(const char* name) const { return folder_ / name; }

 private:
  fs::path folder_;
};

template <class T>
void writing(benchmark::State& state, const Volume<T>& volume, const char* name) {
  const Files files;
  for ([[maybe_unused]] auto _ : state) io::writeVolume(files / name, volume);
  state.counters["MB"] = static_cast<double>(fs::file_size(files / name)) / 1e6;
  state.SetBytesProcessed(
      static_cast<std::int64_t>(state.iterations() * volume.size() * sizeof(T)));
}

void writeLabels(benchmark::State& state) {
  writing(state, labels(static_cast<int>(state.range(0))), "a.nii.gz");
}
void writeThickness(benchmark::State& state) {
  writing(state, thickness(static_cast<int>(state.range(0))), "a.nii.gz");
}
void writePoints(benchmark::State& state) {
  writing(state, points(static_cast<int>(state.range(0))), "a.nii.gz");
}

void readLabels(benchmark::State& state, const char* name) {
  const Files files;
  io::writeVolume(files / name, labels(static_cast<int>(state.range(0))));
  for ([[maybe_unused]] auto _ : state) benchmark::DoNotOptimize(io::readLabels(files / name));
}

void readRealLabels(benchmark::State& state, const char* name) {
  const fs::path path = fs::path(EXPLICA_REAL_DATA) / name;
  if (!fs::exists(path)) {
    state.SkipWithError("no real data");
    return;
  }
  for ([[maybe_unused]] auto _ : state) benchmark::DoNotOptimize(io::readLabels(path));
}

void readThickness(benchmark::State& state) {
  const Files files;
  io::writeVolume(files / "a.nii.gz", thickness(static_cast<int>(state.range(0))));
  for ([[maybe_unused]] auto _ : state)
    benchmark::DoNotOptimize(io::readScalars(files / "a.nii.gz"));
}

BENCHMARK(writeLabels)->ArgName("n")->Arg(256)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK(writeThickness)->ArgName("n")->Arg(256)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK(writePoints)->ArgName("n")->Arg(256)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK(readThickness)->ArgName("n")->Arg(256)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK_CAPTURE(readLabels, nii_gz, "a.nii.gz")
    ->ArgName("n")
    ->Arg(256)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();
BENCHMARK_CAPTURE(readLabels, mgz, "a.mgz")
    ->ArgName("n")
    ->Arg(256)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();
BENCHMARK_CAPTURE(readRealLabels, aseg_mgz, "bert_freesurfer/mri/aseg.mgz")
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();
BENCHMARK_CAPTURE(readRealLabels, synthseg_nii_gz, "synthseg_labels/training_seg_09.nii.gz")
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();

}  // namespace
