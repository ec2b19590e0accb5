// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Core/StateFile.h"
#include "Explica/Unfolding/Unfold.h"

#include <string>
#include <type_traits>

namespace explica::unfolding {
namespace {

constexpr char kFormat[] = "ExplicaUnfold14";  // the number counts changes of what is stored

/// A state holds a value a term: one with other terms is another format.
std::string magic() {
  std::string text = kFormat;
  for (const TermInfo& info : kTerms) text += " " + std::string(info.name);
  return text + "\n";
}

/// Whole numbers are -1 at least.
struct Writing {
  StateWriter& file;
  template <class Number>
  void operator()(const Number& value) const {
    if constexpr (std::is_floating_point_v<Number>) {
      file.number(value);
    } else {
      file.count(static_cast<std::int64_t>(value) + 1);
    }
  }
  void operator()(const Positions& rows) const { file.rows(rows); }
  void operator()(const Eigen::VectorXd& list) const { file.rows(list); }
  template <class Item>
  void size(const std::vector<Item>& list) const {
    file.count(static_cast<std::int64_t>(list.size()));
  }
};

struct Reading {
  StateReader& file;
  template <class Number>
  void operator()(Number& value) const {
    if constexpr (std::is_floating_point_v<Number>) {
      value = file.number();
    } else {
      value = static_cast<Number>(file.count() - 1);
    }
  }
  void operator()(Positions& rows) const { rows = file.rows<Positions>(); }
  void operator()(Eigen::VectorXd& list) const { list = file.rows<Eigen::VectorXd>(); }
  template <class Item>
  void size(std::vector<Item>& list) const {
    list.resize(static_cast<std::size_t>(file.count()));
  }
};

template <class Access, class Record>
void visitRecord(const Access& access, Record& r) {
  for (auto* number : {&r.iteration, &r.contacts, &r.solves}) access(*number);
  access(r.phase);
  for (auto* number :
       {&r.visibility, &r.areaErrorMean, &r.areaErrorMax, &r.edgeStrainMean, &r.collarStretchMean,
        &r.collarStretchMax, &r.objectiveBefore, &r.objectiveAfter, &r.nearestContact, &r.safeStep,
        &r.step, &r.largestMove, &r.damping, &r.phases.visibility, &r.phases.repulsion,
        &r.phases.collision, &r.phases.solve, &r.seconds}) {
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
  visitRun(Writing{file}, checkpoint);
  if (checkpoint.state.directions.rows() > 0) {
    file.rows(checkpoint.state.directions);
    file.numbers(checkpoint.notes);
  }
  file.commit(path, magic());
}

Checkpoint readCheckpoint(const std::filesystem::path& path) {
  StateReader file(path, magic(), "an unfolding");
  Checkpoint checkpoint;
  visitRun(Reading{file}, checkpoint);
  if (!file.atEnd()) {
    checkpoint.state.directions = file.rows<Positions>();
    checkpoint.notes = file.numbers();
  }
  return checkpoint;
}

}  // namespace explica::unfolding
