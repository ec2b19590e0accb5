// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Core/StateFile.h"
#include "Explica/Unfolding/Unfold.h"

#include <string>

namespace explica::unfolding {
namespace {

constexpr char kFormat[] = "ExplicaUnfold11";  // the number counts changes of what is stored
static_assert(sizeof(HeldPair) == 20);

/// A state holds a value a term: one with other terms is another format.
std::string magic() {
  std::string text = kFormat;
  for (const TermInfo& info : kTerms) text += " " + std::string(info.name);
  return text + "\n";
}

/// The members of a record, one list for writing and reading.
template <class Record, class Visit>
void visitNumbers(Record& r, const Visit& visit) {
  for (auto* member :
       {&r.visibility, &r.areaErrorMean, &r.areaErrorMax, &r.edgeStrainMean, &r.collarStretchMean,
        &r.collarStretchMax, &r.objectiveBefore, &r.objectiveAfter, &r.nearestContact, &r.safeStep,
        &r.step, &r.largestMove, &r.damping, &r.phases.visibility, &r.phases.repulsion,
        &r.phases.collision, &r.phases.solve, &r.seconds}) {
    visit(*member);
  }
  for (auto& energy : r.energies.values) visit(energy);
}

}  // namespace

void writeCheckpoint(const std::filesystem::path& path, const Checkpoint& checkpoint) {
  StateWriter w;
  const UnfoldState& s = checkpoint.state;
  w.rows(s.positions);
  w.count(s.multipliers.size());
  w.raw(s.multipliers.data(), static_cast<std::size_t>(s.multipliers.size()) * sizeof(double));
  w.number(s.damping);
  w.number(s.areaStiffness);
  w.number(s.drive);
  w.count(s.driveIteration);
  w.number(s.lift);
  w.number(s.collarWidth);
  w.count(s.ways);
  w.number(s.contactStiffness);
  w.count(s.iteration);
  w.count(s.separating);
  w.number(s.separatingEnergy);
  w.count(s.stalled);
  w.count(static_cast<std::int64_t>(s.held.size()));
  for (const HeldPair& held : s.held) w.raw(&held, sizeof held);
  w.count(s.look.iteration + 1);
  w.number(s.look.seen);
  w.count(checkpoint.best.iteration);
  w.number(checkpoint.best.visibility);
  w.number(checkpoint.best.strain);
  w.number(checkpoint.best.seen);
  w.rows(checkpoint.best.moving);
  w.count(static_cast<std::int64_t>(checkpoint.history.size()));
  for (const IterationRecord& r : checkpoint.history) {
    w.count(r.iteration);
    w.count(r.contacts);
    w.count(r.solves);
    visitNumbers(r, [&](const double& value) { w.number(value); });
  }
  w.count(static_cast<std::int64_t>(checkpoint.path.size()));
  for (const Positions& p : checkpoint.path) w.rows(p);
  if (s.directions.rows() > 0) {  // of an unfolding towards viewpoints there is no more to say
    w.rows(s.directions);
    w.numbers(checkpoint.notes);
  }
  w.commit(path, magic());
}

Checkpoint readCheckpoint(const std::filesystem::path& path) {
  StateReader r(path, magic(), "an unfolding");

  Checkpoint c;
  c.state.positions = r.rows<Positions>();
  c.state.multipliers.resize(r.count());
  r.raw(c.state.multipliers.data(),
        static_cast<std::size_t>(c.state.multipliers.size()) * sizeof(double));
  c.state.damping = r.number();
  c.state.areaStiffness = r.number();
  c.state.drive = r.number();
  c.state.driveIteration = static_cast<int>(r.count());
  c.state.lift = r.number();
  c.state.collarWidth = r.number();
  c.state.ways = static_cast<int>(r.count());
  c.state.contactStiffness = r.number();
  c.state.iteration = static_cast<int>(r.count());
  c.state.separating = r.count() != 0;
  c.state.separatingEnergy = r.number();
  c.state.stalled = r.count() != 0;
  c.state.held.resize(static_cast<std::size_t>(r.count()));
  for (HeldPair& held : c.state.held) r.raw(&held, sizeof held);
  c.state.look.iteration = static_cast<int>(r.count()) - 1;
  c.state.look.seen = r.number();
  c.best.iteration = static_cast<int>(r.count());
  c.best.visibility = r.number();
  c.best.strain = r.number();
  c.best.seen = r.number();
  c.best.moving = r.rows<Positions>();
  c.history.resize(static_cast<std::size_t>(r.count()));
  for (IterationRecord& row : c.history) {
    row.iteration = static_cast<int>(r.count());
    row.contacts = static_cast<int>(r.count());
    row.solves = static_cast<int>(r.count());
    visitNumbers(row, [&](double& value) { value = r.number(); });
  }
  c.path.resize(static_cast<std::size_t>(r.count()));
  for (Positions& p : c.path) p = r.rows<Positions>();
  if (!r.atEnd()) {
    c.state.directions = r.rows<Positions>();
    c.notes = r.numbers();
  }
  return c;
}

}  // namespace explica::unfolding
