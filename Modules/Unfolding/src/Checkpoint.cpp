// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Core/StateFile.h"
#include "Explica/Unfolding/Unfold.h"

#include <string>

namespace explica::unfolding {
namespace {

constexpr char kFormat[] = "ExplicaUnfold15";  // the number counts changes of what is stored

/// A state holds a value a term: one with other terms is another format.
std::string magic() {
  std::string text = kFormat;
  for (const TermInfo& info : kTerms) text += " " + std::string(info.name);
  return text + "\n";
}

template <class Access, class Record>
void visitRecord(const Access& access, Record& r) {
  for (auto* number : {&r.iteration, &r.contacts, &r.solves}) access(*number);
  access(r.phase);
  for (auto* number :
       {&r.visibility, &r.areaErrorMean, &r.areaErrorMax, &r.areaErrorShare, &r.edgeStrainMean,
        &r.collarStretchMean, &r.collarStretchMax, &r.objectiveBefore, &r.objectiveAfter,
        &r.nearestContact, &r.safeStep, &r.step, &r.largestMove, &r.damping, &r.phases.visibility,
        &r.phases.repulsion, &r.phases.collision, &r.phases.solve, &r.seconds}) {
    access(*number);
  }
  for (auto& energy : r.energies.values) access(energy);
}

/// All of a checkpoint but for what only faces with directions of their own have: one list for
/// writing and reading.
template <class Access, class Run>
void visitRun(const Access& access, Run& run) {
  auto& s = run.state;
  access(s.positions);
  access(s.multipliers);
  for (auto* number : {&s.damping, &s.areaStiffness, &s.drive, &s.lift, &s.collarWidth,
                       &s.look.seen, &s.look.rise}) {
    access(*number);
  }
  for (auto* number : {&s.driveIteration, &s.ways, &s.iteration, &s.look.iteration})
    access(*number);
  access(s.stalled);
  access(run.best.iteration);
  for (auto* number : {&run.best.visibility, &run.best.strain, &run.best.seen}) access(*number);
  access(run.best.moving);
  access.size(run.history);
  for (auto& record : run.history) visitRecord(access, record);
  access.size(run.path);
  for (auto& positions : run.path) access(positions);
}

}  // namespace

void writeCheckpoint(const std::filesystem::path& path, const Checkpoint& checkpoint) {
  StateWriter file;
  visitRun(StateWriting{file}, checkpoint);
  if (checkpoint.state.directions.rows() > 0) {
    file.rows(checkpoint.state.directions);
    file.numbers(checkpoint.notes);
  }
  file.commit(path, magic());
}

Checkpoint readCheckpoint(const std::filesystem::path& path) {
  StateReader file(path, magic(), "an unfolding");
  Checkpoint checkpoint;
  visitRun(StateReading{file}, checkpoint);
  if (!file.atEnd()) {
    checkpoint.state.directions = file.rows<Positions>();
    checkpoint.notes = file.numbers();
  }
  return checkpoint;
}

}  // namespace explica::unfolding
