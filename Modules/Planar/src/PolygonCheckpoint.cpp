// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Core/StateFile.h"
#include "Explica/Planar/PolygonUnfolding.h"

namespace explica::planar {
namespace {

constexpr char kMagic[] = "ExplicaPolygon2\n";  // the number counts changes of the format

template <class Access, class State>
void visitState(const Access& access, State& state) {
  access(state.positions);
  access(state.region.firstEdge);
  access(state.region.edgeCount);
}

/// One list for writing and reading.
template <class Access, class Run>
void visitRun(const Access& access, Run& run) {
  access(run.input);
  access(run.inputRegion.firstEdge);
  access(run.inputRegion.edgeCount);
  access.size(run.view.points);
  for (auto& point : run.view.points) access(point);
  access(run.view.weights);
  access(run.method);
  visitState(access, run.posed);
  access(run.methodState.damping);
  access(run.methodState.tension);
  access(run.verticesMerged);
  access(run.firstCrossing);
  access.size(run.history);
  for (auto& row : run.history) {
    access(row.iteration);
    for (auto* number : {&row.visibility, &row.variance, &row.length, &row.lengthError,
                         &row.leastDistance, &row.knotEnergy, &row.step, &row.seconds}) {
      access(*number);
    }
  }
  access.size(run.path);
  for (auto& state : run.path) visitState(access, state);
}

/// Whether the region is one of the polygon's.
bool isWhole(const PolygonState& state) {
  const Eigen::Index n = state.positions.rows();
  return n >= 2 && state.region.edgeCount >= 1 && state.region.edgeCount <= n &&
         state.region.firstEdge >= 0 && state.region.firstEdge < n;
}

}  // namespace

void writeCheckpoint(const std::filesystem::path& path, const PolygonCheckpoint& checkpoint) {
  StateWriter file;
  visitRun(StateWriting{file}, checkpoint);
  file.commit(path, kMagic);
}

PolygonCheckpoint readCheckpoint(const std::filesystem::path& path) {
  StateReader file(path, kMagic, "an unfolding");
  PolygonCheckpoint checkpoint;
  visitRun(StateReading{file}, checkpoint);
  if (!isWhole(checkpoint.posed) || !std::ranges::all_of(checkpoint.path, isWhole)) {
    file.fail("is damaged");
  }
  return checkpoint;
}

}  // namespace explica::planar
