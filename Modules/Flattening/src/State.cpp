// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Flattening/State.h"

#include "Explica/Core/StateFile.h"

namespace explica::flattening {
namespace {

constexpr char kMagic[] = "ExplicaFlat2\n";  // the number counts changes of the format

template <class Access, class Plan>
void visitPlan(const Access& access, Plan& plan) {
  access(plan.termination);
  access(plan.strainBefore);
  access(plan.edgeStrain);
  access.size(plan.cuts);
  for (auto& cut : plan.cuts) {
    access(cut.path);
    access(cut.length);
    access(cut.depth);
  }
  access.size(plan.found);
  for (auto& path : plan.found) access(path);
}

/// All of a checkpoint but its cuts: one list for writing and reading.
template <class Access, class Run>
void visitRun(const Access& access, Run& run) {
  auto& map = run.map;
  access(run.uncut);
  access(map.disc);
  access(map.level);
  access(map.iterations);
  access(map.areaWeight);
  access(map.areaTolerance);
  access(map.settled);
  access(map.positions);
  access.size(map.path);
  for (auto& stage : map.path) {
    access(stage.level);
    access(stage.positions);
  }
}

}  // namespace

void writeCheckpoint(const std::filesystem::path& path, const Checkpoint& checkpoint) {
  StateWriter file;
  visitRun(StateWriting{file}, checkpoint);
  if (checkpoint.cuts) visitPlan(StateWriting{file}, *checkpoint.cuts);
  file.commit(path, kMagic);
}

Checkpoint readCheckpoint(const std::filesystem::path& path) {
  StateReader file(path, kMagic, "a flat map");
  Checkpoint checkpoint;
  visitRun(StateReading{file}, checkpoint);
  if (!file.atEnd()) visitPlan(StateReading{file}, checkpoint.cuts.emplace());
  return checkpoint;
}

}  // namespace explica::flattening
